"""From disparities to the 16-bit depth that a D400 camera sends, and back to metres.

Z = f B / d, rounded to depth units; 0 = invalid.
"""

import numpy as np
from jaxtyping import Float32, UInt16
from pydantic import BaseModel, ConfigDict, Field

from franbv.frames import stereo_min_z

MOST_UNITS = 2**16 - 1
"""Largest z16 value."""


class DepthFormat(BaseModel):
    """How depth is coded; the depth table of librealsense's advanced mode.

    z16 = f B / (d unit) for a disparity d, rounded to the nearest; 0 where that is outside the clamps. A clamp never
    moves a depth. Unknown keys and numbers out of range raise pydantic's ValidationError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    unit: float = Field(default=1e-3, gt=0.0)
    """Depth of one z16 step [m] (librealsense: `depth_units`, default 1 mm)."""
    clamp_min: int = Field(default=0, ge=0, le=MOST_UNITS)
    """Nearer depth becomes invalid [units] (`depthclampmin`, default 0)."""
    clamp_max: int = Field(default=MOST_UNITS, ge=0, le=MOST_UNITS)
    """Farther depth becomes invalid [units] (`depthclampmax`; its default, 65536, exceeds what 16 bits hold)."""


def z_range(focal_baseline: float, disparity_shift: int = 0) -> tuple[float, float]:
    """Nearest and farthest Z-depth that the disparity search covers, Min-Z and Max-Z [m].

    focal_baseline: f B [px m]. disparity_shift: smallest disparity searched [px]; 0 puts Max-Z at infinity.
    Source: `franbv.frames.stereo_min_z`; Max-Z is the depth of the smallest disparity.
    """
    farthest = focal_baseline / disparity_shift if disparity_shift > 0 else float("inf")
    return stereo_min_z(focal_baseline, disparity_shift), farthest


def z16_from_disparity(
    disparity: Float32[np.ndarray, "*n h w"], focal_baseline: float, coding: DepthFormat | None = None
) -> UInt16[np.ndarray, "*n h w"]:
    """Depth in units of `coding.unit`, rounded to the nearest, 0 = invalid or out of the clamps.

    disparity: whole disparity, search start included [px], 0 = invalid. focal_baseline: f B [px m].
    """
    coding = coding or DepthFormat()
    with np.errstate(divide="ignore"):
        units = np.float32(focal_baseline / coding.unit) / disparity
    # In place: fresh memory costs more than the arithmetic.
    np.rint(units, out=units)
    np.copyto(units, 0, where=~((units >= coding.clamp_min) & (units <= coding.clamp_max)))
    return units.astype(np.uint16)


def metres_from_z16(
    z16: UInt16[np.ndarray, "*n h w"], coding: DepthFormat | None = None
) -> Float32[np.ndarray, "*n h w"]:
    """Z-depth [m], 0 = invalid."""
    return z16 * np.float32((coding or DepthFormat()).unit)
