"""Hand-eye calibration: where the camera sits on the flange, from flange poses and what the camera saw of a fixed
board.

For every pose i, T_base_flange_i X T_cam_board_i = Y with X = T_flange_cam and Y = T_base_board, both unknown. Between
two poses Y drops out, AX = XB, which has a closed form (F. C. Park and B. J. Martin, "Robot sensor calibration: solving
AX = XB on the Euclidean group", IEEE Transactions on Robotics and Automation 10, 1994). Least squares on the board's
points in the image then weigh what a camera knows well, directions, and what it knows badly, distance and tilt.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
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
_MOST_STEPS, _MOST_HALVINGS, _LEAST_STEP = 20, 12, 1e-12
"""Of the least squares: a handful of steps bring a start that is right in the main to the last digit [m, rad; share of
the sum of squares]."""
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
    X, Y, closed = solved(Ts_base_flange, Ts_cam_board, board_points)
    misfits = board_misfits(X, Y, Ts_base_flange, Ts_cam_board)
    if not fits(misfits, Ts_cam_board):
        raise contradiction(Ts_base_flange, Ts_cam_board, board_points, misfits)
    left_out = np.full((n, 2), np.nan)
    for i in range(n):
        others = np.flatnonzero(np.arange(n) != i)
        flanges, boards = Ts_base_flange[others], Ts_cam_board[others]
        if n > FEWEST_POSES and min(turns_deg(flanges)) >= LEAST_TURN_DEG:
            X_i, Y_i = refined(X, Y, flanges, boards, board_points)
            left_out[i] = board_misfits(X_i, Y_i, Ts_base_flange[i : i + 1], Ts_cam_board[i : i + 1])[0]
    return HandEye(X, Y, closed, misfits, left_out)


def solved(
    flanges: RigidTransform, boards: RigidTransform, points: Float[np.ndarray, "k 3"]
) -> tuple[RigidTransform, RigidTransform, RigidTransform]:
    """X and Y by least squares from the closed form, and the closed form's X."""
    closed = closed_form(flanges, boards)
    return *refined(closed, flanges[0] * closed * boards[0], flanges, boards, points), closed


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
    rotation = Rotation.align_vectors(A.rotation.as_rotvec(), B.rotation.as_rotvec())[0]
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
    """X and Y with the least squares of the image of the board's points, in normalised coordinates; Gauss and Newton's
    steps, halved where they overshoot.

    The points as the pose of the board in the camera says stand for those that were found: to first order their
    distances are what a reprojection error adds to that which the pose itself leaves.
    """
    seen = _image(_in_camera(boards, points))
    misses = _image(_in_camera((flanges * X).inv() * Y, points)) - seen
    for _ in range(_MOST_STEPS):
        jacobian = _jacobian((flanges * X).inv() * Y, points)
        step = np.linalg.lstsq(jacobian, -misses.ravel())[0]
        for _ in range(_MOST_HALVINGS):
            X_next, Y_next = (T * RigidTransform.from_exp_coords(part) for T, part in ((X, step[:6]), (Y, step[6:])))
            missed = _image(_in_camera((flanges * X_next).inv() * Y_next, points)) - seen
            if np.sum(missed**2) < np.sum(misses**2):
                break
            step = step / 2
        else:
            return X, Y  # nothing nearer is left
        nearly_as_before = np.sum(misses**2) - np.sum(missed**2) < _LEAST_STEP * np.sum(misses**2)
        X, Y, misses = X_next, Y_next, missed
        if nearly_as_before or np.abs(step).max() < _LEAST_STEP:
            break
    return X, Y


def _in_camera(Ts_cam_board: RigidTransform, points: Float[np.ndarray, "k 3"]) -> Float[np.ndarray, "n k 3"]:
    matrices = Ts_cam_board.as_matrix()  # (n, 4, 4)
    return points @ matrices[:, :3, :3].transpose(0, 2, 1) + matrices[:, None, :3, 3]


def _image(cam: Float[np.ndarray, "n k 3"]) -> Float[np.ndarray, "n k 2"]:
    return cam[..., :2] / np.maximum(cam[..., 2:], _LEAST_DEPTH_M)


def _jacobian(Ts_cam_board: RigidTransform, points: Float[np.ndarray, "k 3"]) -> Float[np.ndarray, "m 12"]:
    """Of the points' images by small motions (turn, then shift) of X and of Y, each in its own frame.

    X exp(a) moves a point p of the camera by -(a_turn x p + a_shift), Y exp(b) one of the board by b_turn x P +
    b_shift."""
    cam = _in_camera(Ts_cam_board, points)
    rotations = Ts_cam_board.rotation.as_matrix()[:, None]  # (n, 1, 3, 3)
    by_X = np.concatenate([_cross(cam), np.broadcast_to(-np.eye(3), (*cam.shape, 3))], axis=-1)
    by_Y = np.concatenate([-_cross(points), np.broadcast_to(np.eye(3), (len(points), 3, 3))], axis=-1)
    moved = np.concatenate([by_X, rotations @ by_Y], axis=-1)  # (n, k, 3, 12)
    z = np.maximum(cam[..., 2], _LEAST_DEPTH_M)[..., None, None]
    image = cam[..., :2, None] / z
    return ((moved[..., :2, :] - image * moved[..., 2:, :]) / z).reshape(-1, 12)


def _cross(vectors: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3 3"]:
    """Matrices [v] with [v] u = v x u."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def board_misfits(
    X: RigidTransform, Y: RigidTransform, flanges: RigidTransform, boards: RigidTransform
) -> Float[np.ndarray, "n 2"]:
    """Of every pose, where the board is seen against where X and Y put it: place [mm] and orientation [deg]."""
    predicted = (flanges * X).inv() * Y
    places = np.linalg.norm(predicted.translation - boards.translation, axis=-1)
    turns = (predicted.rotation.inv() * boards.rotation).magnitude()
    return np.column_stack([1e3 * places, np.degrees(turns)])


def fits(misfits: Float[np.ndarray, "n 2"], Ts_cam_board: RigidTransform) -> bool:
    """Whether the pairs of poses can belong together."""
    mm, deg = rms(misfits)
    distance_m = float(np.linalg.norm(Ts_cam_board.translation, axis=-1).mean())
    return mm <= WORST_MM_PER_M * distance_m and deg <= WORST_DEG


def contradiction(
    flanges: RigidTransform, boards: RigidTransform, points: Float[np.ndarray, "k 3"], misfits: Float[np.ndarray, "n 2"]
) -> CalibrationError:
    """What is wrong with pairs of poses that do not fit: one of them, if the others fit without it."""
    words = "the poses contradict each other by {:.1f} mm and {:.2f} deg".format(*rms(misfits))
    for i in range(len(misfits)):
        others = np.flatnonzero(np.arange(len(misfits)) != i)
        if len(others) < FEWEST_POSES or min(turns_deg(flanges[others])) < LEAST_TURN_DEG:
            continue
        X, Y = solved(flanges[others], boards[others], points)[:2]
        rest = board_misfits(X, Y, flanges[others], boards[others])
        if fits(rest, boards[others]):
            return CalibrationError(f"{words}; without pose {i} (counted from 0) the others fit: take it out")
    return CalibrationError(
        f"{words}; are they T_base_flange in metres, paired with the right board poses, and did the board "
        "stay where it was?"
    )


def rms(misfits: Float[np.ndarray, "n 2"]) -> tuple[float, float]:
    """Root mean squares of place [mm] and orientation [deg], NaN left out; NaN where there is nothing else."""
    known = misfits[~np.isnan(misfits).any(axis=1)]
    mm, deg = np.sqrt((known**2).mean(axis=0)) if len(known) else (np.nan, np.nan)
    return float(mm), float(deg)
