"""Main effects of a two-level design, their standard errors, and Lenth's check of them among each other.

An effect is the mean over the cells that have a decision at its second level less that over the others: the full
difference, twice the coefficient of a linear model in -1 and +1.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy import stats

from studies.statistics.intervals import LEVEL


@dataclass(frozen=True)
class Effect:
    """Of one decision on one figure, in the figure's unit."""

    value: float
    error: float | None
    """Standard error by the spread between starts within cells; None with one start a cell."""
    margin: float | None
    """Half the width of the 95 % interval by that error."""
    lenth_margin: float
    """Lenth's margin of error: half the same, from the other effects of the design."""

    @property
    def beyond(self) -> float:
        """The margin that the effect has to exceed: that of the starts, Lenth's without any."""
        return self.lenth_margin if self.margin is None else self.margin

    @property
    def is_sure(self) -> bool:
        """Whether it exceeds it."""
        return abs(self.value) > self.beyond

    @property
    def stands_out(self) -> bool:
        """Whether it is active by Lenth's check as well."""
        return abs(self.value) > self.lenth_margin


def effects_of(
    levels: Int[np.ndarray, "cells decisions"],
    measured: Float[np.ndarray, "cells"],
    single: Float[np.ndarray, "cells starts"],
) -> list[Effect]:
    """Of all decisions on one figure.

    levels: -1 and +1, orthogonal and balanced. measured: the figure of each cell, its median over the starts. single:
    the same of each start alone, NaN where there is none.
    """
    values = main_effects(levels, measured)
    error, freedom = effect_error(single)
    margin = None if error is None else float(stats.t.ppf(1 - LEVEL / 2, freedom) * error)
    lenth = lenth_margin(values)
    return [Effect(float(value), error, margin, lenth) for value in values]


def main_effects(
    levels: Int[np.ndarray, "cells decisions"], measured: Float[np.ndarray, "cells"]
) -> Float[np.ndarray, "decisions"]:
    """Mean at the second level less mean at the first."""
    return levels.T @ measured / (len(levels) / 2)


def effect_error(single: Float[np.ndarray, "cells starts"]) -> tuple[float | None, int]:
    """Standard error of an effect, and its degrees of freedom; None where no cell has two starts.

    The spread of the starts is pooled over the cells. All cells have the same starts, so what is peculiar to a start is
    in that spread and not in the effects: the error is rather too large.
    """
    counts = np.sum(~np.isnan(single), axis=1)
    freedom = int(np.sum(counts[counts > 0] - 1))
    if freedom == 0:
        return None, 0
    pooled = np.nansum([np.square(row - np.nanmean(row)) for row in single[counts > 0]]) / freedom
    of_medians = pooled * np.sum([median_variance(int(n)) for n in counts if n > 0])
    return float(np.sqrt(of_medians) / (len(single) / 2)), freedom


def median_variance(n: int) -> float:
    """Variance of the median of n normal values, over that of one.

    One and two: that of the mean. Three: 1 - sqrt(3) / pi (exact). More: pi / (2 n), that of many, which is never too
    small.
    """
    if n <= 2:
        return 1.0 / n
    return 1.0 - np.sqrt(3.0) / np.pi if n == 3 else np.pi / (2.0 * n)


PSE_FACTOR, PSE_TRIMMED = 1.5, 2.5
"""Of Lenth's pseudo standard error: the median of normal |effects| is 0.67 sigma, those above 2.5 are not noise."""


def lenth_margin(effects: Float[np.ndarray, "decisions"]) -> float:
    """Margin of error of effects of a design without repetitions, most of which are noise.

    Source: Lenth 1989, "Quick and easy analysis of unreplicated factorials", Technometrics 31(4), 469-473: t of m / 3
    degrees of freedom times the pseudo standard error.
    """
    sizes = np.abs(effects)
    first = PSE_FACTOR * np.median(sizes)
    pseudo_error = PSE_FACTOR * np.median(sizes[sizes < PSE_TRIMMED * first]) if first > 0 else 0.0
    return float(stats.t.ppf(1 - LEVEL / 2, len(effects) / 3) * pseudo_error)
