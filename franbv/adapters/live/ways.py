"""Ways of the camera around the object: straight, or along an arc far enough away from it."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.adapters.live.cell import RobotCell, half_diagonal
from franbv.frames import look_at, rolled

ARC_STEP_DEG = 20.0
"""Between places of an arc [deg] (choice)."""
LIFT_DEG = 65.0
"""Elevation that the way over the object passes [deg] (choice)."""
OUTWARDS = (1.0, 1.15, 1.35)
"""Radii of arcs, of the least one [-] (choice)."""


def ways(
    T_start: RigidTransform, T_goal: RigidTransform, cell: RobotCell, min_z: float, roll_deg: float
) -> Iterator[tuple[RigidTransform, ...]]:
    """Ways from one pose to another, each as the poses after the start; the shortest comes first, none is checked.

    Between, the camera looks at the middle of the object box, turned in its mount by roll_deg [deg].
    """
    yield (T_goal,)
    centre = np.mean(cell.object_box, axis=0)
    least = half_diagonal(cell.object_box) + min_z + cell.min_z_margin + 2 * cell.clearance
    start, goal = (T.translation - centre for T in (T_start, T_goal))
    for outwards in OUTWARDS:
        radius = max(least * outwards, min(np.linalg.norm(start), np.linalg.norm(goal)))
        for lifted in (False, True):
            directions = _arc(_unit(start), _unit(goal), lifted)
            places = [centre + radius * direction for direction in directions]
            yield (*(rolled(look_at(place, centre), roll_deg) for place in places), T_goal)


def _arc(start: Float[np.ndarray, "3"], goal: Float[np.ndarray, "3"], lifted: bool) -> list[Float[np.ndarray, "3"]]:
    """Directions from above one end to above the other, both with them; lifted: by way of LIFT_DEG at least."""
    ends = [start, goal]
    if lifted:
        level = _unit(np.array([*(start + goal)[:2], 0.0]))
        elevation = np.radians(LIFT_DEG)
        ends.insert(1, np.cos(elevation) * level + np.sin(elevation) * np.array([0.0, 0.0, 1.0]))
    directions = [start]
    for one, other in pairwise(ends):
        angle = np.arccos(np.clip(one @ other, -1.0, 1.0))
        n = max(1, int(np.ceil(np.degrees(angle) / ARC_STEP_DEG)))
        across = other - (one @ other) * one
        if np.linalg.norm(across) < 1e-6:
            continue
        across = _unit(across)
        shares = angle * np.arange(1, n + 1) / n
        directions += [np.cos(share) * one + np.sin(share) * across for share in shares]
    return directions


def _unit(vector: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    length = np.linalg.norm(vector)
    return vector / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
