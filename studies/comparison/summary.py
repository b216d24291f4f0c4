"""The comparison in numbers for machines, and in one paragraph for people."""

from collections.abc import Sequence
from typing import Any

from studies.base.numbers_as_text import counted
from studies.comparison.equal_summary import equal_json, robust_ablation_json
from studies.comparison.goals import MET, TOO_FEW_RUNS, goals_json, judge
from studies.comparison.paper import PAPER_PARTS
from studies.comparison.paper_results import paper_findings
from studies.comparison.paper_verdicts import verdict_words
from studies.comparison.planning_speed import SPEED_JOB
from studies.comparison.records import CONTRIBUTED
from studies.comparison.statistics import Comparison
from studies.run.acquisition_table import MAP_COVERAGE
from studies.statistics.intervals import Interval
from studies.statistics.medians import MedianEstimate
from studies.work.workers import Failure


def json_summary(comparison: Comparison, parts: Sequence[str], planners: Sequence[str], failed: int, wall_s: float):
    """The object that `--json` prints; shares as fractions, lengths in millimetres.

    Coverage of the map, activations and what recovery brought are medians over runs, as the paper gives them; all other
    figures are means.

    `runs` are those of the planners as they are on parts A to D, `other_runs` those on other parts, of ablations and of
    changed links; `failed` counts runs of all kinds. `wall_s` is that of all commands that worked on the study.
    """
    of_parts = [part for part in parts if part in PAPER_PARTS]
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
        "goals": goals_json(judge(comparison, planners)),
        "equal_acquisitions": equal_json(comparison, parts, planners),
        "robust_ablation": robust_ablation_json(comparison),
    }


def arm_summary(comparison: Comparison, part: str, arm: str) -> dict[str, Any]:
    """Medians and means of one arm on one part; null where there is no finished run."""
    covered = comparison.median(part, arm, MAP_COVERAGE)

    def mean(name: str) -> float | None:
        interval = comparison.figure(part, arm, name)
        return interval.mean if interval else None

    def median(name: str) -> float | None:
        estimate = comparison.median(part, arm, name)
        return estimate.value if estimate else None

    return {
        MAP_COVERAGE: covered.value if covered else None,
        "coverage_map_ci95": _ends(covered),
        "activations": median("recovery_activations"),
        CONTRIBUTED: median(CONTRIBUTED),
        "coverage_5mm": mean("coverage_5mm"),
        "coverage_ci95": _ends(comparison.figure(part, arm, "coverage_5mm")),
        "accuracy_mm": mean("accuracy_mm"),
        "f_score": mean("f_score"),
        "filtered_coverage_5mm": mean("filtered_coverage_5mm"),
        "wrongly_free_share": mean("wrongly_free_share"),
        "wrongly_occupied_share": mean("wrongly_occupied_share"),
        "acquisitions": mean("acquisitions"),
        "runs": len(comparison.runs(part, arm)),
    }


def failed_runs(failures: Sequence[Failure]) -> int:
    """How many of the jobs that failed were runs; the measurement of planning times is none."""
    return sum(failure.name != SPEED_JOB for failure in failures)


def paragraph(comparison: Comparison, planned: int, failed: int, planners: Sequence[str]) -> str:
    """What was run and how much of the paper was found."""
    done = counted(len(comparison.records), "run")
    missing = planned - len(comparison.records)
    rest = f" of {planned} that are planned" if missing else ", all that were planned"
    rest += f"; {counted(failed, 'run')} failed" if failed else ""
    verdicts = verdict_words(finding.verdict for finding in paper_findings(comparison))
    of_paper = any(comparison.has(part) for part in PAPER_PARTS)
    goals = _goal_words(comparison, planners) if of_paper else ""
    return f"{done}{rest}. {' '.join(filter(None, (goals, verdicts)))}"


def _goal_words(comparison: Comparison, planners: Sequence[str]) -> str:
    """`Of 15 goals, set by the paper's figures, 3 are met; 10 have too few runs to say.`."""
    found = [judged.verdict for judged in judge(comparison, planners)]
    if not found:
        return ""
    met, few = found.count(MET), found.count(TOO_FEW_RUNS)
    rest = f"; {few} {'has' if few == 1 else 'have'} too few runs to say" if few else ""
    goals = f"Of {counted(len(found), 'goal')}, set by the paper's figures"
    return f"{goals}, {met or 'none'} {'is' if met < 2 else 'are'} met{rest}."


def _ends(interval: Interval | MedianEstimate | None) -> list[float] | None:
    return [interval.low, interval.high] if interval else None
