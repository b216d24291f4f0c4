"""Camera and arm of a run that goes on where a recording of it ends: what was taken is given again, then it is live."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.adapters.recording.tape import OffTapeError, Tape
from franbv.frames import Intrinsics
from franbv.sensing import Arm, DepthBurst, DepthCamera

SAME_FOCAL = 1e-3
"""By which focal lengths and centres of one camera may differ between two days, of themselves [-] (choice)."""


class CannotResumeError(Exception):
    """A recording that this run is not the continuation of; one line."""


@dataclass
class ResumedCell:
    """Implements `DepthCamera` and `Arm`: first the recording; nothing moves before it is used up."""

    tape: Tape
    camera: DepthCamera
    arm: Arm

    def __post_init__(self) -> None:
        """CannotResumeError where the camera is another one."""
        then, now = self.tape.intrinsics, self.camera.intrinsics
        same_size = (then.width, then.height) == (now.width, now.height)
        one, other = (np.array([i.fx, i.fy, i.cx, i.cy]) for i in (then, now))
        if not same_size or np.abs(one - other).max() > SAME_FOCAL * then.fx:
            raise CannotResumeError(
                f"{self.tape.recording.path}: was recorded by a camera with other intrinsics ({then}; this one has "
                f"{now}); use the same camera and profile, or begin a new run"
            )

    @property
    def intrinsics(self) -> Intrinsics:
        return self.tape.intrinsics

    @property
    def min_z(self) -> float:
        return self.tape.min_z

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """What the arm said then, or says now."""
        return (self.arm if self.tape.is_at_end else self.tape).reachable(T_world_cam)

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """Time of the move, then or now [s]."""
        return self._now_or_then(T_world_cam).move_to(T_world_cam)

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """The burst of then, or a new one."""
        if self.tape.is_at_end:
            return self.camera.capture(T_world_cam, n_frames)
        try:
            return self.tape.capture(T_world_cam, n_frames)
        except OffTapeError as left:
            raise self._otherwise() from left

    def _now_or_then(self, T_world_cam: RigidTransform) -> Arm:
        if self.tape.is_at_end:
            return self.arm
        try:
            self.tape.move_to(T_world_cam)
        except OffTapeError as left:
            raise self._otherwise() from left
        return self.tape

    def _otherwise(self) -> CannotResumeError:
        return CannotResumeError(
            f"{self.tape.recording.path}: after {len(self.tape.given)} bursts the planner asks for another pose than "
            "then; use the version that recorded it, or begin a new run"
        )
