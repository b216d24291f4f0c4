"""Why a camera may have lost a pixel, told from its own depth and the left image alone.

Each pixel belongs to one class, whether it is a hole or not:
- `halo`: within 4 px (the census radius) of a point that a nearer one hides from the right imager;
- `edge`: within 4 px of any other depth step of more than 2 px of disparity;
- `bright`, `dark`, `interior`: the rest, by the mean of the left image over 9 x 9 pixels.
Holes of the reference are filled with the farther of their two neighbours along the row, as background shows there.
"""

from collections.abc import Mapping

import cv2
import numpy as np
from jaxtyping import Bool, Float, UInt8

NEAR_PX = 4
"""How far a 9 x 9 census reaches [px]."""
STEP_PX = 2.0
"""Disparity step that is a depth edge [px]; choice: a surface tilted by 80 deg changes less between two pixels."""
BRIGHT_DN, DARK_DN = 180, 40
"""Mean intensity above which a surface is bright, below which it is dark [DN]; choice: the highest 30 % and the
lowest 10 % above the pedestal of 17 DN."""
MARGIN_PX = 8
"""Left out along the image border and beside the left band [px], as the figures quoted for other matchers do."""


def filled(disparity: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    """Disparity with holes (0) filled along the row by the smaller of the two nearest valid ones."""
    w = disparity.shape[1]
    columns = np.broadcast_to(np.arange(w), disparity.shape)
    valid = disparity > 0
    before = np.maximum.accumulate(np.where(valid, columns, -1), axis=1)
    after = np.minimum.accumulate(np.where(valid, columns, w)[:, ::-1], axis=1)[:, ::-1]
    left = np.where(before >= 0, np.take_along_axis(disparity, np.maximum(before, 0), axis=1), np.inf)
    right = np.where(after < w, np.take_along_axis(disparity, np.minimum(after, w - 1), axis=1), np.inf)
    nearest = np.minimum(left, right)
    return np.where(np.isfinite(nearest), nearest, 0.0)


def scored_pixels(background: Float[np.ndarray, "h w"], factor: int) -> Bool[np.ndarray, "h w"]:
    """Pixels that scores count: not near the border, nor in or near the left band without a partner."""
    margin = MARGIN_PX // factor
    inside = np.zeros(background.shape, bool)
    inside[margin:-margin, margin:-margin] = True
    return inside & (np.arange(background.shape[1]) >= background / factor + margin)


def hidden_from_right(background: Float[np.ndarray, "h w"], factor: int) -> Bool[np.ndarray, "h w"]:
    """Pixels over which a nearer point further right passes in the right image (disparities in full pixels)."""
    disparity = background / factor
    columns = np.arange(disparity.shape[1])
    # Of all points to the right, the one that lands farthest left in the right image.
    landing = columns - disparity
    leftmost = np.minimum.accumulate(landing[:, ::-1], axis=1)[:, ::-1]
    hidden = np.zeros(disparity.shape, bool)
    hidden[:, :-1] = leftmost[:, 1:] <= landing[:, :-1]
    return hidden


def hole_classes(
    reference: Float[np.ndarray, "h w"], left: UInt8[np.ndarray, "h_l w_l"], factor: int
) -> Mapping[str, Bool[np.ndarray, "h w"]]:
    """Masks of the classes, disjoint and complete.

    reference: the camera's disparity in pixels of the pair, 0 = hole; factor: pixels of the pair per pixel of it.
    """
    background = filled(reference)
    near = np.ones((2 * NEAR_PX // factor + 1,) * 2, np.uint8)

    def widened(mask: np.ndarray) -> np.ndarray:
        return np.asarray(cv2.dilate(mask.astype(np.uint8), near)) > 0

    steps = np.zeros(reference.shape, bool)
    steps[:, 1:] |= np.abs(np.diff(background, axis=1)) > STEP_PX
    steps[1:] |= np.abs(np.diff(background, axis=0)) > STEP_PX
    halo = widened(hidden_from_right(background, factor))
    edge = widened(steps) & ~halo
    rest = ~halo & ~edge
    h, w = reference.shape
    mean = np.asarray(cv2.resize(cv2.blur(left, (9, 9)), (w, h), interpolation=cv2.INTER_AREA))
    bright, dark = rest & (mean >= BRIGHT_DN), rest & (mean <= DARK_DN)
    return {"halo": halo, "edge": edge, "bright": bright, "dark": dark, "interior": rest & ~bright & ~dark}
