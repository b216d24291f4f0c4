"""The page over all starts of one reconstruction: words, curves, a table with mean and spread."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from studies.base.atomic_file import write_atomically
from studies.base.output_errors import output_errors
from studies.drawing.cells import signs
from studies.drawing.templates import environment, page_style
from studies.run.acquisition_table import MAP_COVERAGE, RAW_COVERAGE
from studies.run.report.page import flattened
from studies.run.starts.curves_figure import starts_figure
from studies.run.starts.runs import FinishedStart, finished_starts, stored_starts
from studies.run.starts.summary import Spread, figure_spreads, starts_paragraph
from studies.run.stored_run import REPORT

STARTS_REPORT = "starts.html"
"""The page, beside the folders of the starts."""


class ShownFigure(NamedTuple):
    """A column of the table."""

    name: str
    """Of the figure in run.json's summary."""
    words: str
    unit: str
    factor: float
    """From the summary's unit to the one shown."""
    form: str
    """How a single run's number is written."""


SHOWN = (
    ShownFigure(MAP_COVERAGE, "coverage of the map", "%", 100.0, ".1f"),
    ShownFigure(RAW_COVERAGE, "raw coverage", "%", 100.0, ".1f"),
    ShownFigure("recovery_contribution", "brought by recovery views", "points", 100.0, "+z.1f"),
    ShownFigure("recovery_activations", "recoveries", "", 1.0, ".0f"),
    ShownFigure("acquisitions", "acquisitions", "", 1.0, ".0f"),
    ShownFigure("accuracy_median_mm", "median error", "mm", 1.0, ".1f"),
    ShownFigure("f_score", "F-score", "", 1.0, ".2f"),
)

OVER_ALL: dict[str, Callable[[Spread], float | None]] = {
    "mean": lambda found: found.mean,
    "95 % interval, from": lambda found: found.low,
    "to": lambda found: found.high,
    "standard deviation": lambda found: found.sd,
    "smallest": lambda found: found.min,
    "largest": lambda found: found.max,
}
"""Rows below those of the starts."""


def rebuild(out: Path) -> Path:
    """(Re)build the page from what the folder holds; returns its path."""
    page = starts_html(out).encode()
    with output_errors(out):
        write_atomically(out / STARTS_REPORT, page)
    return out / STARTS_REPORT


def starts_html(out: Path) -> str:
    """The whole page."""
    config, starts = stored_starts(out)
    finished = finished_starts(out, starts)
    return (
        environment("studies.run.starts")
        .get_template("starts.html.j2")
        .render(
            title=finished[0].stored.run["title"] if finished else "No start has come to its end",
            paragraph=starts_paragraph(finished, len(starts)),
            planned=len(starts),
            figure=starts_figure([(number_words(one), one.stored.rows) for one in finished]) if finished else "",
            shown=SHOWN,
            rows=[(one, number_words(one), start_cells(one)) for one in finished],
            over_all=list(over_all_rows(figure_spreads(finished))),
            report=REPORT,
            config=list(flattened(config.model_dump(mode="json"))),
            style=page_style(),
        )
    )


def number_words(one: FinishedStart) -> str:
    """Number of a start, for people."""
    return str(one.start.number + 1)


def start_cells(one: FinishedStart) -> list[str]:
    """The numbers of one start."""
    return [cell(one.summary[figure.name], figure.factor, figure.form) for figure in SHOWN]


def over_all_rows(spreads: Mapping[str, Spread]) -> Iterator[tuple[str, list[str]]]:
    """Mean and spread of each column, row by row; means of counts need a place behind the point."""
    forms = [figure.form.replace(".0f", ".1f").lstrip("+") for figure in SHOWN]
    columns = [(figure, spreads.get(figure.name), form) for figure, form in zip(SHOWN, forms, strict=True)]
    for words, of in OVER_ALL.items():
        yield words, [cell(of(found) if found else None, figure.factor, form) for figure, found, form in columns]


def cell(value: float | None, factor: float, form: str) -> str:
    """A number of the table, empty where there is none."""
    return "" if value is None else signs(format(factor * value, form))
