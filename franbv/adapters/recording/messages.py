"""The messages of a recording: what each topic carries, as models that are checked when they are read.

Images, calibration and poses have the JSON forms of Foxglove's schemas of the same names, so that its viewer and
others show them; the rest is ours. Matrices are 4 x 4, row by row, and numbers keep every bit. JSON is written and read
by Python's own module, which rounds neither way.
"""

import base64
import json
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from jaxtyping import Float
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.recording.contents import CameraFacts, RunFacts
from franbv.adapters.recording.depth_codes import PIXEL_TYPES
from franbv.frames import Intrinsics

RECORDING_FORMAT = 1
"""Of the messages; it rises when older readers would take them for something else."""
MOST_SIDE = 4096
"""Pixels along an image's side [px]. Choice: three times those of any depth camera; what says more is damaged."""
MOST_FRAMES = 1000
"""Frames of a burst [-]. Choice: half a minute at 30 Hz; what says more is damaged."""
WORLD_FRAME, CAMERA_FRAME = "world", "camera_depth"
"""Names of the coordinate frames in viewers."""
NS_PER_S = 1_000_000_000
ORTHONORMAL = 1e-6
"""By how much R^T R of a pose may differ from 1. Choice: text with seven digits passes, a flipped bit does not."""

Row = tuple[FiniteFloat, FiniteFloat, FiniteFloat, FiniteFloat]
Matrix4 = tuple[Row, Row, Row, Row]
Triple = tuple[FiniteFloat, FiniteFloat, FiniteFloat]
Index = Annotated[int, Field(ge=0)]


class Message(BaseModel):
    """A message of ours: unknown fields are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class ViewerMessage(BaseModel):
    """A message of Foxglove's: others may add fields."""

    model_config = ConfigDict(frozen=True, extra="ignore")


class HeaderMessage(Message):
    """First message: what decided the run, and the camera."""

    format: Index
    """RECORDING_FORMAT of the writer."""
    title: str
    planner: str | None
    parameters: dict[str, Any]
    """Fields of `Parameters`."""
    seed: Index
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


class BurstMessage(Message):
    """After the frames of a burst: what belongs to them. Frames without it are no burst."""

    index: Index
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
    times_ns: list[Index]
    """When each frame was taken [ns]."""
    motion_s: Annotated[FiniteFloat, Field(ge=0)]
    """Time of the move to the pose [s]."""


class ReachabilityMessage(Message):
    """Poses about which the arm was asked, and its answers, since the last such message."""

    poses: list[Matrix4]
    """T_world_cam [m]."""
    reachable: list[bool]


class BoxMessage(Message):
    """An oriented box."""

    centre: Triple
    """World frame [m]."""
    axes: tuple[Triple, Triple, Triple]
    """Unit axes as columns, row by row."""
    half_extents: Triple
    """Half of each side [m]."""


class DetectionMessage(Message):
    """Reflective regions in a burst."""

    candidate_pixels: Index
    """|I_c| [px]."""
    retained_pixels: Index
    """Candidates that were given a place [px]."""
    boxes: list[BoxMessage]
    """B_r, largest volume first."""


class RecoveryMessage(Message):
    """Poses for the recovery that a burst sets off, and what became of the others [-]."""

    poses: list[Matrix4]
    """T_world_cam [m]."""
    target: Triple
    """c_r [m]."""
    normal: Triple
    """n_r."""
    turned: bool
    n_pushed_back: Index
    """Moved back because of Min-Z."""
    n_too_near: Index
    """Dropped because of Min-Z."""
    n_under_table: Index
    """Dropped because of the table."""
    n_unreachable: Index
    """Dropped because of the arm."""


class DecisionMessage(Message):
    """What the planner decided at a burst: why it was taken, what it showed, what follows."""

    index: Index
    """Of the burst."""
    iteration: Index
    """NBV iteration; 0 = the first view."""
    kind: Literal["first", "nbv", "recovery"]
    T_world_cam: Matrix4
    """Pose of the burst [m]."""
    utility: FiniteFloat | None
    """U or U_r of the chosen pose, in the planner's unit."""
    n_unreachable: Index
    """Candidates that the arm could not reach [-]."""
    detection: DetectionMessage | None
    recovery: RecoveryMessage | None
    gamma: FiniteFloat | None
    """Gamma after a recovery view [-]."""
    gamma_attainable: FiniteFloat | None
    """Gamma over what a surface patch can attain [-]."""
    occupied_voxels: Index
    """Of the object [-]."""
    frontier_voxels: Index
    """Of the object [-]."""
    ellipsoids: Index
    """K_o + K_f [-]."""


class TimesMessage(Message):
    """How long an acquisition took; never compared."""

    index: Index
    """Of the burst."""
    planning_s: dict[str, FiniteFloat]
    """Processor time by stage [s]."""
    sensing_s: FiniteFloat
    """Wall time of the burst [s]."""


class StopMessage(Message):
    """Last message of a run that came to its end."""

    reason: str


class ImageMessage(ViewerMessage):
    """foxglove.RawImage."""

    timestamp: dict[str, Index]
    """`sec` [s] and `nsec` [ns]."""
    frame_id: str
    width: Annotated[int, Field(ge=1, le=MOST_SIDE)]
    """[px]."""
    height: Annotated[int, Field(ge=1, le=MOST_SIDE)]
    """[px]."""
    encoding: Literal[tuple(PIXEL_TYPES)]
    step: Index
    """Length of a row [bytes]."""
    data: str
    """base64."""


class CalibrationMessage(ViewerMessage):
    """foxglove.CameraCalibration of the depth image."""

    timestamp: dict[str, Index]
    """`sec` [s] and `nsec` [ns]."""
    frame_id: str
    width: Annotated[int, Field(ge=1, le=MOST_SIDE)]
    """[px]."""
    height: Annotated[int, Field(ge=1, le=MOST_SIDE)]
    """[px]."""
    distortion_model: str
    D: list[FiniteFloat]
    """All 0: the images are rectified."""
    K: Annotated[list[FiniteFloat], Field(min_length=9, max_length=9)]
    """Calibration matrix, row by row [px]."""
    R: Annotated[list[FiniteFloat], Field(min_length=9, max_length=9)]
    """Rectification, row by row."""
    P: Annotated[list[FiniteFloat], Field(min_length=12, max_length=12)]
    """Projection, row by row [px]."""


def stamp(time_ns: int) -> dict[str, int]:
    """A time in Foxglove's form."""
    return {"sec": time_ns // NS_PER_S, "nsec": time_ns % NS_PER_S}


def matrix_rows(T: RigidTransform) -> list[list[float]]:
    """The pose, row by row."""
    return T.as_matrix().tolist()


def pose_of(rows: Sequence[Sequence[float]]) -> RigidTransform:
    """The pose to the bit; ValueError for a matrix that is none."""
    matrix = np.array(rows, float)
    R = matrix[:3, :3]
    rigid = np.allclose(R.T @ R, np.eye(3), rtol=0, atol=ORTHONORMAL) and np.linalg.det(R) > 0
    if not (rigid and np.array_equal(matrix[3], [0.0, 0.0, 0.0, 1.0])):
        raise ValueError("a pose is no rotation with a translation")
    return RigidTransform(matrix, normalize=False)  # which would change the last bits


def pose_in_frame(T_world_cam: RigidTransform, time_ns: int) -> dict[str, Any]:
    """foxglove.PoseInFrame."""
    place, turn = _components(T_world_cam)
    return {"timestamp": stamp(time_ns), "frame_id": WORLD_FRAME, "pose": {"position": place, "orientation": turn}}


def frame_transform(T_world_cam: RigidTransform, time_ns: int) -> dict[str, Any]:
    """foxglove.FrameTransform, which puts the camera into a viewer's scene."""
    place, turn = _components(T_world_cam)
    frames = {"parent_frame_id": WORLD_FRAME, "child_frame_id": CAMERA_FRAME}
    return {"timestamp": stamp(time_ns), **frames, "translation": place, "rotation": turn}


def raw_image(data: bytes, size: tuple[int, int], coding: str, time_ns: int) -> dict[str, Any]:
    """foxglove.RawImage; size: width and height [px]."""
    width, height = size
    return {
        "timestamp": stamp(time_ns),
        "frame_id": CAMERA_FRAME,
        "width": width,
        "height": height,
        "encoding": coding,
        "step": width * PIXEL_TYPES[coding].itemsize,
        "data": base64.b64encode(data).decode(),
    }


def calibration(intrinsics: Intrinsics, time_ns: int) -> dict[str, Any]:
    """foxglove.CameraCalibration."""
    K = intrinsics.matrix
    return {
        "timestamp": stamp(time_ns),
        "frame_id": CAMERA_FRAME,
        "width": intrinsics.width,
        "height": intrinsics.height,
        "distortion_model": "plumb_bob",
        "D": [0.0] * 5,
        "K": K.ravel().tolist(),
        "R": np.eye(3).ravel().tolist(),
        "P": np.column_stack([K, np.zeros(3)]).ravel().tolist(),
    }


def intrinsics_of(width: int, height: int, K: Sequence[float] | Float[np.ndarray, "9"]) -> Intrinsics:
    """Of a calibration matrix, row by row; ValueError where it is none."""
    fx, fy, cx, cy = float(K[0]), float(K[4]), float(K[2]), float(K[5])
    if not (np.isfinite([fx, fy, cx, cy]).all() and fx > 0 and fy > 0):
        raise ValueError(f"K has the focal lengths {fx:g} and {fy:g} px")
    return Intrinsics(width, height, fx, fy, cx, cy)


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


def as_json(values: Mapping[str, Any]) -> bytes:
    """As it stands in the file; ValueError for NaN and infinity, which JSON does not have."""
    return json.dumps(values, allow_nan=False, separators=(",", ":")).encode()


def _components(T: RigidTransform) -> tuple[dict[str, float], dict[str, float]]:
    x, y, z = map(float, T.translation)
    qx, qy, qz, qw = map(float, Rotation.from_matrix(T.as_matrix()[:3, :3]).as_quat())
    return {"x": x, "y": y, "z": z}, {"x": qx, "y": qy, "z": qz, "w": qw}
