"""The report of a comparison: the paper's numbers beside ours, box plots, increments, curves, times, ablations."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from studies.base.atomic_file import write_atomically
from studies.comparison.goals import judge
from studies.comparison.method_names import method_name
from studies.comparison.paper import PAPER_PARTS
from studies.comparison.paper_results import paper_findings
from studies.comparison.paper_verdicts import DIRECTION, FOUND, TOO_FEW, UNKNOWN
from studies.comparison.planning_speed import stored_speed
from studies.comparison.preset import ComparisonPreset
from studies.comparison.report.change_tables import ablation_rows, changed_link_rows, variant_rows
from studies.comparison.report.equal_tables import equal_section
from studies.comparison.report.headline import (
    arm_words,
    bench_words,
    main_numbers,
    part_words,
    short_words,
    version_words,
)
from studies.comparison.report.increments_figure import increments_figure
from studies.comparison.report.links_figure import links_figure
from studies.comparison.report.paper_boxes_figure import coverage_boxes, recovery_boxes
from studies.comparison.report.paper_tables import (
    coverage_rows,
    goal_rows,
    increment_rows,
    lead_rows,
    recovered_rows,
)
from studies.comparison.report.planner_curves_figure import coinciding, planner_curves_figure
from studies.comparison.report.robust_rows import robust_section
from studies.comparison.report.sentences import link_words
from studies.comparison.report.speed_tables import speed_section
from studies.comparison.report.tables import (
    arm_rows,
    difference_rows,
    loss_rows,
    overhead_words,
    time_rows,
)
from studies.comparison.robust_arms import robust_tables
from studies.comparison.statistics import Comparison
from studies.comparison.summary import failed_runs, paragraph
from studies.drawing.cells import probability
from studies.drawing.templates import environment, page_style
from studies.run.report.page import flattened
from studies.run.stored_run import REPORT
from studies.statistics.intervals import least_p
from studies.work.workers import Failure

VERDICTS = {FOUND: "found", DIRECTION: "direction", TOO_FEW: "unknown", UNKNOWN: "unknown"}
"""Classes of the verdicts; all others are missing."""


def write_comparison_report(
    out: Path, preset: ComparisonPreset, comparison: Comparison, planned: int, failures: Sequence[Failure]
) -> Path:
    """(Re)build `report.html` in the study's folder; returns its path."""
    path = out / REPORT
    write_atomically(path, comparison_html(preset, comparison, planned, failures, stored_speed(out)).encode())
    return path


def comparison_html(
    preset: ComparisonPreset,
    comparison: Comparison,
    planned: int,
    failures: Sequence[Failure],
    speed: dict[str, Any] | None,
) -> str:
    """The whole page."""
    known = list(dict.fromkeys(record.part for record in comparison.records))
    parts = [part for part in known if part not in preset.other_ablated_parts]  # those have tables of changes alone
    words, short = {part: part_words(part, preset) for part in known}, {part: short_words(part) for part in known}
    arms = [arm for arm in preset.planners if any(comparison.runs(part, arm) for part in parts)]
    differences = difference_rows(comparison, parts, [arm for arm in arms if arm != "fra"])
    pairs = [row["pairs"] for row in differences]
    return (
        environment("studies.comparison.report")
        .get_template("comparison.html.j2")
        .render(
            title=preset.title,
            paragraph=paragraph(comparison, planned, failed_runs(failures), preset.planners),
            numbers=main_numbers(comparison, arms),
            preset=preset,
            parts=parts,
            words=words,
            short=short,
            arms=arms,
            named=method_name,
            findings=[(finding, VERDICTS.get(finding.verdict, "missing")) for finding in paper_findings(comparison)],
            bench=bench_words(parts, preset),
            covered=coverage_rows(comparison, parts, arms),
            leads=lead_rows(comparison, parts, [arm for arm in arms if arm != "fra"]),
            recovered=recovered_rows(comparison, parts),
            goals=goal_rows(judge(comparison, preset.planners)) if any(part in PAPER_PARTS for part in parts) else [],
            coverage_boxes=coverage_boxes(comparison, parts, arms, short),
            recovery_boxes=recovery_boxes(comparison, parts),
            levels=increment_rows(comparison, parts),
            by_iterations=planner_curves_figure(comparison, parts, arms, "iterations", short),
            by_acquisitions=planner_curves_figure(comparison, parts, arms, "acquisitions", short),
            coinciding=[short[part] for part in coinciding(comparison, parts)],
            equal=equal_section(comparison, parts, arms),
            figures=arm_rows(comparison, parts, arms),
            differences=differences,
            least=(min(pairs), probability(least_p(min(pairs)))) if pairs else None,
            variants=variant_rows(comparison, parts),
            increments=increments_figure(comparison, parts, short),
            times=time_rows(comparison, parts, arms),
            arm=arm_words(),
            versions=version_words(comparison),
            overhead=overhead_words(comparison),
            losses=loss_rows(comparison, parts),
            speed=speed_section(speed) if speed else None,
            **_of_changes(comparison, preset, parts, words),
            failures=failures,
            config=list(flattened(preset.model_dump(mode="json"))),
            style=page_style(("studies.comparison.report", "comparison.css")),
        )
    )


def _of_changes(
    comparison: Comparison, preset: ComparisonPreset, parts: Sequence[str], words: dict[str, str]
) -> dict[str, Any]:
    """What the page says of ablations and of links."""
    return {
        "links": link_words(comparison, parts, preset.parameters.recovered_share),
        "ablations": ablation_rows(comparison, preset.ablated_parts),
        "robust": robust_section(robust_tables(comparison)),
        "moved_leads": links_figure(comparison, preset.ablated_parts, words),
        "changed_links": changed_link_rows(comparison, preset.ablated_parts),
    }
