"""How reflection spoils a match, read off the infrared pair at a pixel and at its *true* partner on the right.

Tried in this order: saturated (a window that is white has no contrast either), dark, disagreeing. A pixel whose windows
are bright enough and agree, yet was lost, fell with its surroundings (a segment too small to keep, a better match in a
mirror image beside it): it takes the sub-kind of the nearest pixel that shows one.
"""

import cv2
import numpy as np
from jaxtyping import Bool, Float, Float32, Int, UInt8
from scipy.ndimage import distance_transform_edt

from render.d435i import Measurement
from render.imager.settings import WHITE_LEVEL
from render.labels.causes import Cause
from render.world.rig import Rig
from render.world.truth import Truth

CENSUS_PX = 9
"""Side of the compared windows [px]: the census window of the D4 recipe."""
WHITE_SHARE = 0.25
"""A window with this share of white pixels is saturated (choice: the bits of white pixels against white ones are lost,
1 - 0.75^2 or nearly half of all pairs touch a white one)."""
LEAST_CONTRAST = 1.5
"""A window below this has nothing to match [DN]: three times the noise of real frames, 0.5 DN, where noise turns one
census bit in ten (arctan(1 / 3) / pi)."""
LEAST_AGREEMENT = 0.7
"""Windows of lower correlation share less than half of their variance [-]."""


def reflection_kinds(
    measurement: Measurement, truth: Truth, rig: Rig, pixels: Bool[np.ndarray, "h w"]
) -> UInt8[np.ndarray, "h w"]:
    """Sub-kind of reflection of the given pixels by what the burst's mean images show; MEASURED elsewhere."""
    left, right = (images.mean(axis=0, dtype=np.float32) for images in (measurement.lefts, measurement.rights))
    at = np.argwhere(pixels)
    v, u = at.T
    partners = true_partners(truth.depth, rig, at)
    column = np.rint(partners).astype(int)
    white = np.maximum(white_share(left)[v, u], white_share(right)[v, column]) >= WHITE_SHARE
    dark = np.maximum(contrast(left)[v, u], contrast(right)[v, column]) < LEAST_CONTRAST
    disagree = agreement(left, right, at, partners) < LEAST_AGREEMENT
    shown = np.zeros(pixels.shape, np.uint8)
    kinds = [Cause.REFLECTION_SATURATED, Cause.REFLECTION_DARK, Cause.REFLECTION_DISAGREEING]
    shown[v, u] = np.select([white, dark, disagree], kinds, Cause.MEASURED)
    return np.where(pixels, _spread(shown), np.uint8(Cause.MEASURED))


def is_white(measurement: Measurement, truth: Truth, rig: Rig) -> Bool[np.ndarray, "h w"]:
    """Pixels whose window, or that of their partner, is saturated in the burst's mean images."""
    left, right = (
        white_share(images.mean(axis=0, dtype=np.float32)) for images in (measurement.lefts, measurement.rights)
    )
    white = left >= WHITE_SHARE
    at = np.argwhere(~white & (truth.depth > 0))
    partners = np.rint(true_partners(truth.depth, rig, at)).astype(int)
    white[tuple(at.T)] = right[at[:, 0], partners] >= WHITE_SHARE
    return white


def looks_different(measurement: Measurement, other: Measurement, truth: Truth, rig: Rig) -> Bool[np.ndarray, "h w"]:
    """Pixels whose window, or that of their partner, is brighter or darker in the other burst by LEAST_CONTRAST."""
    left, right = (
        cv2.blur(np.abs(a.mean(axis=0, dtype=np.float32) - b.mean(axis=0, dtype=np.float32)), (CENSUS_PX, CENSUS_PX))
        for a, b in ((measurement.lefts, other.lefts), (measurement.rights, other.rights))
    )
    different = left >= LEAST_CONTRAST
    at = np.argwhere(~different & (truth.depth > 0))
    partners = np.rint(true_partners(truth.depth, rig, at)).astype(int)
    different[tuple(at.T)] = right[at[:, 0], partners] >= LEAST_CONTRAST
    return different


def _spread(shown: UInt8[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h w"]:
    """Every pixel takes the value of the nearest one that has any; disagreeing if none has."""
    if not shown.any():
        return np.full_like(shown, Cause.REFLECTION_DISAGREEING)
    nearest = np.zeros((2, *shown.shape), np.int32)
    distance_transform_edt(shown == 0, return_distances=False, return_indices=True, indices=nearest)
    return shown[nearest[0], nearest[1]]


def contrast(image: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Standard deviation of the grey values in the window around each pixel, even shading taken off [DN]."""
    size = (CENSUS_PX, CENSUS_PX)
    detail = image - cv2.blur(image, size)
    # OpenCV's running sums leave rounding below zero where all is equal.
    return np.sqrt(np.maximum(cv2.blur(detail**2, size), 0))


def white_share(image: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Share of white pixels in the window around each pixel."""
    return cv2.blur((image >= WHITE_LEVEL).astype(np.float32), (CENSUS_PX, CENSUS_PX))


def true_partners(
    truth_depth: Float32[np.ndarray, "h w"], rig: Rig, pixels: Int[np.ndarray, "n 2"]
) -> Float[np.ndarray, "n"]:
    """Column in the right image where the point behind each pixel (v, u) really is, clipped to the image."""
    v, u = pixels.T
    return np.clip(u - rig.focal_baseline / truth_depth[v, u], 0, rig.intrinsics.width - 1)


def agreement(
    left: Float32[np.ndarray, "h w"],
    right: Float32[np.ndarray, "h w"],
    pixels: Int[np.ndarray, "n 2"],
    partners: Float[np.ndarray, "n"],
) -> Float[np.ndarray, "n"]:
    """Normalised correlation [-1, 1] of the windows around pixels (v, u) and their partners, columns interpolated."""
    offsets = np.arange(CENSUS_PX) - CENSUS_PX // 2
    h, w = left.shape
    rows = np.clip(pixels[:, 0, None, None] + offsets[:, None], 0, h - 1)  # (n, 9, 1)
    a = left[rows, np.clip(pixels[:, 1, None, None] + offsets, 0, w - 1)]
    columns = np.clip(partners[:, None, None] + offsets, 0, w - 1.001)
    first = columns.astype(int)
    b = right[rows, first] + (columns - first) * (right[rows, first + 1] - right[rows, first])
    a, b = (x - x.mean(axis=(1, 2), keepdims=True) for x in (a, b))
    scale = np.sqrt(np.sum(a**2, axis=(1, 2)) * np.sum(b**2, axis=(1, 2)))
    return np.sum(a * b, axis=(1, 2)) / np.maximum(scale, 1e-9)
