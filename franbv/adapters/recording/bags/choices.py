"""What a recording that is not ours leaves open, and whoever reads it may say."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import UInt16

from franbv.frames import Intrinsics

Reduce = Callable[[UInt16[np.ndarray, "n h w"], Intrinsics], tuple[UInt16[np.ndarray, "n h2 w2"], Intrinsics]]
"""(16-bit frames, their intrinsics) -> those that the planner is to see: decimated, cropped."""


@dataclass(frozen=True)
class BagChoices:
    """What a recording that is not ours may leave open."""

    n_frames: int = 15
    """Frames of a burst [-]."""
    depth_topic: str | None = None
    pose_topic: str | None = None
    world_frame: str | None = None
    """Transforms: the frame in which the object stands on the plane z = 0."""
    poses: Path | None = None
    """File of poses, see `read_poses`; or our recording of the same run, which then says what was decided, too."""
    min_z: float | None = None
    """Smallest Z-depth that the camera can measure [m]."""
    reduced: Reduce | None = None
    """How frames are made smaller; None: as they are."""
