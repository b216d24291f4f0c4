"""Shares over many cases: pooled counts, and means over repetitions with their 95 % bands."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

CONFIDENCE = 0.95
"""Of the bands (the usual one)."""


@dataclass(frozen=True)
class Estimate:
    """A mean over repetitions."""

    mean: float
    low: float
    """Lower end of the 95 % band, not below 0; the mean itself when there is one repetition."""
    high: float
    """Upper end, not above 1."""
    count: int
    """Repetitions."""


def mean_share(shares: Sequence[float]) -> Estimate:
    """Mean of shares in [0, 1] with Student's 95 % confidence interval of the mean, cut at 0 and 1.

    Repetitions differ in azimuth and noise. With a handful of them the interval is wide, as it should be.
    """
    values = np.asarray(shares, float)
    if len(values) == 0:
        raise ValueError("the mean of no shares is undefined")
    mean = float(values.mean())
    if len(values) == 1:
        return Estimate(mean, mean, mean, 1)
    quantile = float(student.ppf((1 + CONFIDENCE) / 2, len(values) - 1))
    half = quantile * float(values.std(ddof=1)) / len(values) ** 0.5
    return Estimate(mean, max(mean - half, 0.0), min(mean + half, 1.0), len(values))


def pooled(parts: Iterable[float | None], wholes: Iterable[float | None]) -> float | None:
    """Sum of the parts over sum of the wholes; None where there is nothing to have a share of."""
    whole = sum(n or 0 for n in wholes)
    return sum(n or 0 for n in parts) / whole if whole else None
