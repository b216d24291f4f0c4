"""Where a camera stands towards a ChArUco board: a chessboard whose white squares carry markers, so that part of it
will do.

OpenCV finds the corners (S. Garrido-Jurado et al., "Automatic generation and detection of highly reliable fiducial
markers under occlusion", Pattern Recognition 47, 2014) and the pose of the plane (T. Collins and A. Bartoli,
"Infinitesimal plane-based pose estimation", International Journal of Computer Vision 109, 2014). Frame of the board,
seen as printed: origin at its upper left corner, x to the right, y down, z into the board.
"""

import importlib
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np
from jaxtyping import Float, Int, UInt8
from pydantic import BaseModel, Field, model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.frames import Intrinsics
from franbv.parameters import Count, Positive

Dictionary = Literal[
    "4x4_50", "4x4_100", "4x4_250", "4x4_1000", "5x5_50", "5x5_100", "5x5_250", "5x5_1000",
    "6x6_50", "6x6_100", "6x6_250", "6x6_1000", "7x7_50", "7x7_100", "7x7_250", "7x7_1000",
]  # fmt: skip
"""OpenCV's families of markers."""
MIRRORED_RATIO = 2.0
"""A plane has two poses that explain its image; the second must fit this many times worse [-] (choice: below, noise
decides between them)."""
MIRRORED_DEG = 2.0
"""Unless they differ by less than this [deg] (choice: seen from straight above both are nearly one)."""


class CharucoBoard(BaseModel, frozen=True, extra="forbid", use_attribute_docstrings=True):
    """A board as it is printed. Measure it: printers scale.

    Frozen; unknown keys and numbers out of range raise pydantic's ValidationError.
    """

    squares_x: Count = Field(ge=3)
    """Squares along x, black and white ones [-]."""
    squares_y: Count = Field(ge=3)
    """Squares along y [-]."""
    square_m: Positive
    """Side of a square [m]."""
    marker_m: Positive
    """Side of a marker, its black border included [m]."""
    dictionary: Dictionary = "4x4_50"
    """Which markers it carries."""
    legacy: bool = False
    """Whether it was made by OpenCV before 4.6.0 with an even number of rows, which begins with a white square."""

    @model_validator(mode="after")
    def _markers_fit(self) -> "CharucoBoard":
        if self.marker_m >= self.square_m:
            raise ValueError("marker_m is not smaller than square_m: markers stand inside the white squares")
        return self

    def points(self) -> Float[np.ndarray, "k 3"]:
        """The inner corners in the board's frame [m], row by row."""
        x, y = np.meshgrid(np.arange(1, self.squares_x), np.arange(1, self.squares_y))
        return self.square_m * np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])


@dataclass(frozen=True)
class ViewRules:
    """What an image of the board must have before a pose is taken from it."""

    min_corners: int = 8
    """Inner corners that are found [-] (choice: twice the four that a plane's pose needs)."""
    max_reprojection_px: float = 1.0
    """Root mean square distance between corners found and corners expected from the pose [px] (choice: a good image has
    0.1 to 0.3; beyond 1 something is bent, blurred or another board)."""


@dataclass(frozen=True, eq=False)
class BoardView:
    """A board that was found."""

    T_cam_board: RigidTransform
    """Board to camera."""
    ids: Int[np.ndarray, "k"]
    """Which inner corners were found."""
    corners: Float[np.ndarray, "k 2"]
    """Where [px]."""
    reprojection_px: float
    """Root mean square distance to where the pose puts them [px]."""


@cache
def opencv() -> Any:
    """The module `cv2`; CalibrationError that names the mend where it is missing. Its functions have no types."""
    try:
        return importlib.import_module("cv2")
    except ImportError:
        raise CalibrationError("cv2: not installed here; pip install opencv-python-headless") from None


def opencv_board(board: CharucoBoard) -> Any:
    """OpenCV's form of the board."""
    cv2 = opencv()
    markers = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{board.dictionary.upper()}"))
    made = cv2.aruco.CharucoBoard((board.squares_x, board.squares_y), board.square_m, board.marker_m, markers)
    made.setLegacyPattern(board.legacy)
    return made


def find_board(
    image: UInt8[np.ndarray, "h w"], intrinsics: Intrinsics, board: CharucoBoard, rules: ViewRules | None = None
) -> BoardView:
    """The board in a rectified image; CalibrationError where it is not seen well enough to trust the pose."""
    if image.shape != (intrinsics.height, intrinsics.width):
        raise CalibrationError(
            f"image of {image.shape[1]}x{image.shape[0]}, intrinsics of {intrinsics.width}x{intrinsics.height}; "
            "give the intrinsics of this very stream"
        )
    rules = rules or ViewRules()
    ids, corners = _corners(image, board)
    if len(ids) < rules.min_corners:
        raise CalibrationError(
            f"board: {len(ids)} corners found, {rules.min_corners} needed; bring it into the image, light it evenly, "
            "switch the projector off, and check squares and dictionary"
        )
    if opencv_board(board).checkCharucoCornersCollinear(ids.astype(np.int32)):
        raise CalibrationError("board: only one row of corners is seen; bring more of it into the image")
    pose, error_px = _pose(board.points()[ids], corners, intrinsics)
    if error_px > rules.max_reprojection_px:
        raise CalibrationError(
            f"board: its corners lie {error_px:.2f} px off where they should, {rules.max_reprojection_px:g} allowed; "
            "hold still, lay the board flat, and check its numbers and the intrinsics"
        )
    return BoardView(pose, ids, corners, error_px)


def _corners(
    image: UInt8[np.ndarray, "h w"], board: CharucoBoard
) -> tuple[Int[np.ndarray, "k"], Float[np.ndarray, "k 2"]]:
    detector = opencv().aruco.CharucoDetector(opencv_board(board))
    corners, ids, _, _ = detector.detectBoard(image)
    if ids is None or len(ids) == 0:
        return np.zeros(0, int), np.zeros((0, 2))
    return np.asarray(ids, int).ravel(), np.asarray(corners, float).reshape(-1, 2)


def _pose(
    points: Float[np.ndarray, "k 3"], corners: Float[np.ndarray, "k 2"], intrinsics: Intrinsics
) -> tuple[RigidTransform, float]:
    """Pose of the plane and its root mean square error [px]; CalibrationError where two poses fit alike."""
    cv2 = opencv()
    K, no_distortion = intrinsics.matrix, np.zeros(5)
    _, rotvecs, places, _ = cv2.solvePnPGeneric(points, corners, K, no_distortion, flags=cv2.SOLVEPNP_IPPE)
    fits: list[tuple[float, RigidTransform]] = []
    for guess in zip(rotvecs, places, strict=True):
        rotvec, place = cv2.solvePnPRefineLM(points, corners, K, no_distortion, *guess)
        expected = cv2.projectPoints(points, rotvec, place, K, no_distortion)[0].reshape(-1, 2)
        error = float(np.sqrt(((expected - corners) ** 2).sum(axis=1).mean()))
        fits.append((error, RigidTransform.from_components(place.ravel(), Rotation.from_rotvec(rotvec.ravel()))))
    fits.sort(key=lambda fit: fit[0])
    error, pose = fits[0]
    for other_error, other in fits[1:]:
        apart_deg = np.degrees((pose.rotation.inv() * other.rotation).magnitude())
        if apart_deg > MIRRORED_DEG and other_error < MIRRORED_RATIO * error:
            raise CalibrationError(
                f"board: two poses {apart_deg:.0f} deg apart explain the image alike; go nearer, or look from more of "
                "a slant"
            )
    return pose, error
