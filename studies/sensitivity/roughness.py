"""The critical roughness: below which alpha the two imagers see different highlights, measured and in theory.

Where a surface faces camera and projector, the half-vectors of the two imagers differ by B / (2 Z). A narrower lobe
shows the highlight of a dot to one imager at most, or to both at different places: the match fails, or locks on mirror
images. So the share of unusable pixels must fall where alpha, the slope of most facets, passes B / (2 Z).
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import exp, log

from render.world.rig import BASELINE
from studies.sensitivity.shares import Row
from studies.statistics.intervals import Interval, mean_interval
from studies.statistics.shares import pooled

HALF = 0.5
"""Of the largest share: where the curve has fallen so far, it bends (choice: the usual half width). Not half of all
pixels, since even a mirror hides no more of the facing pixels than its highlight covers."""


@dataclass(frozen=True)
class RoughnessCurve:
    """Unusable share of the facing pixels against roughness."""

    subject: str
    distance_m: float
    points: tuple[tuple[float, Interval], ...]
    """(alpha, share over seeds and metals), rising alpha."""
    baseline: float = BASELINE
    """Of the camera [m]."""

    @property
    def theory(self) -> float:
        """B / (2 Z) [-]."""
        return self.baseline / (2 * self.distance_m)

    @property
    def bend_share(self) -> float:
        """HALF of the largest mean share."""
        return HALF * max(estimate.mean for _, estimate in self.points)

    @property
    def measured(self) -> float | None:
        """Alpha above which the mean share stays below HALF of its peak, interpolated in log alpha; None if it does
        not fall so far."""
        level = self.bend_share
        for (low, above), (high, below) in reversed(list(pairwise(self.points))):
            if above.mean >= level > below.mean:
                along = (above.mean - level) / (above.mean - below.mean)
                return exp(log(low) + along * (log(high) - log(low)))
        return None


def roughness_curves(rows: Sequence[Row], baseline: float = BASELINE) -> list[RoughnessCurve]:
    """One curve per subject and distance, of the rows whose roughness was given as a number. baseline: [m]."""
    shares: dict[tuple[str, float], dict[float, list[float]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        share = pooled([row["facing_unusable"]], [row["facing_pixels"]])
        if row["main_light"] and row["metal"] and row["finish"] is None and share is not None:
            shares[row["subject"], row["distance_m"]][row["alpha_u"]].append(share)
    return [
        RoughnessCurve(
            subject, distance, tuple((alpha, mean_interval(by_alpha[alpha])) for alpha in sorted(by_alpha)), baseline
        )
        for (subject, distance), by_alpha in sorted(shares.items())
    ]
