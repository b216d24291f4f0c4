"""The statistics of `tests.physics.depth_statistics` as they were published of real frames, and the same of any frames.

Source: 24 real D415 frames of rooms at 0.5 to 4 m, 1280x720, projector on, with a laser scanner's truth.
"""

from collections.abc import Mapping

import numpy as np

from tests.physics.depth_statistics import (
    LAGS,
    PROFILE,
    Frame,
    autocorrelation,
    by_contrast,
    by_incidence,
    edge_profile,
    half_occluded_shares,
    hole_blobs,
    robust_sigma,
    smooth_patches,
)

INCIDENCE_DEG = (0.0, 65.0, 70.0, 80.0, 90.0)
"""Bins; that from 65 to 70 deg is not published."""
CONTRAST_DN = (0.0, 0.7, 1.0, 2.0, 256.0)
"""Bins; that from 1 to 2 DN is not published."""
TOLERANCE = 0.25
"""Largest difference from a published number, as share of it, with which it counts as met."""


def _series(name: str, keys: tuple[int, ...], values: tuple[float, ...]) -> dict[str, float]:
    return {name.format(key): value for key, value in zip(keys, values, strict=True)}


REAL: Mapping[str, float] = {
    "noise of smooth patches, 10 % [px]": 0.09,
    "noise of smooth patches, median [px]": 0.14,
    "noise of smooth patches, 90 % [px]": 0.22,
    **_series("autocorrelation along x at {} px", LAGS, (0.98, 0.95, 0.85, 0.55, 0.26, 0.09)),
    **_series("autocorrelation along y at {} px", LAGS, (0.97, 0.92, 0.75, 0.34, 0.09, 0.01)),
    "half-occluded: hole": 0.62,
    "half-occluded: foreground's depth": 0.19,
    "half-occluded: true background": 0.05,
    "half-occluded: other": 0.14,
    **_series("left of a near edge, hole at {} px", PROFILE, (0.35, 0.71, 0.71, 0.52)),
    **_series("left of a near edge, foreground at {} px", PROFILE, (0.64, 0.23, 0.07, 0.02)),
    **_series("right of a near edge, hole at {} px", PROFILE[:3], (0.39, 0.24, 0.08)),
    **_series("right of a near edge, foreground at {} px", PROFILE[:3], (0.44, 0.08, 0.01)),
    "hole blobs, median size [px]": 2.0,
    "hole area in blobs of 1000 px and more": 0.81,
    "holes at incidence below 65 deg": 0.01,
    "holes at 70-80 deg": 0.027,
    "holes at 80-90 deg": 0.052,
    "error at incidence below 65 deg [px]": 0.22,
    "error at 70-80 deg [px]": 0.32,
    "error at 80-90 deg [px]": 0.35,
    "holes at contrast below 0.7 DN": 0.049,
    "holes at 0.7-1 DN": 0.010,
    "holes above 2 DN": 0.003,
}
"""By what they tell; shares unless a unit is named."""


def statistics(frames: list[Frame]) -> dict[str, float]:
    """What `REAL` holds, of these frames."""
    patches = [patch for frame in frames for patch in smooth_patches(frame)]
    sigma = np.percentile([robust_sigma(patch[np.isfinite(patch)]) for patch in patches], (10, 50, 90))
    x, y = (np.mean([autocorrelation(patch, axis) for patch in patches], axis=0) for axis in (1, 0))
    left, right = edge_profile(frames, "left"), edge_profile(frames, "right")[:3]
    tilt, contrast = by_incidence(frames, INCIDENCE_DEG)[[0, 2, 3]], by_contrast(frames, CONTRAST_DN)[[0, 1, 3]]
    parts = (sigma, x, y, half_occluded_shares(frames), left[:, 0], left[:, 1], right[:, 0], right[:, 1])
    values = np.concatenate([*parts, hole_blobs(frames), tilt[:, 1], tilt[:, 2], contrast[:, 1]])
    return dict(zip(REAL, values.tolist(), strict=True))


def is_met(name: str, value: float) -> bool:
    """Whether a number lies within `TOLERANCE` of the real one."""
    return abs(value - REAL[name]) <= TOLERANCE * REAL[name]
