"""Hand-eye calibration: where the camera sits on the flange, from flange poses and what the camera saw of a fixed
board.

For every pose i, T_base_flange_i X T_cam_board_i = Y with X = T_flange_cam and Y = T_base_board, both unknown. Between
two poses Y drops out, AX = XB, which has a closed form (F. C. Park and B. J. Martin, "Robot sensor calibration: solving
AX = XB on the Euclidean group", IEEE Transactions on Robotics and Automation 10, 1994). Least squares on the board's
points in the image then weigh what a camera knows well, directions, and what it knows badly, distance and tilt.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.calibration.calibration_error import CalibrationError

FEWEST_POSES = 3
"""Two motions about two axes: fewer leave X undetermined (Park and Martin, section III)."""
LEAST_TURN_DEG = 10.0
"""That the flange must turn between some two poses, about each of two axes [deg] (choice: errors of the board's pose go
into X divided by this angle, in radians, so that 0.2 deg there become 1 deg at 10 deg)."""
LARGEST_TURN_DEG = 170.0
"""Of a motion that enters the closed form [deg] (choice: at 180 deg the axis has two signs)."""
WORST_MM_PER_M = 20.0
"""Misfit of the board's place beyond which the poses do not belong together [mm per m of distance] (choice: ten times
what an industrial arm and a board at 0.5 m leave, about 1 mm)."""
WORST_DEG = 2.0
"""The same of its orientation [deg] (choice: ten times 0.2 deg)."""
_LEAST_DEPTH_M = 1e-3
"""A guess that puts the board behind the camera is held at this depth, so that least squares can leave it [m]."""


@dataclass(frozen=True, eq=False)
class HandEye:
    """X and Y, and how well they fit; the misfit of a pose is that of the board, seen against predicted, in the
    camera."""

    T_flange_cam: RigidTransform
    """X: camera (OpenCV axes) to flange."""
    T_base_board: RigidTransform
    """Y: board to robot base."""
    T_flange_cam_closed: RigidTransform
    """X of the closed form alone."""
    misfits: Float[np.ndarray, "n 2"]
    """Of every pose: board's place [mm] and orientation [deg]."""
    left_out: Float[np.ndarray, "n 2"]
    """The same, of a calibration without that pose; NaN where it cannot be made without it."""


def hand_eye(
    Ts_base_flange: RigidTransform, Ts_cam_board: RigidTransform, board_points: Float[np.ndarray, "k 3"]
) -> HandEye:
    """Calibrate from n pairs of poses.

    board_points: points of the board in its own frame [m], whose images are compared. CalibrationError where the
    motions do not determine X, or the poses contradict each other.
    """
    n = len(Ts_base_flange)
    if n != len(Ts_cam_board) or n < FEWEST_POSES:
        raise CalibrationError(
            f"{n} flange poses and {len(Ts_cam_board)} of the board; give at least {FEWEST_POSES} pairs, better 15"
        )
    check_motions(Ts_base_flange)
    closed = closed_form(Ts_base_flange, Ts_cam_board)
    first = Ts_base_flange[0] * closed * Ts_cam_board[0]
    X, Y = refined(closed, first, Ts_base_flange, Ts_cam_board, board_points)
    misfits = board_misfits(X, Y, Ts_base_flange, Ts_cam_board)
    check_fit(misfits, Ts_cam_board)
    left_out = np.full((n, 2), np.nan)
    for i in range(n):
        others = np.flatnonzero(np.arange(n) != i)
        flanges, boards = Ts_base_flange[others], Ts_cam_board[others]
        if n > FEWEST_POSES and min(turns_deg(flanges)) >= LEAST_TURN_DEG:
            X_i, Y_i = refined(X, Y, flanges, boards, board_points)
            left_out[i] = board_misfits(X_i, Y_i, Ts_base_flange[i : i + 1], Ts_cam_board[i : i + 1])[0]
    return HandEye(X, Y, closed, misfits, left_out)


def motions(Ts: RigidTransform) -> RigidTransform:
    """What each pose is, seen from each later one: T_j^-1 T_i for all i < j."""
    i, j = np.triu_indices(len(Ts), k=1)
    return Ts[j].inv() * Ts[i]


def turns_deg(Ts_base_flange: RigidTransform) -> tuple[float, float]:
    """Largest turn between two poses about the axis that they turn about most, and about the next one [deg]."""
    rotvecs = motions(Ts_base_flange).rotation.as_rotvec(degrees=True)
    axes = np.linalg.svd(rotvecs, full_matrices=False)[2]
    first, second = np.abs(rotvecs @ axes.T).max(axis=0)[:2]
    return float(first), float(second)


def check_motions(Ts_base_flange: RigidTransform) -> None:
    """CalibrationError where the flange hardly turns, or about parallel axes: then X is not determined."""
    first, second = turns_deg(Ts_base_flange)
    if first < LEAST_TURN_DEG:
        raise CalibrationError(
            f"the flange turns by {first:.1f} deg at most, {LEAST_TURN_DEG:g} are needed; add poses that look at the "
            "board from other sides, 30 deg apart"
        )
    if second < LEAST_TURN_DEG:
        raise CalibrationError(
            f"the flange turns about one axis only ({first:.1f} deg, across it {second:.1f}); add poses that are "
            f"turned about another axis by {LEAST_TURN_DEG:g} deg and more, 30 deg for a good result"
        )


def closed_form(Ts_base_flange: RigidTransform, Ts_cam_board: RigidTransform) -> RigidTransform:
    """X of Park and Martin: the rotation that turns the axes of B into those of A, then a linear system for the
    place."""
    A, B = motions(Ts_base_flange), motions(Ts_cam_board.inv())
    small = np.degrees(np.maximum(A.rotation.magnitude(), B.rotation.magnitude())) < LARGEST_TURN_DEG
    if small.sum() > 1:
        A, B = A[np.flatnonzero(small)], B[np.flatnonzero(small)]
    rotation, _ = Rotation.align_vectors(A.rotation.as_rotvec(), B.rotation.as_rotvec())
    matrix = (A.rotation.as_matrix() - np.eye(3)).reshape(-1, 3)
    right = (rotation.apply(B.translation) - A.translation).ravel()
    return RigidTransform.from_components(np.linalg.lstsq(matrix, right)[0], rotation)


def refined(
    X: RigidTransform,
    Y: RigidTransform,
    flanges: RigidTransform,
    boards: RigidTransform,
    points: Float[np.ndarray, "k 3"],
) -> tuple[RigidTransform, RigidTransform]:
    """X and Y with the least squares of the image of the board's points, in normalised coordinates.

    The points as the pose of the board in the camera says stand for those that were found: to first order their
    distances are what a reprojection error adds to that which the pose itself leaves.
    """
    seen = _image(boards, points)
    step = partial(_moved, X, Y)

    def residuals(step_of_both: Float[np.ndarray, "12"]) -> Float[np.ndarray, "m"]:
        X_now, Y_now = step(step_of_both)
        return (_image((flanges * X_now).inv() * Y_now, points) - seen).ravel()

    found = least_squares(residuals, np.zeros(12), x_scale="jac", xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return step(found.x)


def _moved(
    X: RigidTransform, Y: RigidTransform, step: Float[np.ndarray, "12"]
) -> tuple[RigidTransform, RigidTransform]:
    return X * RigidTransform.from_exp_coords(step[:6]), Y * RigidTransform.from_exp_coords(step[6:])


def _image(Ts_cam_board: RigidTransform, points: Float[np.ndarray, "k 3"]) -> Float[np.ndarray, "n k 2"]:
    matrices = Ts_cam_board.as_matrix()  # (n, 4, 4)
    cam = np.einsum("nij,kj->nki", matrices[:, :3, :3], points) + matrices[:, None, :3, 3]
    return cam[..., :2] / np.maximum(cam[..., 2:], _LEAST_DEPTH_M)


def board_misfits(
    X: RigidTransform, Y: RigidTransform, flanges: RigidTransform, boards: RigidTransform
) -> Float[np.ndarray, "n 2"]:
    """Of every pose, where the board is seen against where X and Y put it: place [mm] and orientation [deg]."""
    predicted = (flanges * X).inv() * Y
    places = np.linalg.norm(predicted.translation - boards.translation, axis=-1)
    turns = (predicted.rotation.inv() * boards.rotation).magnitude()
    return np.column_stack([1e3 * places, np.degrees(turns)])


def check_fit(misfits: Float[np.ndarray, "n 2"], Ts_cam_board: RigidTransform) -> None:
    """CalibrationError where the pairs of poses contradict each other."""
    mm, deg = rms(misfits)
    allowed_mm = WORST_MM_PER_M * float(np.linalg.norm(Ts_cam_board.translation, axis=-1).mean())
    if mm > allowed_mm or deg > WORST_DEG:
        worst = int(np.argmax(misfits[:, 0] / allowed_mm + misfits[:, 1] / WORST_DEG))
        raise CalibrationError(
            f"the poses contradict each other by {mm:.1f} mm and {deg:.2f} deg (pose {worst} most, counted from 0); "
            "are they T_base_flange in metres, paired with the right board poses, and did the board stay where it was?"
        )


def rms(misfits: Float[np.ndarray, "n 2"]) -> tuple[float, float]:
    """Root mean squares of place [mm] and orientation [deg], NaN left out; NaN where there is nothing else."""
    known = misfits[~np.isnan(misfits).any(axis=1)]
    mm, deg = np.sqrt((known**2).mean(axis=0)) if len(known) else (np.nan, np.nan)
    return float(mm), float(deg)
