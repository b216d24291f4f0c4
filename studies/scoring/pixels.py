"""How well one set of pixels finds another: counts, and the shares they give."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool


@dataclass(frozen=True)
class PixelScore:
    """Found pixels against true ones."""

    n_found: int
    n_true: int
    n_both: int

    @property
    def precision(self) -> float:
        """Share of the found pixels that are true; NaN if none is found."""
        return share(self.n_both, self.n_found)

    @property
    def recall(self) -> float:
        """Share of the true pixels that are found; NaN if there is none."""
        return share(self.n_both, self.n_true)

    @property
    def iou(self) -> float:
        """Pixels in both sets over pixels in either; NaN if both are empty."""
        return share(self.n_both, self.n_found + self.n_true - self.n_both)


def pixel_score(found: Bool[np.ndarray, "h w"], true: Bool[np.ndarray, "h w"]) -> PixelScore:
    """Compare two masks."""
    return PixelScore(int(found.sum()), int(true.sum()), int((found & true).sum()))


def share(part: float, whole: float) -> float:
    """part / whole; NaN of nothing."""
    return part / whole if whole > 0 else float("nan")
