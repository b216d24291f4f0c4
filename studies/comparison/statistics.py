"""What the runs of a comparison say: figures of each planner on each part, differences between planners, times."""

from collections.abc import Container, Iterable, Sequence
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from studies.comparison.records import CONTRIBUTED, Record
from studies.run.acquisition_table import MAP_COVERAGE, RAW_COVERAGE
from studies.statistics.boxes import TukeyBox, box_of
from studies.statistics.intervals import (
    Difference,
    Interval,
    Quartiles,
    mean_interval,
    paired_difference,
    quartiles,
)
from studies.statistics.medians import MedianEstimate, OfMedians, interval_of_medians, median_interval

At = Literal["end", "iterations", "acquisitions"]
"""Where two runs are compared: each at its own end (the paper), after as many NBV iterations as both made, or after as
many acquisitions as both made."""
Cloud = Literal["map", "raw"]
"""What the map holds at the time (the paper, whose coverage can fall), or all points ever seen."""
ATS, CLOUDS = get_args(At), get_args(Cloud)

FIGURES = (
    MAP_COVERAGE,
    CONTRIBUTED,
    RAW_COVERAGE,
    "filtered_coverage_5mm",
    "accuracy_mm",
    "f_score",
    "wrongly_free_share",
    "wrongly_occupied_share",
    "acquisitions",
    "nbv_iterations",
    "recovery_activations",
    "recovery_acquisitions",
    "recovery_share",
)
"""Of a run's figures, those whose median or mean over runs is told."""


class Comparison:
    """The finished runs, looked up by part and arm."""

    def __init__(self, records: Iterable[Record]) -> None:
        self.records = list(records)
        self._by_arm: dict[tuple[str, str], dict[int, Record]] = {}
        for record in self.records:
            self._by_arm.setdefault((record.part, record.arm), {})[record.run] = record

    def has(self, part: str) -> bool:
        """Whether any arm has runs on the part."""
        return any(record.part == part for record in self.records)

    def runs(self, part: str, arm: str) -> list[Record]:
        """The runs of one arm on one part, by the number of their start."""
        found = self._by_arm.get((part, arm), {})
        return [found[run] for run in sorted(found)]

    def pairs(self, part: str, ours: str, theirs: str) -> list[tuple[Record, Record]]:
        """The runs of two arms that started alike."""
        a, b = self._by_arm.get((part, ours), {}), self._by_arm.get((part, theirs), {})
        return [(a[run], b[run]) for run in sorted(a.keys() & b.keys())]

    def values(self, part: str, arm: str, name: str) -> list[float]:
        """One of FIGURES of each run that has it."""
        values = [record.summary[name] for record in self.runs(part, arm)]
        return [value for value in values if value is not None]

    def figure(self, part: str, arm: str, name: str) -> Interval | None:
        """Mean of one of FIGURES with its interval; None where there is no run that has it."""
        known = self.values(part, arm, name)
        return mean_interval(known) if known else None

    def median(self, part: str, arm: str, name: str = MAP_COVERAGE) -> MedianEstimate | None:
        """Median of one of FIGURES with its interval; None where there is no run that has it."""
        known = self.values(part, arm, name)
        return median_interval(known) if known else None

    def box(self, part: str, arm: str, name: str = MAP_COVERAGE) -> TukeyBox | None:
        """Quartiles and whiskers of the same."""
        known = self.values(part, arm, name)
        return box_of(known) if known else None

    def of_medians(self, part: str, arms: Sequence[str], figure: OfMedians) -> MedianEstimate | None:
        """A figure made of the arms' median coverages, over the starts that all of them have; None without any."""
        found = [self._by_arm.get((part, arm), {}) for arm in arms]
        starts = sorted(set.intersection(*(set(runs) for runs in found)))
        ends = np.array([[runs[start].summary[MAP_COVERAGE] for runs in found] for start in starts])
        return interval_of_medians(ends, figure) if starts else None

    def difference(self, part: str, ours: str, theirs: str, at: At = "end", cloud: Cloud = "map") -> Difference | None:
        """Coverage of ours less theirs [-]; None without pairs."""
        pairs = [compared_coverage(a, b, at, cloud) for a, b in self.pairs(part, ours, theirs)]
        return paired_difference(*zip(*pairs, strict=True)) if pairs else None

    def figure_difference(self, part: str, ours: str, theirs: str, name: str) -> Difference | None:
        """One of FIGURES, ours less theirs, over the pairs that have it."""
        pairs = [(a.summary[name], b.summary[name]) for a, b in self.pairs(part, ours, theirs)]
        known = [pair for pair in pairs if None not in pair]
        return paired_difference(*zip(*known, strict=True)) if known else None

    def change_of_lead(self, part: str, changed: tuple[str, str], whole: tuple[str, str]) -> Difference | None:
        """Lead of one arm over another at the end [-] under a change less that without, over the starts of all four.

        A mean of paired changes: few starts are made of a change, and their medians would throw half of them away.
        """
        leads = [
            {a.run: float(a.coverage[-1] - b.coverage[-1]) for a, b in self.pairs(part, *arms)}
            for arms in (changed, whole)
        ]
        starts = sorted(leads[0].keys() & leads[1].keys())
        return paired_difference(*([lead[run] for run in starts] for lead in leads)) if starts else None

    def of_starts(self, starts: Container[int]) -> "Comparison":
        """The runs of these starts alone."""
        return Comparison(record for record in self.records if record.run in starts)

    def iteration_time(
        self, part: str, arm: str, stage: str | None = None, overhead_s: float = 0.0
    ) -> Quartiles | None:
        """Quartiles over the runs of the average time of an NBV iteration [s]; None without any.

        stage: planning, motion or exposure, None = their sum. overhead_s: added for every view.
        """
        times = self._times(part, arm, stage, overhead_s)
        return quartiles([run.mean() for run in times]) if times else None

    def single_iteration_time(self, part: str, arm: str) -> Quartiles | None:
        """Quartiles over the NBV iterations of all runs [s]: hardly moved by what befalls few of them."""
        times = self._times(part, arm)
        return quartiles(np.concatenate(times)) if times else None

    def _times(
        self, part: str, arm: str, stage: str | None = None, overhead_s: float = 0.0
    ) -> list[Float[np.ndarray, "i"]]:
        """Of the iterations of each run that has any."""
        runs = [record for record in self.runs(part, arm) if record.iterations[-1] > 0]
        times = [record.iteration_times(overhead_s) for record in runs]
        return [row[stage] if stage else sum(row.values(), np.zeros(1)) for row in times]

    def time_ratio(self, parts: Iterable[str], ours: str, theirs: str, stage: str | None = None) -> float | None:
        """Mean over the parts, as far as both have runs, of the ratio of two arms' iteration times."""
        ratios = []
        for part in parts:
            a, b = self.iteration_time(part, ours, stage), self.iteration_time(part, theirs, stage)
            if a and b and b.median > 0:
                ratios.append(a.median / b.median)
        return float(np.mean(ratios)) if ratios else None


def compared_coverage(a: Record, b: Record, at: At, cloud: Cloud) -> tuple[float, float]:
    """Coverage of two runs at the moment at which they are compared."""
    ours, theirs = (a.coverage, b.coverage) if cloud == "map" else (a.raw, b.raw)
    if at == "iterations":
        ours, theirs = a.by_iteration(ours), b.by_iteration(theirs)
    if at == "end":
        return float(ours[-1]), float(theirs[-1])
    last = min(len(ours), len(theirs)) - 1
    return float(ours[last]), float(theirs[last])
