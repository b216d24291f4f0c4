"""Images of a ChArUco board from a known pose: the board as OpenCV prints it, seen through a pinhole as a homography.

Drawn at several times the resolution and averaged, blurred and made noisy; none of the code under test is in it.
"""

from functools import cache

import cv2
import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.calibration.charuco import CharucoBoard
from franbv.frames import Intrinsics

BOARD = CharucoBoard(squares_x=8, squares_y=6, square_m=0.03, marker_m=0.022)
CAMERA = Intrinsics(640, 360, 321.0, 321.0, 319.5, 179.5)
"""A D435i's stream of 640x360 (docs/sensor.md)."""
FLAT = RigidTransform.from_components([-0.12, 0.09, 0.0], Rotation.from_euler("x", 180, degrees=True))
"""T_world_board of the board on the table, its middle at the origin: its z looks down, into the table."""
_PER_M = 6000
_FINER = 3


@cache
def printed() -> np.ndarray:
    """The sheet at 6 pixels a millimetre."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    board = cv2.aruco.CharucoBoard((8, 6), 0.03, 0.022, dictionary)
    return board.generateImage((round(0.24 * _PER_M), round(0.18 * _PER_M)), marginSize=0)


def board_image(
    T_cam_board: RigidTransform, camera: Intrinsics = CAMERA, seed: int = 0, noise: float = 2.0
) -> np.ndarray:
    """What the camera sees, 8 bits; noise: its standard deviation [DN]."""
    to_pixels = camera.matrix @ T_cam_board.as_matrix()[:3][:, [0, 1, 3]]  # of points of the plane z = 0
    to_metres = (
        np.array([[1, 0, 0.5], [0, 1, 0.5], [0, 0, _PER_M]]) / _PER_M
    )  # of the sheet's pixels, centres at integers
    finer = np.array([[_FINER, 0, (_FINER - 1) / 2], [0, _FINER, (_FINER - 1) / 2], [0, 0, 1]])
    size = camera.width * _FINER, camera.height * _FINER
    big = cv2.warpPerspective(printed(), finer @ to_pixels @ to_metres, size, borderValue=120)
    image = cv2.resize(big, (camera.width, camera.height), interpolation=cv2.INTER_AREA).astype(float)
    image = 20 + 0.7 * cv2.GaussianBlur(image, (0, 0), 0.7)
    image += np.random.default_rng(seed).normal(0, noise, image.shape)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)
