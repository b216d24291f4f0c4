"""The page of a study of readings: the decisions, what they move, the cells and the candidates beside the paper."""

from collections.abc import Sequence

from markupsafe import Markup

from studies.base.numbers_as_text import counted
from studies.drawing.templates import environment, page_style
from studies.readings.analysis import DISTANCE, Analysis, Response
from studies.readings.candidates import Candidate
from studies.readings.distance import READ_FIGURES
from studies.readings.preset import ReadingsPreset
from studies.readings.report.effects_figure import effects_figure
from studies.readings.report.tables import candidate_rows, cell_rows, decision_rows, effect_table, margin_rows
from studies.run.report.page import flattened
from studies.work.workers import Failure


def readings_html(
    preset: ReadingsPreset,
    analysis: Analysis,
    candidates: Sequence[Candidate],
    told: str,
    failures: Sequence[Failure],
) -> str:
    """The whole page."""
    return (
        environment("studies.readings.report")
        .get_template("readings.html.j2")
        .render(
            title=preset.title,
            told=told,
            preset=preset,
            starts=counted(preset.starts, "start"),
            iterations=preset.parameters.max_iterations,
            decisions=decision_rows(),
            figures=list(READ_FIGURES.values()),
            allowed=[_allowed(figure.allowed, figure.scale) for figure in READ_FIGURES.values()],
            charts=_charts(analysis),
            effects=effect_table(analysis),
            margins=margin_rows(analysis),
            cells=cell_rows(analysis),
            candidates=candidate_rows(candidates, analysis.parts),
            failures=failures,
            config=list(flattened(preset.model_dump(mode="json"))),
            style=page_style(("studies.readings.report", "readings.css")),
        )
    )


def _allowed(allowed: float, scale: float) -> str:
    return f"{scale * allowed:g}{' points' if scale > 1 else ''}"


def _charts(analysis: Analysis) -> list[tuple[str, Markup]]:
    """Heading and chart of the distance and of FRA less PB on each part."""
    if not analysis.effects:
        return []
    title = "Distance from the paper"
    axis = "second level less first: below zero the second comes nearer to the paper"
    charts = [(title, effects_figure(analysis.effects[DISTANCE], title, axis, 1.0, "+z.2f"))]
    for part in analysis.parts:
        title = f"FRA less PB on {part}"
        axis = "second level less first [points of coverage of the map]"
        charts.append((title, effects_figure(analysis.effects[Response(part, "lead")], title, axis, 100.0, "+z.1f")))
    return charts
