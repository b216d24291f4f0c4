"""Camera and arm as the loop sees them, with everything that they give and say written into a recording.

with RecordingWriter(path, run, camera_facts) as writer:
    watch = Watch(writer)
    run = reconstruct(watch.camera(camera), watch.arm(arm), planner, parameters, seed, observe=watch.observe)
    watch.stop(run.stop)
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import UInt8
from scipy.spatial.transform import RigidTransform

from franbv.acquisition import Acquisition
from franbv.adapters.recording.decisions import decision_of
from franbv.frames import Intrinsics
from franbv.sensing import Arm, DepthBurst, DepthCamera
from franbv.stopping import StopReason

InfraredOf = Callable[[int], UInt8[np.ndarray, "h w"] | None]
"""Number of a burst -> left infrared image of its first frame, None if there is none."""


TimesOf = Callable[[int], Sequence[int] | None]
"""Number of a burst -> when each of its frames was taken [ns], None where only the wall's clock knows."""


@runtime_checkable
class RecordingSink(Protocol):
    """Where a run is written: `franbv.adapters.recording.writer.RecordingWriter`, which loads the extra `record`."""

    def burst(
        self,
        burst: DepthBurst,
        T_asked: RigidTransform,
        motion_s: float,
        infrared: UInt8[np.ndarray, "h w"] | None,
        times_ns: Sequence[int] | None,
    ) -> None: ...
    def reachability(self, poses: Sequence[RigidTransform], reachable: Sequence[bool]) -> None: ...
    def decision(self, decision: Mapping[str, Any], planning_s: Mapping[str, float], sensing_s: float) -> None: ...
    def stop(self, reason: str) -> None: ...


@dataclass
class Watch:
    """What ties one run to one recording."""

    writer: RecordingSink
    infrared_of: InfraredOf = lambda number: None
    """Asked after each burst."""
    times_of: TimesOf = lambda number: None
    """Asked after each burst."""
    motion_s: float = field(default=0.0, init=False)
    """Time of the last move [s]."""
    _poses: list[RigidTransform] = field(default_factory=list, init=False)
    _reachable: list[bool] = field(default_factory=list, init=False)
    _bursts: int = field(default=0, init=False)

    def camera(self, camera: DepthCamera) -> "WatchedCamera":
        """The camera to give to the loop in place of this one."""
        return WatchedCamera(camera, self)

    def arm(self, arm: Arm) -> "WatchedArm":
        """The arm to give to the loop in place of this one."""
        return WatchedArm(arm, self)

    def observe(self, acquisition: Acquisition) -> None:
        """Write what was decided."""
        self.writer.decision(decision_of(acquisition), acquisition.planning_s, acquisition.sensing_s)

    def stop(self, reason: StopReason) -> None:
        """Write that the run came to its end."""
        self._write_reachability()
        self.writer.stop(str(reason))

    def refused(self, T_world_cam: RigidTransform) -> None:
        """Write that no way leads to a pose, whatever was said of it before."""
        self.asked(T_world_cam, reachable=False)
        self._write_reachability()

    def burst(self, T_asked: RigidTransform, burst: DepthBurst) -> None:
        """Write a burst, and what the arm was asked before it."""
        self._write_reachability()
        number = self._bursts
        self.writer.burst(burst, T_asked, self.motion_s, self.infrared_of(number), self.times_of(number))
        self._bursts += 1

    def asked(self, T_world_cam: RigidTransform, reachable: bool) -> None:
        """Keep an answer of the arm until it is written."""
        self._poses.append(T_world_cam)
        self._reachable.append(reachable)

    def _write_reachability(self) -> None:
        if self._poses:
            self.writer.reachability(self._poses, self._reachable)
            self._poses, self._reachable = [], []


@dataclass(frozen=True)
class WatchedCamera:
    """Implements `franbv.sensing.DepthCamera`: another one, whose bursts are written down."""

    inner: DepthCamera
    watch: Watch

    @property
    def intrinsics(self) -> Intrinsics:
        """Of the camera."""
        return self.inner.intrinsics

    @property
    def min_z(self) -> float:
        """Of the camera [m]."""
        return self.inner.min_z

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """The camera's burst, which is on disk before anything is done with it."""
        burst = self.inner.capture(T_world_cam, n_frames)
        self.watch.burst(T_world_cam, burst)
        return burst


@dataclass(frozen=True)
class WatchedArm:
    """Implements `franbv.sensing.Arm`: another one, whose answers are written down."""

    inner: Arm
    watch: Watch

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """The arm's answer."""
        reachable = bool(self.inner.reachable(T_world_cam))
        self.watch.asked(T_world_cam, reachable)
        return reachable

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """The arm's move."""
        self.watch.motion_s = self.inner.move_to(T_world_cam)
        return self.watch.motion_s
