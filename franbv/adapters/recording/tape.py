"""A recording in place of camera and arm: what was seen from a pose is given again when that pose is asked for."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.adapters.recording.contents import Recording
from franbv.adapters.recording.decisions import EQUAL_TO
from franbv.adapters.recording.open_loop import first_frames
from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst


class OffTapeError(Exception):
    """The planner asks for what the recording does not hold: a pose where nobody stood, or another burst at its end."""

    def __init__(self, at_end: bool) -> None:
        super().__init__("all bursts were given" if at_end else "the recording has no such pose")
        self.at_end = at_end
        """Whether all bursts were given."""


def same_pose(one: RigidTransform, other: RigidTransform) -> bool:
    """Whether two poses agree to EQUAL_TO, [m] and parts of a radian."""
    return bool(np.abs(one.as_matrix() - other.as_matrix()).max() <= EQUAL_TO)


@dataclass
class Tape:
    """Implements `DepthCamera` and `Arm` by what was recorded."""

    recording: Recording
    given: list[int] = field(default_factory=list)
    """Numbers of the bursts that were given."""
    asked_elsewhere: RigidTransform | None = None

    @property
    def intrinsics(self) -> Intrinsics:
        return self.recording.camera.intrinsics

    @property
    def min_z(self) -> float:
        return self.recording.camera.min_z

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        number = self._number_of(T_world_cam)
        self.given.append(number)
        return first_frames(self.recording.bursts[number], n_frames)

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """What the arm said last; a pose about which it was never asked counts as reachable."""
        near = np.abs(self._asked - T_world_cam.as_matrix()).max(axis=(1, 2), initial=0.0) <= EQUAL_TO
        return self.recording.reachability.reachable[int(np.flatnonzero(near)[-1])] if near.any() else True

    @property
    def is_at_end(self) -> bool:
        """Whether all bursts were given."""
        return len(self.given) == len(self.recording.bursts)

    @cached_property
    def _asked(self) -> Float[np.ndarray, "n 4 4"]:
        """The poses about which the arm was asked."""
        return np.array([T.as_matrix() for T in self.recording.reachability.poses]).reshape(-1, 4, 4)

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """Time of the move as it was [s]."""
        return self.recording.bursts[self._number_of(T_world_cam)].motion_s

    def _number_of(self, T_asked: RigidTransform) -> int:
        """The burst that was taken for this pose: the next one, or else any that was not given yet."""
        bursts = self.recording.bursts
        left = [k for k in range(len(bursts)) if k not in self.given]
        if not left:
            raise OffTapeError(at_end=True)
        fitting = [k for k in left if same_pose(bursts[k].T_asked, T_asked)]
        if not fitting:
            self.asked_elsewhere = T_asked
            raise OffTapeError(at_end=False)
        later = [k for k in fitting if not self.given or k > self.given[-1]]
        return (later or fitting)[0]
