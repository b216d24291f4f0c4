"""The messages of a recording: what each topic carries, as models that are checked when they are read.

Images, calibration and poses have the JSON forms of Foxglove's schemas of the same names, so that its viewer and
others show them (`franbv.adapters.recording.forms` makes them); the rest is ours. Matrices are 4 x 4, row by row.
"""

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from franbv.adapters.recording.contents import CameraFacts, RunFacts
from franbv.adapters.recording.depth_codes import PIXEL_TYPES

RECORDING_FORMAT = 1
"""Of the messages; it rises when older readers would take them for something else."""
MOST_SIDE = 4096
"""Pixels along an image's side [px]. Choice: three times those of any depth camera; what says more is damaged."""
MOST_FRAMES = 1000
"""Frames of a burst [-]. Choice: half a minute at 30 Hz; what says more is damaged."""

MatrixRow = tuple[FiniteFloat, FiniteFloat, FiniteFloat, FiniteFloat]
Matrix4 = tuple[MatrixRow, MatrixRow, MatrixRow, MatrixRow]
Triple = tuple[FiniteFloat, FiniteFloat, FiniteFloat]
Natural = Annotated[int, Field(ge=0)]
if TYPE_CHECKING:
    Coding = str
else:
    Coding = Literal[tuple(PIXEL_TYPES)]


class OwnMessage(BaseModel):
    """A message of ours: unknown fields are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class ViewerMessage(BaseModel):
    """A message of Foxglove's: others may add fields."""

    model_config = ConfigDict(frozen=True, extra="ignore")


class HeaderMessage(OwnMessage):
    """First message: what decided the run, and the camera."""

    format: Natural
    """RECORDING_FORMAT of the writer."""
    title: str
    planner: str | None
    parameters: dict[str, Any]
    """Fields of `Parameters`."""
    seed: Natural
    """Root of the planner's randomness [-]."""
    azimuth_deg: FiniteFloat
    """Where the first view stands [deg]."""
    ablation: dict[str, Any]
    """What of the planner's functions was changed."""
    sensor: dict[str, Any]
    """Settings of the camera."""
    versions: dict[str, str]
    min_z: Annotated[FiniteFloat, Field(ge=0)]
    """Smallest Z-depth that the camera can measure [m]."""
    depth_unit: Annotated[FiniteFloat, Field(gt=0)] | None
    """Depth of one step of 16-bit images [m]."""
    model: str | None
    serial: str | None
    firmware: str | None


class BurstMessage(OwnMessage):
    """After the frames of a burst: what belongs to them. Frames without it are no burst."""

    index: Natural
    """Counts bursts, from 0."""
    n_frames: Annotated[int, Field(ge=1, le=MOST_FRAMES)]
    """Depth images before this message that belong to it [-]."""
    infrared: bool
    """Whether a left infrared image stands before it, too."""
    depth_unit: Annotated[FiniteFloat, Field(gt=0)] | None
    """Depth of one step of its 16-bit images [m]."""
    T_world_cam: Matrix4
    """Where the camera stood [m]."""
    T_asked: Matrix4
    """Where the planner wanted it [m]."""
    times_ns: list[Natural]
    """When each frame was taken [ns]."""
    motion_s: Annotated[FiniteFloat, Field(ge=0)]
    """Time of the move to the pose [s]."""


class ReachabilityMessage(OwnMessage):
    """Poses about which the arm was asked, and its answers, since the last such message."""

    poses: list[Matrix4]
    """T_world_cam [m]."""
    reachable: list[bool]
    """Whether the camera can stand there."""


class BoxMessage(OwnMessage):
    """An oriented box."""

    centre: Triple
    """World frame [m]."""
    axes: tuple[Triple, Triple, Triple]
    """Unit axes as columns, row by row."""
    half_extents: Triple
    """Half of each side [m]."""


class DetectionMessage(OwnMessage):
    """Reflective regions in a burst."""

    candidate_pixels: Natural
    """|I_c| [px]."""
    retained_pixels: Natural
    """Candidates that were given a place [px]."""
    boxes: list[BoxMessage]
    """B_r, largest volume first."""


class RecoveryMessage(OwnMessage):
    """Poses for the recovery that a burst sets off, and what became of the others [-]."""

    poses: list[Matrix4]
    """T_world_cam [m]."""
    target: Triple
    """c_r [m]."""
    normal: Triple
    """n_r."""
    turned: bool
    """Whether these are the poses of the turned diamond."""
    n_pushed_back: Natural
    """Moved back because of Min-Z."""
    n_too_near: Natural
    """Dropped because of Min-Z."""
    n_under_table: Natural
    """Dropped because of the table."""
    n_unreachable: Natural
    """Dropped because of the arm."""


class DecisionMessage(OwnMessage):
    """What the planner decided at a burst: why it was taken, what it showed, what follows."""

    index: Natural
    """Of the burst."""
    iteration: Natural
    """NBV iteration; 0 = the first view."""
    kind: Literal["first", "nbv", "recovery"]
    T_world_cam: Matrix4
    """Pose of the burst [m]."""
    utility: FiniteFloat | None
    """U or U_r of the chosen pose, in the planner's unit."""
    n_unreachable: Natural
    """Candidates that the arm could not reach [-]."""
    detection: DetectionMessage | None
    recovery: RecoveryMessage | None
    gamma: FiniteFloat | None
    """Gamma after a recovery view [-]."""
    gamma_attainable: FiniteFloat | None
    """Gamma over what a surface patch can attain [-]."""
    occupied_voxels: Natural
    """Of the object [-]."""
    frontier_voxels: Natural
    """Of the object [-]."""
    ellipsoids: Natural
    """K_o + K_f [-]."""


class TimesMessage(OwnMessage):
    """How long an acquisition took; never compared."""

    index: Natural
    """Of the burst."""
    planning_s: dict[str, FiniteFloat]
    """Processor time by stage [s]."""
    sensing_s: FiniteFloat
    """Wall time of the burst [s]."""


class StopMessage(OwnMessage):
    """Last message of a run that came to its end."""

    reason: str


class FrameMessage(ViewerMessage):
    """What an image and its calibration have in common."""

    timestamp: dict[str, Natural]
    """`sec` [s] and `nsec` [ns]."""
    frame_id: str
    width: Annotated[int, Field(ge=1, le=MOST_SIDE)]
    """[px]."""
    height: Annotated[int, Field(ge=1, le=MOST_SIDE)]
    """[px]."""


class ImageMessage(FrameMessage):
    """foxglove.RawImage."""

    encoding: Coding
    step: Natural
    """Length of a row [bytes]."""
    data: str
    """base64."""


class CalibrationMessage(FrameMessage):
    """foxglove.CameraCalibration of the depth image."""

    distortion_model: str
    D: list[FiniteFloat]
    """All 0: the images are rectified."""
    K: Annotated[list[FiniteFloat], Field(min_length=9, max_length=9)]
    """Calibration matrix, row by row [px]."""
    R: Annotated[list[FiniteFloat], Field(min_length=9, max_length=9)]
    """Rectification, row by row."""
    P: Annotated[list[FiniteFloat], Field(min_length=12, max_length=12)]
    """Projection, row by row [px]."""


def header(run: RunFacts, camera: CameraFacts) -> dict[str, Any]:
    """The first message."""
    return {
        "format": RECORDING_FORMAT,
        "title": run.title,
        "planner": run.planner,
        "parameters": dict(run.parameters),
        "seed": run.seed,
        "azimuth_deg": run.azimuth_deg,
        "ablation": dict(run.ablation),
        "sensor": dict(run.sensor),
        "versions": dict(run.versions),
        "min_z": camera.min_z,
        "depth_unit": camera.depth_unit,
        "model": camera.model,
        "serial": camera.serial,
        "firmware": camera.firmware,
    }
