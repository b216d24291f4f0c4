"""What each change of fra-robust is worth: the arms that have some of them, part by part, after equal acquisitions."""

from collections.abc import Sequence
from dataclasses import dataclass

from studies.comparison.equal_acquisitions import lead_after, mean_after, reached_levels
from studies.comparison.statistics import Comparison
from studies.run.ablation import ABLATIONS
from studies.statistics.intervals import Difference, Interval

WHOLE_METHODS = ("fra", "pb", "re", "fra-robust")
"""Planners beside which the arms stand: without any of the changes, and with all of them."""
ROBUST_LEVELS = (10, 20, 30)
"""Acquisitions after which arms are compared [-] (choice: of the levels of planners every other, so that all parts fit
into one table)."""


@dataclass(frozen=True)
class RobustTable:
    """The arms on one part."""

    part: str
    shared: Comparison
    """Runs of those starts that ablations have: the planners may have more."""
    arms: Sequence[str]
    """Those that have runs there."""
    levels: Sequence[int]
    """Acquisitions to which all of them come."""

    def covers(self, arm: str, acquisitions: int) -> Interval | None:
        """Coverage of the map after so many acquisitions [-]."""
        return mean_after(self.shared, self.part, arm, acquisitions)

    def less_fra(self, arm: str, acquisitions: int) -> Difference | None:
        """That less FRA's, over the starts that both have; None of FRA itself."""
        return None if arm == "fra" else lead_after(self.shared, self.part, arm, "fra", acquisitions)

    def wrongly_free(self, arm: str) -> Interval | None:
        """Share of the surface's voxels that the map calls free at the end [-]."""
        return self.shared.figure(self.part, arm, "wrongly_free_share")


def robust_ablations() -> list[str]:
    """Names of the ablations that have some of fra-robust's changes, or lack some of them."""
    return [
        name
        for name, ablation in ABLATIONS.items()
        if ablation.change.robust is not None or ablation.planner == "fra-robust"
    ]


def robust_tables(comparison: Comparison) -> dict[str, RobustTable]:
    """A table for each part on which one of the ablations has runs, in the order of the runs."""
    named = robust_ablations()
    tables = {}
    for part in dict.fromkeys(record.part for record in comparison.records):
        starts = {record.run for name in named for record in comparison.runs(part, name)}
        if starts:
            shared = comparison.of_starts(starts)
            arms = [arm for arm in (*WHOLE_METHODS[:-1], *named, WHOLE_METHODS[-1]) if shared.runs(part, arm)]
            levels = [n for n in reached_levels(shared, [part], arms) if n in ROBUST_LEVELS]
            tables[part] = RobustTable(part, shared, arms, levels)
    return tables
