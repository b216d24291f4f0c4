"""An image shifted along its columns by part of a pixel, as an error of the stereo calibration shifts the right one."""

import cv2
import numpy as np
from jaxtyping import Float32, Float64

NODES = 14
"""Rows that a shifted one is interpolated from (choice: waves of four pixels and more keep their height to half a
percent; lens and rectification leave little of shorter ones)."""


def rows_shifted(image: Float32[np.ndarray, "h w"], down: float) -> Float32[np.ndarray, "h w"]:
    """The image of light `down` pixels lower, the border rows repeated.

    Every row is the polynomial through the rows nearest to its place (Lagrange), exact for what is smooth over them;
    beside bright edges it stops at 0. No blur: that of rectification is the lens's already.
    """
    moved = cv2.sepFilter2D(image, cv2.CV_32F, np.ones(1), _kernel(down), borderType=cv2.BORDER_REPLICATE)
    return np.maximum(moved, 0)


def _kernel(down: float) -> Float64[np.ndarray, "k"]:
    """Weights of the rows above to below, their middle the row itself."""
    place = -down
    nodes = np.arange(NODES) + int(np.floor(place)) - NODES // 2 + 1
    others = [np.delete(nodes, k) for k in range(NODES)]
    reach = int(np.abs(nodes).max())
    kernel = np.zeros(2 * reach + 1)
    kernel[nodes + reach] = [np.prod((place - o) / (n - o)) for n, o in zip(nodes, others, strict=True)]
    return kernel
