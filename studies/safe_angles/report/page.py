"""The page of safe angles: a card for each material, into one HTML file that needs nothing beside it."""

from collections.abc import Sequence
from pathlib import Path

from franbv.surfaces.safe_angles import MaterialAngles, RollAngles, SafeAngles
from render.labels.causes import LEGEND
from studies.base.atomic_file import write_atomically
from studies.base.numbers_as_text import counted, percent
from studies.drawing.templates import environment, page_style
from studies.run.report.page import flattened
from studies.run.stored_run import REPORT
from studies.safe_angles.plan import AnglesPlan
from studies.safe_angles.report.bins_figure import bar_class, bins_figure
from studies.safe_angles.sentences import bin_words, subject_words, verdict, views_words
from studies.sensitivity.trust import spoken

CAUSE_MEANINGS = {LEGEND[cause].name: LEGEND[cause].meaning for cause in LEGEND}
"""What the labels mean, by name."""
BAR_WORDS = {"safe": "safe", "unsafe": "not safe", "unknown": "not known"}
"""Colours of the bars in words."""


def write_angles_report(out: Path, plan: AnglesPlan, table: SafeAngles, measured: int) -> Path:
    """(Re)build `report.html` in the folder; returns its path. measured: views that are finished."""
    path = out / REPORT
    write_atomically(path, angles_html(plan, table, measured).encode())
    return path


def angles_html(plan: AnglesPlan, table: SafeAngles, measured: int) -> str:
    """The whole page."""
    facts = table.measured_for
    return (
        environment("studies.safe_angles.report")
        .get_template("angles.html.j2")
        .render(
            title=f"Safe angles of {subject_words(table)}",
            table=table,
            measured=measured,
            wanted=len(plan.views),
            material_words=material_words,
            overview=[(entry, line, range_words(line)) for entry in table.materials for line in entry.rolls],
            verdict=verdict,
            figure=bins_figure,
            bins=bin_cells,
            views_words=counted(facts["poses"], "pose"),
            rolls=[f"{line.roll_deg:g}" for line in table.materials[0].rolls],
            causes=shown_losses(table),
            facts=[pair for pair in flattened(facts) if pair[1] != "None"],
            config=list(flattened(plan.settings.sensor.model_dump(mode="json"))),
            versions=plan.versions,
            style=page_style(("studies.safe_angles.report", "angles.css")),
        )
    )


def material_words(entry: MaterialAngles) -> str:
    """`iron, blasted`."""
    return spoken(entry.material).replace(":", ", ")


def range_words(line: RollAngles) -> str:
    """`10 to 50 deg`, or that there is none."""
    spans = [f"{span.from_deg:g} to {span.to_deg:g} deg" for span in line.ranges]
    if spans:
        return " and ".join(spans)
    return "none" if any(found.is_known for found in line.bins) else "not known"


def bin_cells(line: RollAngles, table: SafeAngles) -> list[Sequence[str]]:
    """The rows of a table of bins, in words."""
    return [
        (
            bin_words(found),
            BAR_WORDS[bar_class(found, table.target_share)],
            f"{found.views} ({views_words(found)})",
            f"{found.part_pixels:,}",
            percent(found.share),
            percent(found.lower_bound),
            f"{found.views_below}",
            percent(found.views_below_at_most),
            percent(found.matte_share),
            spoken(found.lost_to),
        )
        for found in line.bins
    ]


def shown_losses(table: SafeAngles) -> list[tuple[str, str]]:
    """Name and meaning of the causes that any bin names."""
    named = {found.lost_to for entry in table.materials for line in entry.rolls for found in line.bins}
    return [(spoken(name), meaning) for name, meaning in CAUSE_MEANINGS.items() if name in named]
