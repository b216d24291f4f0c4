"""Holes that geometry alone explains: range, overlap, occlusion, and the matcher's window around all three.

A matcher compares windows, so it also loses pixels *near* one that has no partner, and surfaces so steep that a window
of them looks different from the other side. Neither alone is a cause, since dark metal ends at edges and stands steep
too: such a pixel counts only if the matte twin has no right depth there either.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, UInt8

from render.d435i import SimulatedD435i
from render.labels.causes import Cause
from render.light.pattern import PROJECTORS
from render.world.rig import Rig
from render.world.truth import Truth

SUPPORT_PX = (12, 8)
"""How far a pixel of the left image can influence the cost of another, along x and y [px]: radius 4 of a 9x9 census
plus the longest arm of the aggregation, 8 and 4 (the D4 recipe; StereoSGBM's 5x5 blocks stay well within)."""
CENSUS_RADIUS_PX = 4
"""Of a 9x9 census window [px]."""
WHOLE_PX = 1.0
"""A window whose true disparities differ from its centre's by more than a whole step does not hold one surface patch
that looks alike from both sides [px]."""


@dataclass(frozen=True, eq=False)
class GeometricLimits:
    """Where geometry forbids depth, or the dots; all maps of the left image at full resolution.

    Read off the exact maps of the pose, so it is the same whatever the surfaces are made of. A pixel's window is all
    that lies within SUPPORT_PX of it. `impossible` settles a pixel by itself, the other maps only together with what
    the matte twin shows.
    """

    impossible: UInt8[np.ndarray, "h w"]
    """Cause of the pixels whose own point cannot be measured (out of range, no overlap, occlusion), else MEASURED."""
    window: UInt8[np.ndarray, "h w"]
    """Cause of the pixels whose window holds such a point, a depth edge or a steep surface, else MEASURED."""
    near_shadow: Bool[np.ndarray, "h w"]
    """The window holds a point that is hidden from the projector."""
    near_dark: Bool[np.ndarray, "h w"]
    """The window holds a point outside the projector's field."""


def geometry(camera: SimulatedD435i, truth: Truth) -> GeometricLimits:
    """From the exact maps of the pose."""
    coding = camera.settings.depth
    nearest = max(camera.rig.min_z, coding.clamp_min * coding.unit)
    farthest = min(camera.rig.max_z, coding.clamp_max * coding.unit)
    present = truth.depth > 0
    disparity = np.where(present, camera.rig.focal_baseline / np.maximum(truth.depth, 1e-6), 0).astype(np.float32)
    out_of_range = ~present | (truth.depth < nearest) | (truth.depth > farthest)
    no_overlap = present & ~truth.in_right_image
    hidden = truth.in_right_image & ~truth.visible_from_right
    broken = near(hidden | depth_edges(disparity)) | steep_windows(disparity)
    return GeometricLimits(
        _first([out_of_range, no_overlap, hidden], Cause.OCCLUSION),
        _first([near(out_of_range), near(no_overlap), broken], Cause.OCCLUSION_WINDOW),
        near(present & ~truth.visible_from_projector),
        near(present & ~in_projector_field(camera.rig, truth.depth)),
    )


def _first(masks: list[Bool[np.ndarray, "h w"]], last: Cause) -> UInt8[np.ndarray, "h w"]:
    """The first cause whose mask holds: out of range, no overlap, `last`."""
    return np.select(masks, [Cause.OUT_OF_RANGE, Cause.NO_OVERLAP, last], Cause.MEASURED).astype(np.uint8)


def in_projector_field(rig: Rig, depth: Float32[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Pixels whose point at this Z-depth [m] lies in the field that the projector's pattern fills."""
    rays = rig.intrinsics.pixel_directions()
    x = rays[..., 0] - rig.projector_offset / np.maximum(depth, 1e-6)
    half_x, half_y = PROJECTORS[rig.model].half_field
    return (np.abs(x) <= half_x) & (np.abs(rays[..., 1]) <= half_y)


def depth_edges(disparity: Float32[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Pixels on either side of a step of more than WHOLE_PX in true disparity [px]."""
    edge = np.zeros(disparity.shape, bool)
    across, down = (np.abs(np.diff(disparity, axis=axis)) > WHOLE_PX for axis in (1, 0))
    edge[:, 1:] |= across
    edge[:, :-1] |= across
    edge[1:] |= down
    edge[:-1] |= down
    return edge


def steep_windows(disparity: Float32[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Pixels whose census window holds a true disparity more than WHOLE_PX from their own [px].

    On a plane: where the disparity rises by a quarter step a pixel, tan(incidence) > Z / (4 B): 56 deg at 0.3 m.
    """
    window = np.ones((2 * CENSUS_RADIUS_PX + 1,) * 2, np.uint8)
    above, below = cv2.dilate(disparity, window) - disparity, disparity - cv2.erode(disparity, window)
    return np.maximum(above, below) > WHOLE_PX


def near(mask: Bool[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Pixels whose window of SUPPORT_PX holds a pixel of the mask."""
    x, y = SUPPORT_PX
    window = np.ones((2 * y + 1, 2 * x + 1), np.uint8)
    return cv2.dilate(mask.astype(np.uint8), window, borderType=cv2.BORDER_CONSTANT, borderValue=0) > 0
