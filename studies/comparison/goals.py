"""The goals of a comparison: what FRA was to reach on each part, wherever and by whichever cloud one compares."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, get_args

from studies.comparison.paper_numbers import FRA_LESS_PB_ON_D, FRA_LESS_RE_ON_D
from studies.comparison.paper_results import COMPARABLE, rising
from studies.comparison.statistics import At, Cloud, Comparison
from studies.statistics.intervals import Interval

ATS, CLOUDS = get_args(At), get_args(Cloud)


@dataclass(frozen=True)
class Goal:
    """A bound on the mean coverage of FRA less a baseline."""

    name: str
    """In the JSON."""
    part: str
    baseline: str
    low: float
    """Bounds [-], both of them allowed."""
    high: float = 1.0

    @property
    def words(self) -> str:
        """For people."""
        what = f"{self.part}: FRA less {self.baseline.upper()}"
        if self.high < 1.0:
            return f"{what} within {100 * self.high:.0f} points"
        return f"{what} at least +{100 * self.low:.0f} points"

    def holds(self, mean: float) -> bool:
        """Whether the mean lies between the bounds."""
        return self.low <= mean <= self.high


GOALS = (
    Goal("fra_less_pb_on_d", "D", "pb", FRA_LESS_PB_ON_D),
    Goal("fra_less_re_on_d", "D", "re", FRA_LESS_RE_ON_D),
    Goal("fra_less_pb_on_a", "A", "pb", -COMPARABLE, COMPARABLE),
    Goal("fra_less_pb_on_b", "B", "pb", -COMPARABLE, COMPARABLE),
)


@dataclass(frozen=True)
class Judged:
    """A goal at one moment, by one cloud."""

    at: At
    cloud: Cloud
    interval: Interval
    holds: bool
    """Of the mean; the interval tells how surely."""


def judge(comparison: Comparison, goal: Goal) -> list[Judged]:
    """At the end, at equal iterations and at equal acquisitions, each raw and map-filtered; empty without pairs."""
    return list(_judged(comparison, goal))


def _judged(comparison: Comparison, goal: Goal) -> Iterator[Judged]:
    for at in ATS:
        for cloud in CLOUDS:
            found = comparison.difference(goal.part, "fra", goal.baseline, at, cloud)
            if found is not None:
                yield Judged(at, cloud, found.interval, goal.holds(found.interval.mean))


def activations_rise(comparison: Comparison) -> tuple[list[float | None], bool | None]:
    """Mean activations on A to D, and whether A <= B < C < D; None where a part has no runs."""
    found = [comparison.figure(part, "fra", "recovery_activations") for part in "ABCD"]
    known = [interval.mean for interval in found if interval]
    return [i.mean if i else None for i in found], rising(known) if len(known) == len(found) else None


def goals_json(comparison: Comparison) -> dict[str, Any]:
    """By the goals' names: `end`, `iterations`, `acquisitions`, each `raw` and `filtered`: mean, interval, holds."""
    activations, rise = activations_rise(comparison)
    return {
        **{goal.name: _goal_json(judge(comparison, goal)) for goal in GOALS},
        "activations_rise": {"mean": activations, "holds": rise},
    }


def _goal_json(judged: list[Judged]) -> dict[str, dict[str, Any]]:
    return {
        at: {
            j.cloud: {"mean": j.interval.mean, "ci95": [j.interval.low, j.interval.high], "holds": j.holds}
            for j in judged
            if j.at == at
        }
        for at in ATS
    }
