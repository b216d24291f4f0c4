"""What follows from the infrared pair and the single frames of a view: depth, and all decimated images."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float32, UInt16

from franbv.sensing import median_depth
from render.depth.coding import metres_from_z16, z16_from_disparity
from render.depth.decimation import decimate, pixel_blocks
from render.labels.labels import most_frequent_cause
from render.matcher.interface import StereoMatcher
from render.world.rig import Rig
from studies.dataset.check.images import MOST_MEDIAN_ERROR, Images, LayerFault, false_limit
from studies.dataset.format.layers import decoded_layer
from studies.store.images import millimetres

BLOCK_ROUNDING = 1.1e-3
"""Of what a block of true depths gives: each is rounded to 1 mm twice, and so is their mean [m]."""

Frames = UInt16[np.ndarray, "n h w"]


def pair_faults(
    images: Images, frames: Frames | None, n_frames: int, matcher: StereoMatcher, rig: Rig
) -> Iterator[LayerFault]:
    """The infrared pair, matched again, gives the view's first frame.

    frames: single depth frames [mm]; None where they are not kept. Then a pixel without depth in all frames, or in
    none, must be so in the first one too.
    """
    disparity = matcher.match(images["gray"], images["gray_right"], None, rig.disparity_shift)
    first = z16_from_disparity(disparity[None], rig.focal_baseline)[0]
    if frames is not None:
        differ = first != frames[0]
    else:
        missing = images["missing_frames"]
        differ = (first == 0) & (missing == 0) | (first > 0) & (missing == n_frames)
    if differ.any():
        yield "gray", f"matched with gray_right it gives another depth at {np.count_nonzero(differ)} pixels"


def frame_faults(images: Images, frames: Frames) -> Iterator[LayerFault]:
    """Depth is the median of the frames, and as many are missing as have none. frames: [mm]."""
    if np.any(millimetres(median_depth(metres_from_z16(frames))) != images["depth"]):
        yield "depth", "is not the median of the frames"
    if "missing_frames" in images and np.any(np.count_nonzero(frames == 0, axis=0) != images["missing_frames"]):
        yield "missing_frames", "is not what the frames show"


def decimation_faults(images: Images, frames: Frames | None, factor: int, rig: Rig) -> Iterator[LayerFault]:
    """Decimated depth and labels are what the full-size ones give. frames: [mm]; None where they are not kept."""
    depth, cause = images["depth_decimated"], images["cause_decimated"]
    voted = most_frequent_cause(pixel_blocks(images["cause"], factor))
    if np.any((cause != voted) & (depth == 0)):
        yield "cause_decimated", "is not the most frequent cause of the blocks"
    if frames is None:
        yield from _bounds(images, factor)
        return
    if np.any(millimetres(median_depth(metres_from_z16(decimate(frames, factor)))) != depth):
        yield "depth_decimated", "is not what decimation makes of the frames"
        return
    yield from _false_blocks(images, frames, factor, rig)


def _bounds(images: Images, factor: int) -> Iterator[LayerFault]:
    """Of a median of frames that are not kept: a block has depth where a pixel has, and about the mean of theirs."""
    depth, expected = images["depth_decimated"], decimate(images["depth"][None], factor)[0]
    both = (depth > 0) & (expected > 0)
    if np.any((depth == 0) & (expected > 0)):
        yield "depth_decimated", "has none where pixels of the block have depth"
    error = np.abs(depth[both].astype(float) - expected[both]) / expected[both]
    if both.any() and np.median(error) > MOST_MEDIAN_ERROR:
        yield "depth_decimated", "is in another unit than depth, or of another view"


def _false_blocks(images: Images, frames: Frames, factor: int, rig: Rig) -> Iterator[LayerFault]:
    """False where decimated depth is off what decimation makes of the true depth of the same pixels."""
    true = millimetres(decoded_layer("depth_true", images["depth_true"]))
    perfect = decimate(np.where(frames > 0, true, np.uint16(0)), factor)
    expected: Float32[np.ndarray, "h w"] = median_depth(metres_from_z16(perfect))
    depth = metres_from_z16(images["depth_decimated"])
    called: Bool[np.ndarray, "h w"] = images["false_depth_decimated"] > 0
    limit = false_limit(expected.astype(float), rig)
    error = np.where(expected > 0, np.abs(depth - expected), np.inf)
    if np.any((depth > 0) & np.where(called, error < limit - BLOCK_ROUNDING, error > limit + BLOCK_ROUNDING)):
        yield "false_depth_decimated", "does not agree with decimated true depth"
