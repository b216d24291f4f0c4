"""What a burst says of every pixel, at full resolution and after decimation: no depth, false depth or right depth.

A pixel is invalid if it has no depth in half of the frames or more, the planner's eta >= 0.5 (FRA-NBV, eq. 7), at both
resolutions; otherwise its depth is the median of its valid frames, which is what the planner maps. One frame will do.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, UInt16

from franbv.sensing import median_depth
from render.d435i import Measurement, SimulatedD435i
from render.depth.coding import metres_from_z16
from render.depth.decimation import pixel_blocks
from render.world.truth import Truth

INVALID_SHARE = 0.5
"""eta at and above which a pixel is invalid (FRA-NBV, eq. 7)."""
LEAST_FALSE = 0.005
"""Smallest error of false depth [m] (the paper's tolerance of coverage)."""
SUBPIXEL_RMS = 0.1
"""Of the noise law RMS_z = Z^2 subpixel_rms / (f B) [px] (D400 depth quality: 0.05 to 0.1 px; the larger one)."""
SIGMAS = 3.0
"""Errors within this many standard deviations are noise (the usual three)."""
SAME_MATCH_PX = 1.0
"""A disparity this near the truth belongs to the right match, whatever its noise [px] (choice: the matcher's own
left-right check allows 0.75 px)."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """Of one burst; the full-resolution maps count only inside the camera's window.

    `invalid`: no depth in half of the frames or more (FRA-NBV, eq. 7). False: |Z - truth| > max(5 mm, 3 sigma), with
    sigma = Z^2 0.1 px / (f B), of the median of the valid frames. `invalid_decimated` and `false_decimated` say the
    same of decimated depth, whose truth is the decimated truth (`perfect_blocks`).
    """

    invalid: Bool[np.ndarray, "h w"]
    is_false: Bool[np.ndarray, "h w"]
    """Has depth, and that is false."""
    invalid_decimated: Bool[np.ndarray, "h_d w_d"]
    false_decimated: Bool[np.ndarray, "h_d w_d"]

    @property
    def right(self) -> Bool[np.ndarray, "h w"]:
        """Has depth, and that is right."""
        return ~self.invalid & ~self.is_false

    @property
    def right_decimated(self) -> Bool[np.ndarray, "h_d w_d"]:
        """Has depth after decimation, and that is right."""
        return ~self.invalid_decimated & ~self.false_decimated


def burst_outcome(camera: SimulatedD435i, measurement: Measurement, truth: Truth) -> Outcome:
    """Judge a burst against the truth from the same pose."""
    depth = median_depth(measurement.depths, INVALID_SHARE)
    decimated = measurement.burst.median_depth(INVALID_SHARE)
    expected = median_depth(perfect_blocks(camera, measurement.z16, truth.depth), INVALID_SHARE)
    return Outcome(
        depth == 0,
        is_false_depth(depth, truth.depth, camera.rig.focal_baseline),
        decimated == 0,
        is_false_depth(decimated, expected, camera.rig.focal_baseline),
    )


def is_matched_rightly(camera: SimulatedD435i, measurement: Measurement, truth: Truth) -> Bool[np.ndarray, "h w"]:
    """Pixels with depth whose disparity is within SAME_MATCH_PX of the true one, at full resolution."""
    depth = median_depth(measurement.depths, INVALID_SHARE)
    both = (depth > 0) & (truth.depth > 0)
    far = np.float32(np.inf)
    error = camera.rig.focal_baseline * (1 / np.where(both, depth, far) - 1 / np.where(both, truth.depth, far))
    return both & (np.abs(error) <= SAME_MATCH_PX)


def persistently_invalid(depths: Float[np.ndarray, "n h w"] | UInt16[np.ndarray, "n h w"]) -> Bool[np.ndarray, "h w"]:
    """Pixels without depth (0) in half of the frames or more."""
    return np.count_nonzero(depths == 0, axis=0) >= INVALID_SHARE * len(depths)


def is_false_depth(
    depth: Float32[np.ndarray, "h w"], truth: Float32[np.ndarray, "h w"], focal_baseline: float
) -> Bool[np.ndarray, "h w"]:
    """Which depths [m] are wrong by more than noise: |Z - truth| > max(5 mm, 3 sigma); any depth where nothing is.

    focal_baseline: f B [px m]. 0 = no depth, nothing there.
    """
    sigma = truth**2 * (SUBPIXEL_RMS / focal_baseline)
    wrong = np.abs(depth - truth) > np.maximum(LEAST_FALSE, SIGMAS * sigma)
    return (depth > 0) & (wrong | (truth == 0))


def perfect_blocks(
    camera: SimulatedD435i, z16: UInt16[np.ndarray, "n h w"], truth_depth: Float32[np.ndarray, "h w"]
) -> Float32[np.ndarray, "n h_d w_d"]:
    """The truth that decimated depth is held against [m]: what decimation makes of the *true* depth of those pixels of
    a block that have depth. So only what the matcher did wrong counts, not that a block mixes near and far."""
    coding = camera.settings.depth
    true_units = np.rint(truth_depth / coding.unit)
    true_z16 = np.where(true_units <= np.iinfo(np.uint16).max, true_units, 0).astype(np.uint16)
    return metres_from_z16(camera.reduced(np.where(z16 > 0, true_z16, np.uint16(0))), coding)


def blocks(image: np.ndarray, camera: SimulatedD435i) -> np.ndarray:
    """The pixels behind each decimated and cropped one: (h, w) -> (h_d, w_d, factor^2)."""
    f, reduced, full = camera.settings.decimation, camera.intrinsics, camera.rig.intrinsics
    window = camera.window
    left, top = (window.left, window.top) if window else (0, 0)
    if image.shape != (full.height, full.width):
        raise ValueError(f"image of shape {image.shape} is not of full resolution, {full.height} x {full.width}")
    return pixel_blocks(image[top : top + reduced.height * f, left : left + reduced.width * f], f)
