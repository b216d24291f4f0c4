"""The board's pose from images whose pose is known; and every view that is too poor for one is refused in one line."""

import sys

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.adapters.calibration.charuco import CharucoBoard, ViewRules, find_board, opencv, opencv_board
from franbv.frames import Intrinsics, look_at, rolled
from tests.franbv.adapters.calibration.board_images import BOARD, CAMERA, FLAT, board_image

N_VIEWS = 12
MEDIAN_MM, WORST_MM = 0.5, 2.0
"""Of the camera's place at 0.25 to 0.4 m: 1 mm is the unit of the camera's own depth."""
MEDIAN_DEG, WORST_DEG = 0.1, 0.3
"""Of its orientation: 0.1 deg is half a pixel."""


def views() -> list[RigidTransform]:
    """T_world_cam all around the board, rolled each otherwise."""
    rng = np.random.default_rng(3)
    poses = []
    for k in range(N_VIEWS):
        azimuth, elevation = np.radians([360 * k / N_VIEWS, rng.uniform(35, 80)])
        level = np.cos(elevation)
        eye = rng.uniform(0.25, 0.4) * np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])
        poses.append(rolled(look_at(eye, np.array([*rng.uniform(-0.02, 0.02, 2), 0.0])), rng.uniform(-90, 90)))
    return poses


def test_poses_are_found_to_fractions_of_a_millimetre():
    """Against the pose that the image was drawn from, noise and blur included."""
    found = []
    for k, T_world_cam in enumerate(views()):
        view = find_board(board_image(T_world_cam.inv() * FLAT, seed=k), CAMERA, BOARD)
        apart = (FLAT * view.T_cam_board.inv()).inv() * T_world_cam
        found.append((1e3 * np.linalg.norm(apart.translation), np.degrees(apart.rotation.magnitude())))
    (median_mm, median_deg), (worst_mm, worst_deg) = np.median(found, axis=0), np.max(found, axis=0)
    sys.stdout.write(
        f"\nChArUco at 640x360, {N_VIEWS} views: median {median_mm:.2f} mm and {median_deg:.3f} deg, worst "
        f"{worst_mm:.2f} mm and {worst_deg:.3f} deg\n"
    )
    assert median_mm < MEDIAN_MM
    assert median_deg < MEDIAN_DEG
    assert worst_mm < WORST_MM
    assert worst_deg < WORST_DEG


def test_the_boards_points_are_opencvs():
    """Frame and order of the corners are those that OpenCV numbers."""
    assert np.allclose(BOARD.points(), opencv_board(BOARD).getChessboardCorners(), atol=1e-7)


def test_half_a_board_will_do():
    """What the camera cuts off is not needed: that is why the squares carry markers."""
    T_world_cam = look_at(np.array([0.28, 0.0, 0.3]), np.array([0.28, 0.0, 0.0]))
    view = find_board(board_image(T_world_cam.inv() * FLAT), CAMERA, BOARD)
    assert 8 <= len(view.ids) < len(BOARD.points())
    assert np.linalg.norm((FLAT * view.T_cam_board.inv()).translation - T_world_cam.translation) < 1e-3 * WORST_MM


def straight_down(height: float) -> RigidTransform:
    """T_cam_board of a camera above the board."""
    return look_at(np.array([0.0, -0.05, height]), np.zeros(3)).inv() * FLAT


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("nothing", "0 corners found, 8 needed; bring it into the image"),
        ("a corner of it", r"[0-7] corners found, 8 needed"),
        ("another board", r"corners found, 8 needed|px off where they should"),
        ("other squares", "px off where they should, 0.05 allowed"),
        ("another stream", "image of 640x360, intrinsics of 1280x720"),
        ("far away", r"two poses \d+ deg apart explain the image alike; go nearer"),
    ],
)
def test_poor_views_are_refused(case: str, words: str):
    """Each with one line that says what to do."""
    image, camera, board, rules = board_image(straight_down(0.3)), CAMERA, BOARD, ViewRules()
    if case == "nothing":
        image = np.full_like(image, 120)
    elif case == "a corner of it":
        image[:, :470] = 120
        image[:150] = 120
    elif case == "another board":
        board = BOARD.model_copy(update={"dictionary": "6x6_50"})
    elif case == "other squares":
        camera, rules = Intrinsics(640, 360, 300.0, 340.0, 319.5, 179.5), ViewRules(max_reprojection_px=0.05)
    elif case == "another stream":
        camera = Intrinsics(1280, 720, 642.0, 642.0, 639.5, 359.5)
    elif case == "far away":
        camera = Intrinsics(640, 360, 4800.0, 4800.0, 319.5, 179.5)
        image = board_image(look_at(np.array([0.0, -1.5, 6.0]), np.zeros(3)).inv() * FLAT, camera)
    with pytest.raises(CalibrationError, match=words) as caught:
        find_board(image, camera, board, rules)
    assert "\n" not in str(caught.value)


def test_boards_that_cannot_be():
    """Markers larger than their squares, a dictionary that OpenCV lacks."""
    with pytest.raises(ValueError, match="markers stand inside the white squares"):
        CharucoBoard(squares_x=8, squares_y=6, square_m=0.02, marker_m=0.03)
    with pytest.raises(ValueError, match="dictionary"):
        CharucoBoard.model_validate(
            {"squares_x": 8, "squares_y": 6, "square_m": 0.03, "marker_m": 0.02, "dictionary": "x"}
        )


def test_without_opencv_the_mend_is_named(monkeypatch):
    """One line, and nothing of it was loaded before."""
    opencv.cache_clear()
    monkeypatch.setitem(sys.modules, "cv2", None)
    with pytest.raises(CalibrationError, match="cv2: not installed here; pip install opencv-python-headless"):
        opencv()
