"""The comparison at equal acquisitions as numbers for machines: the keys `equal_acquisitions` and `robust_ablation`."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, get_args

from studies.comparison.equal_acquisitions import (
    COMPARED_WITH,
    END_FIGURES,
    Needed,
    TimeKind,
    is_compared_so,
    lead_after,
    mean_after,
    mean_seconds_each,
    needed,
    reached_levels,
    seconds_ratio,
)
from studies.comparison.paper import FINAL_COVERAGE
from studies.comparison.robust_arms import RobustTable, robust_tables
from studies.comparison.statistics import Comparison
from studies.statistics.intervals import Difference, Interval


def equal_json(comparison: Comparison, parts: Sequence[str], planners: Sequence[str]) -> dict[str, Any] | None:
    """Shares as fractions, times in seconds; null where the study has nothing to say of it.

    Coverages and differences are means over starts, acquisitions until a coverage medians, ratios geometric means.
    """
    if not is_compared_so(comparison, parts, planners):
        return None
    levels = reached_levels(comparison, parts, planners)
    return {
        "after": list(levels),
        "parts": {
            part: {
                planner: _planner_json(comparison, part, planner, planners, levels)
                for planner in planners
                if comparison.runs(part, planner)
            }
            for part in parts
        },
    }


def targets(comparison: Comparison, part: str) -> dict[str, float | None]:
    """Coverages that are waited for [-]: the paper's median of FRA, and that of FRA's ends in this study."""
    paper, ours = FINAL_COVERAGE.get(part, {}).get("fra"), comparison.median(part, "fra")
    return {"paper_fra": paper.median if paper else None, "fra_end": ours.value if ours else None}


def _planner_json(
    comparison: Comparison, part: str, planner: str, planners: Sequence[str], levels: Sequence[int]
) -> dict[str, Any]:
    acquisitions = comparison.figure(part, planner, "acquisitions")
    return {
        "runs": len(comparison.runs(part, planner)),
        "acquisitions": acquisitions.mean if acquisitions else None,
        "coverage": [_level_json(comparison, part, planner, n) for n in levels],
        **{
            f"until_{name}": _needed_json(needed(comparison, part, planner, share))
            for name, share in targets(comparison, part).items()
        },
        **{
            f"{spent}_s": _interval_json(mean_seconds_each(comparison, part, planner, spent))
            for spent in get_args(TimeKind)
        },
        **{
            f"less_{theirs}": _pair_json(comparison, part, planner, theirs, levels)
            for theirs in COMPARED_WITH
            if theirs != planner and theirs in planners
        },
    }


def _level_json(comparison: Comparison, part: str, planner: str, acquisitions: int) -> dict[str, Any]:
    """`ended`: runs that had ended before, and are counted with what they then covered."""
    ended = sum(len(record.kinds) < acquisitions for record in comparison.runs(part, planner))
    mean = _interval_json(mean_after(comparison, part, planner, acquisitions))
    return {"after": acquisitions, **mean, "ended": ended}


def _pair_json(comparison: Comparison, part: str, ours: str, theirs: str, levels: Sequence[int]) -> dict[str, Any]:
    return {
        "coverage": [{"after": n, **_difference_json(lead_after(comparison, part, ours, theirs, n))} for n in levels],
        **{name: _difference_json(comparison.figure_difference(part, ours, theirs, name)) for name in END_FIGURES},
        **{
            f"{spent}_ratio": _interval_json(seconds_ratio(comparison, part, ours, theirs, spent))
            for spent in get_args(TimeKind)
        },
    }


def robust_ablation_json(comparison: Comparison) -> dict[str, Any] | None:
    """Arms of fra-robust's ablation by part, over the starts that the ablations have; null where there are none."""
    tables = robust_tables(comparison)
    return {part: _table_json(table) for part, table in tables.items()} or None


def _table_json(table: RobustTable) -> dict[str, Any]:
    return {
        arm: {
            "runs": len(table.shared.runs(table.part, arm)),
            "coverage": [{"after": n, **_interval_json(table.covers(arm, n))} for n in table.levels],
            "less_fra": [{"after": n, **_difference_json(table.less_fra(arm, n))} for n in table.levels],
            "wrongly_free_share": _interval_json(table.wrongly_free(arm)),
        }
        for arm in table.arms
    }


def _interval_json(interval: Interval | None) -> dict[str, Any]:
    """Mean and ends; a single run has no interval."""
    if interval is None:
        return {"mean": None, "ci95": None, "runs": 0}
    ends = [interval.low, interval.high] if interval.count > 1 else None
    return {"mean": interval.mean, "ci95": ends, "runs": interval.count}


def _difference_json(difference: Difference | None) -> dict[str, Any]:
    found = _interval_json(difference.interval if difference else None)
    return {**found, "p": difference.p if difference else None}


def _needed_json(found: Needed | None) -> dict[str, Any] | None:
    return asdict(found) if found else None
