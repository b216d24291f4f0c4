"""The comparison in numbers for machines, and in one paragraph for people."""

from collections.abc import Sequence
from typing import Any

from scenes.parts import PART_NAMES
from studies.base.numbers_as_text import counted
from studies.comparison.goals import goals_json
from studies.comparison.paper_results import paper_findings
from studies.comparison.paper_verdicts import verdict_words
from studies.comparison.planning_speed import SPEED_JOB
from studies.comparison.statistics import Comparison
from studies.statistics.intervals import Interval
from studies.work.workers import Failure


def json_summary(comparison: Comparison, parts: Sequence[str], planners: Sequence[str], failed: int, wall_s: float):
    """The object that `--json` prints; shares as fractions, lengths in millimetres, means over runs.

    `runs` are those of the planners as they are on parts A to D, `other_runs` those of the inside corner, of ablations
    and of changed links; `failed` counts runs of all kinds. `wall_s` is that of all commands that worked on the study.
    """
    of_parts = [part for part in parts if part in PART_NAMES]
    main = [record for record in comparison.records if record.part in of_parts and record.arm in planners]
    return {
        "runs": len(main),
        "other_runs": len(comparison.records) - len(main),
        "failed": failed,
        "wall_s": wall_s,
        "processor_s": sum(record.processor_s for record in comparison.records),
        "time_ratio_re_pb": comparison.time_ratio(of_parts, "re", "pb"),
        "time_ratio_fra_pb": comparison.time_ratio(of_parts, "fra", "pb"),
        "planning_ratio_re_pb": comparison.time_ratio(of_parts, "re", "pb", "planning"),
        "planning_ratio_fra_pb": comparison.time_ratio(of_parts, "fra", "pb", "planning"),
        "parts": {part: {planner: arm_summary(comparison, part, planner) for planner in planners} for part in parts},
        "goals": goals_json(comparison),
    }


def arm_summary(comparison: Comparison, part: str, arm: str) -> dict[str, Any]:
    """Means of one arm on one part; null where there is no finished run."""

    def mean(name: str) -> float | None:
        interval = comparison.figure(part, arm, name)
        return interval.mean if interval else None

    return {
        "coverage_5mm": mean("coverage_5mm"),
        "coverage_ci95": _ends(comparison.figure(part, arm, "coverage_5mm")),
        "accuracy_mm": mean("accuracy_mm"),
        "f_score": mean("f_score"),
        "filtered_coverage_5mm": mean("filtered_coverage_5mm"),
        "wrongly_free_share": mean("wrongly_free_share"),
        "wrongly_occupied_share": mean("wrongly_occupied_share"),
        "acquisitions": mean("acquisitions"),
        "activations": mean("recovery_activations"),
        "recovery_contribution": mean("recovery_share"),
        "runs": len(comparison.runs(part, arm)),
    }


def failed_runs(failures: Sequence[Failure]) -> int:
    """How many of the jobs that failed were runs; the measurement of planning times is none."""
    return sum(failure.name != SPEED_JOB for failure in failures)


def paragraph(comparison: Comparison, planned: int, failed: int) -> str:
    """What was run and how much of the paper was found."""
    done = counted(len(comparison.records), "run")
    missing = planned - len(comparison.records)
    rest = f" of {planned} that are planned" if missing else ", all that were planned"
    rest += f"; {counted(failed, 'run')} failed" if failed else ""
    return f"{done}{rest}. {verdict_words(finding.verdict for finding in paper_findings(comparison))}"


def _ends(interval: Interval | None) -> list[float] | None:
    return [interval.low, interval.high] if interval else None
