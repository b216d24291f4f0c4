"""How reconstructions get on: the map's coverage after each acquisition and second, and what going on would bring.

A run that has ended keeps its last coverage, so that every figure is of all runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from studies.drawing.svg import round_ticks
from studies.run.acquisition_table import MAP_COVERAGE
from studies.run.robot_seconds import robot_seconds
from studies.run.stored_run import StoredRun
from studies.statistics.intervals import Interval, mean_interval

AFTER = (5, 10, 15)
"""Acquisitions after which the page says what going on would bring (choice: early, midway and late in a run of
our presets)."""
MINUTE_S = 60.0
"""Time over which the gain of going on is told as well [s]."""
MOST_TIMES = 40
"""Times at which curves against time are evaluated, two more at most (choice: finer than the page shows)."""

MeanCurve = tuple[tuple[float, Interval], ...]
"""Variable, and mean coverage over runs with its 95 % interval."""


@dataclass(frozen=True, eq=False)
class RunProgress:
    """One reconstruction."""

    coverage: Float[np.ndarray, "k"]
    """Share of the visible surface within 5 mm of the map after each acquisition [-]."""
    ends_s: Float[np.ndarray, "k"]
    """Time since the start at which each acquisition is in the map [s]."""

    def after(self, acquisitions: int) -> float:
        """Coverage after so many acquisitions, one at least [-]."""
        return float(self.coverage[self._last(acquisitions)])

    def at(self, seconds: float) -> float:
        """Coverage so long after the start [-]; 0 before the first view is in the map."""
        n = int(np.searchsorted(self.ends_s, seconds, side="right"))
        return float(self.coverage[n - 1]) if n else 0.0

    def next_gain(self, acquisitions: int) -> float:
        """What the acquisition after these changes of the coverage [-]."""
        return self.after(acquisitions + 1) - self.after(acquisitions)

    def minute_gain(self, acquisitions: int) -> float:
        """What the minute after these acquisitions changes of the coverage [-]."""
        return self.at(float(self.ends_s[self._last(acquisitions)]) + MINUTE_S) - self.after(acquisitions)

    def _last(self, acquisitions: int) -> int:
        return min(acquisitions, len(self.coverage)) - 1


@dataclass(frozen=True)
class NextGain:
    """What going on brings, over all runs."""

    acquisitions: int
    """That are taken."""
    going_on: int
    """Runs that take more."""
    coverage: Interval
    """After them [-]."""
    next_acquisition: Interval
    """Change of the coverage by one more [-]."""
    next_minute: Interval
    """Change of the coverage within a minute [-]."""


def read_progress(case: Path) -> RunProgress:
    """Of a finished case."""
    stored = StoredRun(case)
    spent = np.sum(list(robot_seconds(stored).values()), axis=0)
    return RunProgress(np.array([row[MAP_COVERAGE] for row in stored.rows]), np.cumsum(spent))


def longest(runs: Sequence[RunProgress]) -> int:
    """Acquisitions of the longest run."""
    return max(len(run.coverage) for run in runs)


def by_acquisition(runs: Sequence[RunProgress], n: int) -> MeanCurve:
    """Mean coverage after 1, 2, ... n acquisitions."""
    return tuple((float(k), mean_interval([run.after(k) for run in runs])) for k in range(1, n + 1))


def times_until(end_s: float) -> list[float]:
    """Evenly spaced round times from 0 to the first that is not before the end [s]."""
    ticks = round_ticks(0.0, end_s, MOST_TIMES)
    return ticks if ticks[-1] >= end_s else [*ticks, round(ticks[-1] + ticks[1], 12)]


def by_second(runs: Sequence[RunProgress], times: Sequence[float]) -> MeanCurve:
    """Mean coverage at each of these times [s]."""
    return tuple((seconds, mean_interval([run.at(seconds) for run in runs])) for seconds in times)


def gains(runs: Sequence[RunProgress]) -> tuple[NextGain, ...]:
    """What going on brings after so many acquisitions as AFTER says, while any run goes on."""
    lengths = [len(run.coverage) for run in runs]
    return tuple(
        NextGain(
            n,
            sum(length > n for length in lengths),
            *(
                mean_interval([figure(run, n) for run in runs])
                for figure in (RunProgress.after, RunProgress.next_gain, RunProgress.minute_gain)
            ),
        )
        for n in AFTER
        if n < max(lengths)
    )
