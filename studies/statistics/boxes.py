"""Boxes of a box plot: median, quartiles and whiskers of a sample (Tukey 1977)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

WHISKER_REACH = 1.5
"""Farthest whisker from its end of the box, in heights of the box [-] (Tukey 1977)."""


@dataclass(frozen=True)
class TukeyBox:
    """In the unit of the sample; what a published chart does not show is None."""

    median: float
    lower: float | None = None
    """First quartile."""
    upper: float | None = None
    """Third quartile."""
    low: float | None = None
    """End of the lower whisker: the smallest value within its reach."""
    high: float | None = None
    """End of the upper whisker."""
    count: int | None = None
    """Size of the sample."""

    def scaled(self, factor: float) -> "TukeyBox":
        """The same in another unit."""
        ends = (None if end is None else factor * end for end in (self.lower, self.upper, self.low, self.high))
        return TukeyBox(factor * self.median, *ends, count=self.count)

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest of what is known."""
        known = [end for end in (self.median, self.lower, self.upper, self.low, self.high) if end is not None]
        return min(known), max(known)


def box_of(values: Sequence[float] | np.ndarray) -> TukeyBox:
    """Of at least one value; values beyond the whiskers are left out."""
    x = np.asarray(values, float)
    lower, median, upper = np.percentile(x, [25, 50, 75])
    reach = WHISKER_REACH * (upper - lower)
    inside = x[(x >= lower - reach) & (x <= upper + reach)]
    return TukeyBox(float(median), float(lower), float(upper), float(inside.min()), float(inside.max()), len(x))
