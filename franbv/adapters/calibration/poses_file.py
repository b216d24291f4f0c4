"""What a hand-eye calibration is made of: a JSON file of flange poses, each with an image of the board or the board's
pose.

    {"board": {"squares_x": 8, "squares_y": 6, "square_m": 0.03, "marker_m": 0.022, "dictionary": "4x4_50"},
     "camera": {"width": 1280, "height": 720, "fx": 642.1, "fy": 642.1, "cx": 639.5, "cy": 359.5},
     "poses": [{"T_base_flange": [0.41, 0.02, 0.55, 0.0, 0.99, 0.01, 0.1], "image": "000.png"},
               {"T_base_flange": [[...], [...], [...], [0, 0, 0, 1]], "T_cam_board": [...]}]}

Poses are 4 x 4 matrices by rows or x y z qx qy qz qw, in metres. Images are rectified, beside the file. A bare list of
poses will do where none has an image.
"""

import json
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from jaxtyping import Float, UInt8
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.adapters.calibration.charuco import CharucoBoard, ViewRules, find_board, opencv
from franbv.adapters.first_fault import first_fault
from franbv.frames import Intrinsics
from franbv.parameters import Count, Positive

STANDING_IN_M = 0.2
"""Side of the square whose corners stand for a board that is not described [m] (choice: about an A4 sheet)."""
_FARTHEST_M = 20.0
"""No arm is longer, no board farther [m] (choice)."""
_ROTATION_SLACK = 1e-2
"""Of a rotation matrix or quaternion that was written with few digits [-] (choice: three)."""
_Row = tuple[float, float, float, float]
_Pose = tuple[_Row, _Row, _Row, _Row] | tuple[float, float, float, float, float, float, float]


class _Strict(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class StreamIntrinsics(_Strict):
    """`franbv.frames.Intrinsics` of the stream that the images are of."""

    width: Count
    """Image width [px]."""
    height: Count
    """Image height [px]."""
    fx: Positive
    """Focal length along x [px]."""
    fy: Positive
    """Focal length along y [px]."""
    cx: float
    """Principal point [px]."""
    cy: float
    """Principal point [px]."""


class PosePair(_Strict):
    """A flange pose, and where the board was then."""

    T_base_flange: _Pose
    """Flange to robot base, as the robot says it [m]."""
    image: Path | None = None
    """Image of the board at that pose, beside the file."""
    T_cam_board: _Pose | None = None
    """Board to camera [m], where something else has found it."""

    @model_validator(mode="after")
    def _one_of_both(self) -> "PosePair":
        if (self.image is None) == (self.T_cam_board is None):
            raise ValueError("give either an image or T_cam_board")
        return self


class PosesFile(_Strict):
    """The whole file."""

    poses: Annotated[tuple[PosePair, ...], Field(min_length=1)]
    """In any order."""
    board: CharucoBoard | None = None
    """What is seen in the images."""
    camera: StreamIntrinsics | None = None
    """What they were taken with."""

    @model_validator(mode="after")
    def _images_are_described(self) -> "PosesFile":
        if any(pair.image for pair in self.poses) and (self.board is None or self.camera is None):
            raise ValueError("images need `board` and `camera` beside `poses`")
        return self

    def points(self) -> Float[np.ndarray, "k 3"]:
        """Points that stand for the board in its frame [m]."""
        if self.board is not None:
            return self.board.points()
        return STANDING_IN_M * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])


def read_poses_file(path: Path) -> PosesFile:
    """The file; CalibrationError that names the place where it is wrong."""
    said = stated_json(path)
    try:
        return PosesFile.model_validate({"poses": said} if isinstance(said, list) else said)
    except ValidationError as error:
        raise CalibrationError(f"{path}: {first_fault(error, 'the file')}; see docs/robot.md for the form") from error


def stated_json(path: Path) -> Any:
    """What a JSON file says; CalibrationError where there is none."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise CalibrationError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    except ValueError as error:  # no JSON, or no UTF-8
        raise CalibrationError(f"{path}: is no JSON file ({error}); write it anew") from error


def pose_pairs(path: Path, rules: ViewRules | None = None) -> tuple[PosesFile, RigidTransform, RigidTransform]:
    """The file, Ts_base_flange and Ts_cam_board of all its poses, those of images found in them."""
    file = read_poses_file(path)
    flanges, boards = [], []
    for k, pair in enumerate(file.poses):
        flanges.append(as_transform(pair.T_base_flange, f"{path}: poses.{k}.T_base_flange"))
        if pair.T_cam_board is not None:
            boards.append(as_transform(pair.T_cam_board, f"{path}: poses.{k}.T_cam_board"))
        else:
            boards.append(_board_pose(file, path.parent / str(pair.image), rules))
    return file, RigidTransform.concatenate(flanges), RigidTransform.concatenate(boards)


def _board_pose(file: PosesFile, image_path: Path, rules: ViewRules | None) -> RigidTransform:
    if file.board is None or file.camera is None:
        raise ValueError("an image without a board")  # the model has refused it
    intrinsics = Intrinsics(**file.camera.model_dump())
    image = read_image(image_path)
    try:
        return find_board(image, intrinsics, file.board, rules).T_cam_board
    except CalibrationError as error:
        raise CalibrationError(f"{image_path}: {error}") from error


def read_image(path: Path) -> UInt8[np.ndarray, "h w"]:
    """A grey image; CalibrationError where there is none."""
    cv2 = opencv()
    if not path.is_file():
        raise CalibrationError(f"{path}: no such image; images stand beside the file of poses")
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise CalibrationError(f"{path}: is no image that OpenCV reads; give PNG")
    return np.asarray(image, np.uint8)


def as_transform(pose: Any, place: str) -> RigidTransform:
    """A pose as it is written, 4 x 4 or 7 numbers; CalibrationError where it is none."""
    numbers = np.array(pose, float)
    if not np.isfinite(numbers).all():
        raise CalibrationError(f"{place}: not all numbers are finite; take the pose out")
    if numbers.shape == (4, 4):
        straight = np.abs(numbers[:3, :3] @ numbers[:3, :3].T - np.eye(3)).max() < _ROTATION_SLACK
        if not straight or np.linalg.det(numbers[:3, :3]) < 0 or np.any(numbers[3] != [0, 0, 0, 1]):
            raise CalibrationError(f"{place}: is no rotation and translation; write the matrix by rows, 0 0 0 1 last")
        place_m, rotation = numbers[:3, 3], Rotation.from_matrix(numbers[:3, :3])
    else:
        if abs(np.linalg.norm(numbers[3:]) - 1) > _ROTATION_SLACK:
            raise CalibrationError(f"{place}: its quaternion is not of length 1; write x y z qx qy qz qw")
        place_m, rotation = numbers[:3], Rotation.from_quat(numbers[3:])
    if np.linalg.norm(place_m) > _FARTHEST_M:
        raise CalibrationError(f"{place}: {np.linalg.norm(place_m):.0f} m away; are the numbers in mm? write metres")
    return RigidTransform.from_components(place_m, rotation)
