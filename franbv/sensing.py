"""What the planner needs of a depth camera and of an arm. The simulator and the real cell both provide it."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics


@dataclass(frozen=True)
class DepthBurst:
    """N_k depth frames taken from one pose, D_t(x) of the paper's section IV and eq. (5).

    Camera and scene stand still, so that frames differ by noise alone. Z-depth is measured along the optical axis and
    not along the ray. There are no infrared images and no truth in it.
    """

    depths: Float[np.ndarray, "n h w"]
    """Z-depth [m], float32, 0 = invalid."""
    intrinsics: Intrinsics
    """Intrinsics of `depths`, after decimation and crop."""
    T_world_cam: RigidTransform
    """Pose of the left infrared imager, the depth frame's origin."""

    def __post_init__(self) -> None:
        """Every code for "no depth" becomes 0; ValueError for depth that is not in metres."""
        depths = metric_depths(self.depths)
        if depths.shape[1:] != (self.intrinsics.height, self.intrinsics.width):
            raise ValueError(
                f"depths of shape {depths.shape} do not belong to intrinsics of {self.intrinsics.width} x "
                f"{self.intrinsics.height} pixels; give (frames, rows, columns) and the intrinsics of that image"
            )
        object.__setattr__(self, "depths", depths)

    def median_depth(self, invalid_share: float = 0.5) -> Float[np.ndarray, "h w"]:
        """One depth image of the burst [m]; see `median_depth`."""
        return median_depth(self.depths, invalid_share)


FARTHEST_M = 50.0
"""Median depth above which numbers are taken for millimetres [m] (choice: beyond every room in which an arm stands, and
as millimetres nearer than any depth camera measures)."""
SAMPLE = 10_000
"""Pixels whose median is asked for."""


def metric_depths(depths: np.ndarray) -> Float[np.ndarray, "n h w"]:
    """Depth frames [m] in which 0 alone means "no depth"; NaN, infinities and negative numbers, as other cameras code
    it (REP 118 has NaN, -inf and +inf), become 0. Frames that need no change are given back as they are.

    ValueError for anything but floating-point metres: integers, as 16-bit images have them, count millimetres.
    """
    if depths.ndim != 3:
        raise ValueError(f"depths have the shape {depths.shape}; give (frames, rows, columns)")
    if not np.issubdtype(depths.dtype, np.floating):
        raise ValueError(
            f"depths are {depths.dtype}; give Z-depth in metres as float32. Integers look like millimetres: "
            "divide by 1000"
        )
    valid = np.isfinite(depths) & (depths > 0)
    there = depths[valid]
    if len(there) and np.median(there[:: max(1, len(there) // SAMPLE)]) > FARTHEST_M:
        raise ValueError(
            f"depths are {np.median(there):.0f} in the median; give Z-depth in metres. These look like millimetres: "
            "divide by 1000"
        )
    return depths if np.all(valid | (depths == 0)) else np.where(valid, depths, depths.dtype.type(0))


def median_depth(depths: Float[np.ndarray, "n h w"], invalid_share: float = 0.5) -> Float[np.ndarray, "h w"]:
    """Median of each pixel's valid frames [m] where fewer than `invalid_share` of them are invalid, else 0."""
    n = len(depths)
    if n == 1:
        return depths[0]
    ordered = np.sort(np.moveaxis(depths, 0, -1), axis=-1)  # (h, w, n), invalid ones first
    n_valid = np.count_nonzero(ordered, axis=-1)
    ranks = np.minimum(n - n_valid + np.stack([np.maximum(n_valid - 1, 0) // 2, n_valid // 2]), n - 1)
    low, high = (np.take_along_axis(ordered, rank[..., None], axis=-1)[..., 0] for rank in ranks)
    return np.where((n - n_valid) / n < invalid_share, (low + high) / 2, depths.dtype.type(0))


@runtime_checkable
class DepthCamera(Protocol):
    """A depth camera whose pose is known.

    Poses are those of the depth frame, `T_world_cam`; how they were found (a robot's kinematics, a hand-eye
    calibration) is the implementation's affair. Anything with these members will do; `isinstance` looks at their names
    alone.
    """

    @property
    def intrinsics(self) -> Intrinsics:
        """Intrinsics of the depth frames that `capture` returns."""
        ...

    @property
    def min_z(self) -> float:
        """Smallest Z-depth that the sensor can measure [m]."""
        ...

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """Take `n_frames` depth frames from the given pose."""
        ...


@runtime_checkable
class Arm(Protocol):
    """A robot arm that carries the camera.

    Poses are those of the depth frame and not of the flange. The way between two poses is the implementation's affair
    (on the paper's bench MoveIt plans it, section VI); the planner asks only whether a pose can be taken.
    """

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """Whether the camera can stand at this pose without collision."""
        ...

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """Move the camera to this pose; returns the motion time [s]."""
        ...
