"""Shares of the part's surface over poses and draws of noise, with intervals, and what is told apart.

What can be drawn again is a pose, and at each pose the noise: both are resampled, poses whole and within each its
seeds (a bootstrap in two stages; Davison and Hinkley 1997, section 3.8). All setups are resampled alike, as they see
the same poses and seeds, so that a difference has its own, narrower interval. Ends are widened for few poses as in
`studies.statistics.intervals`. They hold for one comparison at a time, not for all that a ranking makes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float

from studies.advise.score_store import ViewCounts
from studies.statistics.intervals import RESAMPLES, RESAMPLING_SEED, bootstrap_ends


@dataclass(frozen=True, eq=False)
class SurfaceShares:
    """Of one setup: areas of every pose and seed [m^2]."""

    seen: Float[np.ndarray, "poses seeds"]
    right: Float[np.ndarray, "poses seeds"]
    false: Float[np.ndarray, "poses seeds"]
    error_mm: float | None
    """Mean over views of the median error, weighted by surface with depth [mm]."""

    @classmethod
    def of(cls, views: Sequence[ViewCounts]) -> "SurfaceShares":
        """Of the counts of all poses."""
        seen, right, false = (
            np.array([[getattr(one, name) for one in view] for view in views], float)
            for name in ("seen", "right", "false")
        )
        pairs = [(c.error_mm, c.right + c.false) for view in views for c in view if c.error_mm is not None]
        weight = sum(w for _, w in pairs)
        return cls(seen, right, false, sum(e * w for e, w in pairs) / weight if weight else None)

    @property
    def right_share(self) -> float:
        """Right depth, of all surface that was seen [0, 1]."""
        return share_of(self.right, self.seen)

    @property
    def false_share(self) -> float:
        """False depth [0, 1]."""
        return share_of(self.false, self.seen)

    @property
    def hole_share(self) -> float:
        """No depth [0, 1]."""
        return 1 - self.right_share - self.false_share

    @property
    def resampled_right(self) -> Float[np.ndarray, "resamples"]:
        """Right share in every bootstrap sample."""
        chosen = _resampled(*self.seen.shape)
        seen = self.seen[chosen].sum(axis=(1, 2))
        return self.right[chosen].sum(axis=(1, 2)) / np.where(seen > 0, seen, 1)

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the right share."""
        return bootstrap_ends(self.resampled_right, len(self.seen))

    def gain_over(self, other: "SurfaceShares") -> tuple[float, float, float]:
        """Right share beyond another setup's from the same poses, and the 95 % interval of that difference."""
        low, high = bootstrap_ends(self.resampled_right - other.resampled_right, len(self.seen))
        return self.right_share - other.right_share, low, high


def share_of(part: Float[np.ndarray, "poses seeds"], whole: Float[np.ndarray, "poses seeds"]) -> float:
    """Pooled; 0 where nothing was seen."""
    total = float(whole.sum())
    return float(part.sum()) / total if total else 0.0


@lru_cache(8)
def _resampled(poses: int, seeds: int) -> tuple[np.ndarray, np.ndarray]:
    """Poses (resamples, poses, 1) and seeds (resamples, poses, seeds) of every bootstrap sample."""
    rng = np.random.default_rng(RESAMPLING_SEED)
    return rng.integers(poses, size=(RESAMPLES, poses, 1)), rng.integers(seeds, size=(RESAMPLES, poses, seeds))
