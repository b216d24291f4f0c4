"""librealsense's filters in the order of its recommended chain for the D400 family.

Decimation (`render.depth.decimation`, padded) and HDR merge come before it.

Source: librealsense, `get_ds_depth_recommended_proccesing_blocks` in `src/ds/ds-device-common.cpp`.
"""

import numpy as np
from jaxtyping import UInt16
from pydantic import BaseModel, ConfigDict

from render.depth.filters.disparity import (
    DepthOrDisparity,
    depth_from_disparity,
    disparity_factor,
    disparity_from_depth,
)
from render.depth.filters.hole_filling import HoleFillingSettings, holes_filled
from render.depth.filters.spatial import SpatialSettings, spatially_filtered
from render.depth.filters.temporal import TemporalFilter, TemporalSettings
from render.depth.filters.threshold import ThresholdSettings, in_range


class DepthFilters(BaseModel):
    """Which filters run, and how; None leaves one out. The defaults are what `get_recommended_filters()` of a D400 has.

    Unknown keys and numbers out of range raise pydantic's ValidationError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    threshold: ThresholdSettings | None = ThresholdSettings()
    """First of all, in depth."""
    in_disparity: bool = True
    """Whether the other three run on disparity; on depth otherwise."""
    spatial: SpatialSettings | None = SpatialSettings()
    """Before the temporal filter."""
    temporal: TemporalSettings | None = TemporalSettings()
    """Before hole filling."""
    hole_filling: HoleFillingSettings | None = HoleFillingSettings()
    """At the end."""


class FilterChain:
    """The chain with the memory of its temporal filter, for one stream."""

    def __init__(self, filters: DepthFilters, focal: float, baseline: float, unit: float) -> None:
        """focal: in x, of the images that come in, so of decimated ones less [px]. baseline [mm], unit of depth [m]."""
        self._filters = filters
        self._unit = unit
        self._factor = disparity_factor(focal, baseline, unit)
        self._temporal = None if filters.temporal is None else TemporalFilter(filters.temporal)

    def process(self, z16: UInt16[np.ndarray, "n h w"]) -> UInt16[np.ndarray, "n h w"]:
        """The next n frames of the stream [units], 0 = invalid."""
        if self._filters.threshold is not None:
            z16 = in_range(z16, self._unit, self._filters.threshold)
        if not self._filters.in_disparity:
            return self._smoothed(z16)
        return depth_from_disparity(self._smoothed(disparity_from_depth(z16, self._factor)), self._factor)

    def _smoothed(self, frames: DepthOrDisparity) -> DepthOrDisparity:
        if self._filters.spatial is not None:
            frames = spatially_filtered(frames, self._filters.spatial)
        if self._temporal is not None:
            frames = self._temporal.process(frames)
        return frames if self._filters.hole_filling is None else holes_filled(frames, self._filters.hole_filling)
