"""Means with bootstrap intervals, and paired comparisons of two methods over the same starts.

Intervals are percentile bootstraps of the mean with the percentiles moved outward, so that few runs get the width that
Student's t would give them (Hesterberg 2015, "What teachers should know about the bootstrap": expanded percentiles). No
bootstrap leaves the range of the runs, which holds the mean of n runs of a symmetric law with probability 1 - 2 / 2^n:
75 % of three. The paired test is Fisher's: if the method made no difference, each run's difference could as well have
the other sign. Many tests are judged together (Holm 1979).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int
from scipy import stats

RESAMPLES = 10_000
"""Bootstrap samples (choice: the ends of the interval vary by a hundredth of its width)."""
CONFIDENCE = 0.95
"""Of the intervals (the usual one)."""
LEVEL = 1 - CONFIDENCE
"""A difference is told from none when its p is no larger."""
MOST_EXACT = 15
"""Runs up to which all 2^n signs are tried; beyond, 2^15 random ones."""
RESAMPLING_SEED = 0
"""Of the resampling: the same runs give the same figures."""


@dataclass(frozen=True)
class Interval:
    """A mean over runs."""

    mean: float
    low: float
    """Lower end of the 95 % interval; the mean itself when there is one run."""
    high: float
    count: int
    """Runs."""


@dataclass(frozen=True)
class Quartiles:
    """Of a sample."""

    lower: float
    median: float
    upper: float
    count: int


@dataclass(frozen=True)
class Difference:
    """One method less the other, run by run."""

    interval: Interval
    p: float
    """Two-sided, of the sign-flip test; 1 for a single run."""


def mean_interval(values: Sequence[float]) -> Interval:
    """Mean and bootstrap interval of independent runs; there must be at least one."""
    x = np.asarray(values, float)
    if len(x) == 0:
        raise ValueError("the mean of no runs is undefined")
    low, high = bootstrap_ends(x[resampled(len(x))].mean(axis=1), len(x))
    return Interval(float(x.mean()), low, high, len(x))


@lru_cache(maxsize=8)
def resampled(n: int) -> Int[np.ndarray, "resamples n"]:
    """Which of n runs each bootstrap sample holds; drawn once for each n, and not to be written to."""
    return np.random.default_rng(RESAMPLING_SEED).integers(n, size=(RESAMPLES, n))


def bootstrap_ends(values: Float[np.ndarray, "resamples"], n: int) -> tuple[float, float]:
    """Ends of the interval of a statistic of n runs, from its values in the bootstrap samples."""
    if n == 1:
        return float(values[0]), float(values[0])
    student = stats.t.ppf((1 - CONFIDENCE) / 2, n - 1)
    tail = stats.norm.cdf(student * np.sqrt(n / (n - 1)))
    low, high = np.quantile(values, [tail, 1 - tail])
    return float(low), float(high)


def quartiles(values: Sequence[float] | np.ndarray) -> Quartiles:
    """Of at least one value."""
    lower, median, upper = np.percentile(values, [25, 50, 75])
    return Quartiles(float(lower), float(median), float(upper), len(values))


def paired_difference(ours: Sequence[float], theirs: Sequence[float]) -> Difference:
    """Ours less theirs over runs that started alike."""
    differences = np.subtract(ours, theirs)
    return Difference(mean_interval(differences.tolist()), sign_flip_p(differences))


def sign_flip_p(differences: Sequence[float] | np.ndarray) -> float:
    """Share of all choices of signs whose mean is as far from zero as the one that was found."""
    d = np.asarray(differences, float)
    n = len(d)
    if n <= MOST_EXACT:
        signs = 1.0 - 2.0 * ((np.arange(2**n)[:, None] >> np.arange(n)) & 1)
    else:
        signs = np.random.default_rng(RESAMPLING_SEED).choice([-1.0, 1.0], size=(2**MOST_EXACT, n))
        signs[0] = 1.0  # the signs that were found are one of the choices
    sums = np.abs(signs @ d)
    return float(np.mean(sums >= np.abs(d.sum()) * (1 - 1e-12) - 1e-15))


def least_p(n: int) -> float:
    """Smallest p that n runs can give: all signs alike, one way or the other."""
    return 2.0 / 2 ** min(n, MOST_EXACT)


def holm(p_values: Sequence[float]) -> list[float]:
    """The p values adjusted for being many (Holm 1979), in their order."""
    order = np.argsort(p_values)
    adjusted = np.zeros(len(p_values))
    largest = 0.0
    for rank, k in enumerate(order):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[k]))
        adjusted[k] = largest
    return adjusted.tolist()
