"""The flange's poses along a way of the joints, close enough together that nothing is passed over between them."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.adapters.arms.driver import ArmError

STEP_M, STEP_DEG = 0.03, 5.0
"""Between neighbours, at most (`FlangePath`: a few centimetres and degrees)."""
_HALVINGS = 6
"""Of a step between two points of a trajectory: 64 parts are enough for any that is no jump."""


def flange_poses(
    positions: Float[np.ndarray, "n j"], forward: Callable[[Sequence[float]], RigidTransform]
) -> list[RigidTransform]:
    """Poses at all points, and between those that are too far apart; there joints are taken on the straight line.

    forward: T_base_flange of joint positions [rad, m]. ArmError where the way jumps.
    """
    poses = [forward(positions[0].tolist())]
    for a, b in pairwise(positions):
        poses += _between(a, b, poses[-1], forward, _HALVINGS)
    return poses


def _between(
    a: Float[np.ndarray, "j"],
    b: Float[np.ndarray, "j"],
    pose_a: RigidTransform,
    forward: Callable[[Sequence[float]], RigidTransform],
    halvings: int,
) -> list[RigidTransform]:
    """Poses after `a` up to `b`, none farther from the last than a step."""
    pose_b = forward(b.tolist())
    metres, degrees = pose_distance(pose_a, pose_b)
    if metres <= STEP_M and degrees <= STEP_DEG:
        return [pose_b]
    if not halvings:
        raise ArmError(f"the trajectory jumps by {1e3 * metres:.0f} mm and {degrees:.0f} deg; plan anew")
    middle = (a + b) / 2
    first = _between(a, middle, pose_a, forward, halvings - 1)
    return first + _between(middle, b, first[-1], forward, halvings - 1)


def pose_distance(a: RigidTransform, b: RigidTransform) -> tuple[float, float]:
    """Distance [m] and angle [deg] between two poses."""
    metres = float(np.linalg.norm(a.translation - b.translation))
    return metres, float(np.degrees((a.rotation.inv() * b.rotation).magnitude()))
