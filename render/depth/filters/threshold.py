"""librealsense's threshold filter: depth outside a range becomes invalid.

Source: librealsense, `src/proc/threshold.cpp`.
"""

import numpy as np
from jaxtyping import UInt16
from pydantic import BaseModel, ConfigDict, Field


class ThresholdSettings(BaseModel):
    """The options of `rs2::threshold_filter`, in librealsense's ranges and with its defaults.

    Python's constructor, `rs.threshold_filter()`, has another default for the nearest: 0.15 m.
    Unknown keys and numbers out of range raise pydantic's ValidationError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    nearest: float = Field(default=0.1, ge=0.0, le=16.0)
    """Nearest depth that stays [m] (`min_distance`)."""
    farthest: float = Field(default=4.0, ge=0.0, le=16.0)
    """Farthest depth that stays [m] (`max_distance`)."""


def in_range(
    z16: UInt16[np.ndarray, "n h w"], unit: float, settings: ThresholdSettings | None = None
) -> UInt16[np.ndarray, "n h w"]:
    """The depth that lies in the range, both ends included, as far as products rounded to float32 hit them.

    unit: of depth [m].
    """
    settings = settings or ThresholdSettings()
    metres = z16 * np.float32(unit)
    stays = (metres >= np.float32(settings.nearest)) & (metres <= np.float32(settings.farthest))
    return np.where(stays, z16, np.uint16(0))
