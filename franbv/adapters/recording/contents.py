"""What a recording holds, whatever file it stands in: facts of run and camera, bursts with poses, decisions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst


class RecordingError(ValueError):
    """A recording that cannot be written or read; the message is one line with the file, the place and the mend."""


class NothingRecordedError(RecordingError):
    """A recording whose run was cut off before its first burst was whole."""


@dataclass(frozen=True)
class CameraFacts:
    """The camera of a recording: one stream of depth, as the planner gets it.

    What a file does not tell is None. Serial number and firmware are those that the device itself states.
    """

    intrinsics: Intrinsics
    min_z: float
    """Smallest Z-depth that the camera can measure [m]; 0 where it is not known, and then no pose is too near."""
    depth_unit: float | None = None
    """Depth of one step of the camera's 16-bit images [m]; None: depth is no such number."""
    model: str | None = None
    serial: str | None = None
    firmware: str | None = None


@dataclass(frozen=True)
class RunFacts:
    """What decided a run. A recording that no planner made has the defaults."""

    title: str = ""
    planner: str | None = None
    """By its name in `franbv.planners.PLANNERS`."""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    """Fields of `franbv.parameters.Parameters`."""
    seed: int = 0
    """Root of the planner's randomness [-]."""
    azimuth_deg: float = 0.0
    """Where the first view stands [deg]."""
    ablation: Mapping[str, Any] = field(default_factory=dict)
    """What of the planner's functions was changed; empty for the method as it is."""
    sensor: Mapping[str, Any] = field(default_factory=dict)
    """Settings of the camera, simulated or real, by the names that whoever recorded has for them."""
    versions: Mapping[str, str] = field(default_factory=dict)
    """Of the programs that made the run."""


@dataclass(frozen=True, eq=False)
class RecordedBurst:
    """A burst in a recording. Its frames stay on disk until they are asked for."""

    T_world_cam: RigidTransform
    """Where the camera stood."""
    T_asked: RigidTransform
    """Where the planner wanted it; the same where nothing else is known."""
    n_frames: int
    """Depth frames [-]."""
    times_ns: tuple[int, ...]
    """When each frame was taken, by the recording's clock [ns]."""
    motion_s: float
    """Time of the move to the pose [s]; 0 where it is not known."""
    read: Callable[[], DepthBurst]
    """The frames."""
    read_infrared: Callable[[], UInt8[np.ndarray, "h w"] | None] = lambda: None
    """Left infrared image of the first frame, None where there is none."""


@dataclass(frozen=True, eq=False)
class Reachability:
    """What the arm said of the poses that it was asked about."""

    poses: Sequence[RigidTransform]
    """T_world_cam, in the order in which they were asked about."""
    reachable: Sequence[bool]
    """Whether the camera can stand there."""


@dataclass(frozen=True, eq=False)
class Recording:
    """A recording as it was read."""

    path: Path
    run: RunFacts
    camera: CameraFacts
    bursts: tuple[RecordedBurst, ...]
    """In the order in which they were taken."""
    decisions: tuple[dict[str, Any], ...] = ()
    """What the planner decided at each burst, as `franbv.adapters.recording.decisions` has it; fewer than bursts where
    the run was cut off, none where no planner was there."""
    stop: str | None = None
    """The rule that ended the run; None: it was cut off, or no planner was there."""
    reachability: Reachability = field(default_factory=lambda: Reachability((), ()))
    options: Mapping[str, float | str] = field(default_factory=dict)
    """Options of the camera that the file states, by librealsense's names in lower case (`exposure`, `laser_power`)."""
    notices: tuple[str, ...] = ()
    """What a reader should know: an end that is missing, facts that are."""
