"""Poses, images and calibration in the forms of a recording's messages, and back.

JSON is written and read by Python's own module, which rounds neither way: numbers keep every bit.
"""

import base64
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.recording.depth_codes import PIXEL_TYPES
from franbv.frames import Intrinsics

WORLD_FRAME, CAMERA_FRAME = "world", "camera_depth"
"""Names of the coordinate frames in viewers."""
NS_PER_S = 1_000_000_000
PINHOLE_IF_ZERO = (
    "", "none", "plumb_bob", "rational_polynomial",
    "brown_conrady", "modified_brown_conrady", "inverse_brown_conrady",
)  # fmt: skip
"""Models of distortion that are pinholes where all coefficients are 0, by the names of ROS
(sensor_msgs/distortion_models.hpp) and librealsense (`rs2_distortion`), in lower case with _ for spaces."""
RECTIFY = "the planner has a pinhole; rectify the depth images, and record their new calibration"
"""The mend of a calibration with distortion."""
ORTHONORMAL = 1e-6
"""By how much R^T R of a pose may differ from 1. Choice: text with seven digits passes, a flipped bit does not."""


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


def lens_distortion(model: str, D: Sequence[float] | Float[np.ndarray, "n"]) -> str | None:
    """What a calibration says of its lens that a pinhole has not, in words; None where the images are rectified.

    model, D: name and coefficients. Models of wide lenses (equidistant, Kannala-Brandt, f-theta) are no pinholes even
    where all coefficients are 0.
    """
    coefficients = [float(d) for d in D]
    if model.strip().lower().replace(" ", "_") in PINHOLE_IF_ZERO and not any(coefficients):
        return None
    return f"{model or 'lens'} distortion ({', '.join(f'{d:.4g}' for d in coefficients)})"


def as_json(values: Mapping[str, Any]) -> bytes:
    """As it stands in the file; ValueError for NaN and infinity, which JSON does not have."""
    return json.dumps(values, allow_nan=False, separators=(",", ":")).encode()


def _components(T: RigidTransform) -> tuple[dict[str, float], dict[str, float]]:
    x, y, z = map(float, T.translation)
    qx, qy, qz, qw = map(float, Rotation.from_matrix(T.as_matrix()[:3, :3]).as_quat())
    return {"x": x, "y": y, "z": z}, {"x": qx, "y": qy, "z": qz, "w": qw}
