"""The straight way of a flange, cut into steps that a guard lets pass."""

import math

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation, Slerp

from franbv.adapters.arms.flange_poses import STEP_DEG, STEP_M, pose_distance


def straight_poses(T_start: RigidTransform, T_goal: RigidTransform) -> tuple[RigidTransform, ...]:
    """Both poses, and as many between them as it takes; place and turn go evenly."""
    metres, degrees = pose_distance(T_start, T_goal)
    n = 1 + math.ceil(max(metres / STEP_M, degrees / STEP_DEG, 1.0))
    shares = np.linspace(0.0, 1.0, n)[1:-1]
    turns = Slerp([0.0, 1.0], Rotation.concatenate([T_start.rotation, T_goal.rotation]))
    places = [T_start.translation + share * (T_goal.translation - T_start.translation) for share in shares]
    between = [RigidTransform.from_components(*pair) for pair in zip(places, map(turns, shares), strict=True)]
    return (T_start, *between, T_goal)
