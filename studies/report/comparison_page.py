"""The report of a comparison: the paper's sentences beside our numbers, curves, tables, boxes, times, ablations."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from scenes.parts import PART_NAMES, part_description
from studies.ablation import ABLATIONS
from studies.cases import write_atomically
from studies.comparison_preset import Preset
from studies.comparison_statistics import Comparison
from studies.comparison_summary import paragraph
from studies.paired_statistics import holm
from studies.paper_results import findings, points
from studies.planning_speed import SPEED
from studies.report.comparison_tables import (
    ablation_rows,
    arm_rows,
    changed_link_rows,
    difference_rows,
    loss_rows,
    overhead_words,
    speed_words,
    time_rows,
)
from studies.report.increments_figure import increments_figure
from studies.report.link_words import link_words
from studies.report.page import flattened
from studies.report.planner_curves_figure import planner_curves_figure
from studies.report.speed_figure import speed_figure
from studies.report.templates import asset, environment
from studies.stored_run import REPORT
from studies.verdicts import DIRECTION, FOUND, TOO_FEW, UNKNOWN
from studies.workers import Failure

VERDICTS = {FOUND: "found", DIRECTION: "direction", TOO_FEW: "unknown", UNKNOWN: "unknown"}
"""Classes of the verdicts; all others are missing."""


def write_comparison_report(
    out: Path, preset: Preset, comparison: Comparison, planned: int, failures: Sequence[Failure]
) -> Path:
    """(Re)build `report.html` in the study's folder; returns its path."""
    path = out / REPORT
    speed = json.loads((out / SPEED).read_text()) if (out / SPEED).exists() else None
    write_atomically(path, comparison_html(preset, comparison, planned, failures, speed).encode())
    return path


def comparison_html(
    preset: Preset,
    comparison: Comparison,
    planned: int,
    failures: Sequence[Failure],
    speed: dict[str, Any] | None,
) -> str:
    """The whole page."""
    parts = list(dict.fromkeys(record.part for record in comparison.records))
    words, short = ({part: name(part) for part in parts} for name in (part_words, short_words))
    arms = [arm for arm in preset.planners if any(comparison.runs(part, arm) for part in parts)]
    differences = difference_rows(comparison, parts, [arm for arm in arms if arm != "fra"])
    return (
        environment()
        .get_template("comparison.html.j2")
        .render(
            title=preset.title,
            paragraph=paragraph(comparison, planned, len(failures)),
            preset=preset,
            parts=parts,
            words=words,
            short=short,
            arms=arms,
            findings=[(finding, VERDICTS.get(finding.verdict, "missing")) for finding in findings(comparison)],
            by_iterations=planner_curves_figure(comparison, parts, arms, "iterations", short),
            by_acquisitions=planner_curves_figure(comparison, parts, arms, "acquisitions", short),
            figures=arm_rows(comparison, parts, arms),
            differences=differences,
            adjusted=holm([row["end"].p for row in differences if row["end"]]),
            points=points,
            increments=increments_figure(comparison, parts, short),
            times=time_rows(comparison, parts, arms),
            overhead=overhead_words(comparison),
            losses=loss_rows(comparison, parts),
            links=link_words(comparison, preset.parts, ABLATIONS, preset.parameters.recovered_share),
            speed=speed_figure(speed["rows"]) if speed else None,
            speed_words=speed_words(speed["rows"]) if speed else "",
            ablations=ablation_rows(comparison, preset.ablated_parts, ABLATIONS),
            changed_links=changed_link_rows(comparison, preset.ablated_parts),
            failures=failures,
            config=list(flattened(preset.model_dump(mode="json"))),
            style=asset("style.css") + asset("comparison.css"),
        )
    )


def part_words(part: str) -> str:
    """`A, matte steel cuboid`."""
    return f"{part}, {part_description(part)}" if part in PART_NAMES else short_words(part)


def short_words(part: str) -> str:
    """`A`, `Inside corner`."""
    return part if part in PART_NAMES else part.replace("_", " ").capitalize()
