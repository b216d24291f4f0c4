"""Ways of an arm whose tool goes straight: the flange's, cut into small steps."""

import math

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation, Slerp

from franbv.adapters.arms.driver import FlangePath

WAY_STEP, TURN_STEP_DEG = 0.02, 2.0
"""Between neighbours [m, deg] (choice: well below what a guard lets pass)."""


def straight_path(T_start: RigidTransform, T_goal: RigidTransform, speed: float, turning_deg_s: float) -> FlangePath:
    """The straight way from one pose of the flange to the other, at these speeds [m/s, deg/s], both throughout."""
    way = float(np.linalg.norm(T_goal.translation - T_start.translation))
    turn = float(np.degrees((T_start.rotation.inv() * T_goal.rotation).magnitude()))
    n = max(1, math.ceil(way / WAY_STEP), math.ceil(turn / TURN_STEP_DEG))
    shares = np.arange(n + 1) / n
    turns = Slerp([0.0, 1.0], Rotation.concatenate([T_start.rotation, T_goal.rotation]))(shares)
    places = T_start.translation + shares[:, None] * (T_goal.translation - T_start.translation)
    poses = tuple(RigidTransform.from_components(p, r) for p, r in zip(places, turns, strict=True))
    return FlangePath(poses, max(way / speed, turn / turning_deg_s))
