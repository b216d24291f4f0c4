"""Planners after equally many acquisitions: coverage of the map, views until a coverage is reached, time, errors.

The paper counts NBV iterations, in which recovery views are free, and lets each method end by its own rule. Here every
acquisition counts, FRA's recoveries included, and a run that has ended keeps what it covers. Differences and ratios are
of runs from the same start with the same noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from studies.comparison.paper import PAPER_METHODS
from studies.comparison.records import Record
from studies.comparison.statistics import Comparison
from studies.statistics.intervals import Difference, Interval, mean_interval, paired_difference

LEVELS = (5, 10, 15, 20, 30)
"""Acquisitions after which planners are compared [-] (choice: close where coverage rises, up to about twice the paper's
15 NBV iterations)."""
COMPARED_WITH = ("fra", "pb")
"""Planners to which all others are held: the paper's own, and what it adds recoveries to."""
END_FIGURES = ("wrongly_free_share", "f_score", "accuracy_mm")
"""Of the figures at the end of a run, those that say at what price the map covers."""

TimeKind = Literal["planning", "processor"]
"""Processor time of the planner alone, or of the whole run with the simulation."""


@dataclass(frozen=True)
class Needed:
    """Acquisitions until the map first covers a share of the surface."""

    share: float
    """What is to be covered [-]."""
    median: float | None
    """Over all starts, those that never reach it counted as later than all others; None where it is one of these."""
    reached: int
    """Starts that reach it."""
    starts: int
    """All of them."""


def is_compared_so(comparison: Comparison, parts: Sequence[str], planners: Sequence[str]) -> bool:
    """Whether a study has anything to say: planners beyond the paper's, or runs that last until the last level.

    By the median run of each planner on each part: a single run may end early when no pose is left.
    """
    if not reached_levels(comparison, parts, planners):
        return False
    lengths = [_lengths(comparison, [part], planner) for part in parts for planner in planners]
    beyond = set(planners) - set(PAPER_METHODS)
    return bool(beyond) or all(np.median(found) >= LEVELS[-1] for found in lengths if found)


def reached_levels(comparison: Comparison, parts: Sequence[str], arms: Sequence[str]) -> tuple[int, ...]:
    """Those of LEVELS to which every arm that has runs comes in its longest."""
    longest = [max(found) for arm in arms if (found := _lengths(comparison, parts, arm))]
    return tuple(level for level in LEVELS if longest and level <= min(longest))


def _lengths(comparison: Comparison, parts: Sequence[str], arm: str) -> list[int]:
    return [len(record.kinds) for part in parts for record in comparison.runs(part, arm)]


def compared_arms(arms: Sequence[str]) -> list[tuple[str, str]]:
    """Each arm with each of COMPARED_WITH, but no two the other way round again."""
    with_first = [(arm, COMPARED_WITH[0]) for arm in arms if arm != COMPARED_WITH[0]]
    return with_first + [(arm, COMPARED_WITH[1]) for arm in arms if arm not in COMPARED_WITH]


def coverage_after(record: Record, acquisitions: int) -> float:
    """Coverage of the map after so many acquisitions [-]; of a run that has ended, at its end."""
    return float(record.coverage[min(acquisitions, len(record.coverage)) - 1])


def mean_after(comparison: Comparison, part: str, arm: str, acquisitions: int) -> Interval | None:
    """Mean over the runs of that coverage; None without any."""
    found = [coverage_after(record, acquisitions) for record in comparison.runs(part, arm)]
    return mean_interval(found) if found else None


def lead_after(comparison: Comparison, part: str, ours: str, theirs: str, acquisitions: int) -> Difference | None:
    """That coverage of one arm less that of another, start by start [-]; None without pairs."""
    pairs = comparison.pairs(part, ours, theirs)
    found = [(coverage_after(a, acquisitions), coverage_after(b, acquisitions)) for a, b in pairs]
    return paired_difference(*zip(*found, strict=True)) if found else None


def needed(comparison: Comparison, part: str, arm: str, share: float | None) -> Needed | None:
    """Acquisitions until an arm first covers the share; None without runs, or where no share is asked for."""
    runs = comparison.runs(part, arm)
    if share is None or not runs:
        return None
    counts = np.array([_first_reached(record, share) for record in runs])
    median = float(np.median(counts))
    return Needed(share, median if np.isfinite(median) else None, int(np.isfinite(counts).sum()), len(runs))


def _first_reached(record: Record, share: float) -> float:
    """Acquisitions after which the share is covered for the first time; it may be lost again. Infinite: never."""
    reached = np.flatnonzero(record.coverage >= share)
    return float(reached[0] + 1) if len(reached) else np.inf


def seconds_each(record: Record, spent: TimeKind) -> float:
    """Mean time of an acquisition of a run [s]. A burst that an earlier run has taken costs no processor time."""
    return float(record.planning_s.mean()) if spent == "planning" else record.processor_s / len(record.kinds)


def mean_seconds_each(comparison: Comparison, part: str, arm: str, spent: TimeKind) -> Interval | None:
    """The same over the runs of an arm [s]; None without any."""
    found = [seconds_each(record, spent) for record in comparison.runs(part, arm)]
    return mean_interval(found) if found else None


def seconds_ratio(comparison: Comparison, part: str, ours: str, theirs: str, spent: TimeKind) -> Interval | None:
    """Time of an acquisition of one arm over that of another [-]: geometric mean over the pairs; None without any.

    The interval is that of the mean logarithm: twice and half as long are equally far from equal.
    """
    pairs = [[seconds_each(record, spent) for record in pair] for pair in comparison.pairs(part, ours, theirs)]
    known = [a / b for a, b in pairs if a > 0 and b > 0]
    if not known:
        return None
    mean = mean_interval(np.log(known).tolist())
    middle, low, high = np.exp([mean.mean, mean.low, mean.high]).tolist()
    return Interval(middle, low, high, mean.count)
