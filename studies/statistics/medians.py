"""Medians over runs, and figures made of several medians, with bootstrap intervals.

Whole starts are drawn, so that methods which started alike stay together. The ends are those of
`studies.statistics.intervals.bootstrap_ends`: percentiles, moved outward for few runs. They never leave the range of
the runs, which holds the median of their law with probability 1 - 2 / 2^n: 95 % from six runs on.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from studies.statistics.intervals import bootstrap_ends, resampled

OfMedians = Callable[[Float[np.ndarray, "m k"]], Float[np.ndarray, "m"]]
"""A figure made of k medians, for each of m samples."""


@dataclass(frozen=True)
class MedianEstimate:
    """A median over runs, or a figure made of several."""

    value: float
    low: float
    """Lower end of the 95 % interval; the value itself when there is one run."""
    high: float
    count: int
    """Runs, or starts that all methods have in common."""


def median_interval(values: Sequence[float]) -> MedianEstimate:
    """Median and bootstrap interval of independent runs; there must be at least one."""
    return interval_of_medians(np.asarray(values, float)[:, None], lambda medians: medians[:, 0])


def interval_of_medians(runs: Float[np.ndarray, "n k"], figure: OfMedians) -> MedianEstimate:
    """The figure of the medians of k columns, one row a start."""
    if len(runs) == 0:
        raise ValueError("the median of no runs is undefined")
    drawn = figure(np.median(runs[resampled(len(runs))], axis=1))
    low, high = bootstrap_ends(drawn, len(runs))
    (value,) = figure(np.median(runs, axis=0)[None])
    return MedianEstimate(float(value), low, high, len(runs))


def first_less_second(medians: Float[np.ndarray, "m 2"]) -> Float[np.ndarray, "m"]:
    """Difference of two medians."""
    return medians[:, 0] - medians[:, 1]


def least_step_down(medians: Float[np.ndarray, "m k"]) -> Float[np.ndarray, "m"]:
    """Smallest fall from one median to the next; above zero where they are in falling order."""
    return (-np.diff(medians, axis=1)).min(axis=1)
