"""What is asked of a camera while the arm moves, and when it stands."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst, DepthCamera

PATIENCE_S = 1.0
"""Without a frame after which a camera counts as gone [s] (choice: several frames at the slowest rate, 6 Hz)."""


@dataclass
class Pulse:
    """Whether frames still come."""

    drain: Callable[[], int]
    """Takes what lies in the camera's queue; how many frames that was."""
    clock: Callable[[], float] = time.monotonic
    """[s]"""

    def __post_init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """The arm begins to move: what came before does not count."""
        self._last = self.clock()

    def __call__(self) -> bool:
        """False after PATIENCE_S of silence."""
        if self.drain() > 0:
            self._last = self.clock()
        return self.clock() - self._last <= PATIENCE_S


@dataclass(frozen=True)
class StandingCamera:
    """Implements `DepthCamera`: another one, whose bursts have the pose that the arm tells, not the one asked for."""

    inner: DepthCamera
    camera_pose: Callable[[], RigidTransform]
    """T_world_cam now."""

    @property
    def intrinsics(self) -> Intrinsics:
        return self.inner.intrinsics

    @property
    def min_z(self) -> float:
        return self.inner.min_z

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """A burst from where the camera stands."""
        return self.inner.capture(self.camera_pose(), n_frames)
