"""What the planner needs of a depth camera and of an arm. The simulator and the real cell both provide it."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics


@dataclass(frozen=True)
class DepthBurst:
    """N_k depth frames taken from one pose."""

    depths: Float[np.ndarray, "n h w"]
    """Z-depth [m], float32, 0 = invalid."""
    intrinsics: Intrinsics
    """Intrinsics of `depths`, after decimation and crop."""
    T_world_cam: RigidTransform
    """Pose of the left infrared imager, the depth frame's origin."""


@runtime_checkable
class DepthCamera(Protocol):
    """A depth camera whose pose is known."""

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
    """A robot arm that carries the camera."""

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """Whether the camera can stand at this pose without collision."""
        ...

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """Move the camera to this pose; returns the motion time [s]."""
        ...
