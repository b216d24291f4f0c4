"""Says of a pose or a way why the camera may not be there. It knows the cell and nothing of the planner.

A way is looked at in steps so small that nothing that moves goes farther than LOOK_STEP from one to the next, and every
limit is kept by half a step more, so that it holds between the steps as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform, Rotation, Slerp

from franbv.adapters.live.cell import CornerBox, RobotCell, distance_to_box

LOOK_STEP = 0.005
"""That anything moving goes between two looks at a way [m] (choice)."""
LONGEST_GAP, WIDEST_GAP_DEG = 0.05, 6.0
"""Between neighbours of a way that a driver states [m, deg]: wider, and it may do anything in between (choice; the arc
of a turn by 6 deg leaves its chord by 0.3 mm at 0.2 m)."""
ARRIVED, ARRIVED_DEG = 0.005, 1.0
"""How far the ends of a way may be from where the arm is and from where it shall go [m, deg] (choice)."""


@dataclass(frozen=True)
class Guard:
    """Holds poses and ways against the cell."""

    cell: RobotCell
    min_z: float
    """Of the camera [m]."""

    def violation(self, T_world_cam: RigidTransform) -> str | None:
        """Why the camera may not stand at this pose; None if it may."""
        found = self._first(_stacked([T_world_cam]), slack=0.0)
        return None if found is None else found[1]

    def way_violation(self, Ts_world_cam: Sequence[RigidTransform]) -> str | None:
        """Why the camera may not go through these poses one after the other; None if it may."""
        if not np.isfinite(_stacked(Ts_world_cam)).all():
            return "a pose of the way is not a number"
        found = self._first(*self._steps(Ts_world_cam))
        if found is None:
            return None
        place, why = found
        return f"{why} after {place:.0%} of the way"

    def path_violation(
        self,
        Ts_world_cam: Sequence[RigidTransform],
        duration_s: float,
        T_start: RigidTransform,
        T_goal: RigidTransform,
    ) -> str | None:
        """The same of a way that a driver states, which must begin where the camera is, end where it shall go, have no
        gaps and not be faster than the cell allows."""
        if len(Ts_world_cam) < 2:
            return "the way has no steps"
        for where, T, due in (
            ("begin where the camera is", Ts_world_cam[0], T_start),
            ("end at its goal", Ts_world_cam[-1], T_goal),
        ):
            way, angle = _apart(T, due)
            if not (way <= ARRIVED and angle <= ARRIVED_DEG):
                return f"the way does not {where}: {1e3 * way:.0f} mm and {angle:.1f} deg off"
        gaps = [_apart(one, other) for one, other in pairwise(Ts_world_cam)]
        if not all(way <= LONGEST_GAP and angle <= WIDEST_GAP_DEG for way, angle in gaps):
            return "the way has gaps in which it is not known"
        length = sum(way for way, _ in gaps)
        if not duration_s >= 0 or (duration_s and length / duration_s > self.cell.most_speed):
            return f"the way takes {duration_s:.1f} s for {length:.2f} m, faster than {self.cell.most_speed:g} m/s"
        return self.way_violation(Ts_world_cam)

    def nearest(self, Ts_world_cam: Sequence[RigidTransform]) -> float:
        """Least distance of the depth origin from the object box on this way [m]."""
        samples, _ = self._steps(Ts_world_cam)
        return float(distance_to_box(samples[:, :3, 3], self.cell.object_box).min())

    def _steps(self, Ts_world_cam: Sequence[RigidTransform]) -> tuple[Float[np.ndarray, "n 4 4"], float]:
        """Poses along the way, and the slack that stands for what is between them [m]."""
        corners = np.array([corner for box in self.cell.moving for corner in box])
        reach = float(np.linalg.norm(np.maximum(np.abs(corners[::2]), np.abs(corners[1::2])), axis=1).max())
        samples = [_stacked(Ts_world_cam[:1])]
        for one, other in pairwise(Ts_world_cam):
            way, angle = _apart(one, other)
            n = max(1, int(np.ceil((way + reach * np.radians(angle)) / LOOK_STEP)))
            samples.append(_between(one, other, n))
        return np.concatenate(samples), LOOK_STEP / 2

    def _first(self, Ts: Float[np.ndarray, "n 4 4"], slack: float) -> tuple[float, str] | None:
        """Place on the way and reason of the first violation."""
        if not np.isfinite(Ts).all():
            return 0.0, "the pose is not a number"
        reasons = self._reasons(Ts, slack)
        broken = {why: int(np.argmax(bad)) for why, bad in reasons.items() if bad.any()}
        if not broken:
            return None
        why = min(broken, key=lambda one: broken[one])
        return broken[why] / max(1, len(Ts) - 1), why

    def _reasons(self, Ts: Float[np.ndarray, "n 4 4"], slack: float) -> dict[str, Bool[np.ndarray, "n"]]:
        cell = self.cell
        origins = Ts[:, :3, 3]
        lower, upper = np.array(cell.workspace)
        gap = cell.clearance + slack
        lowest = np.min([_lowest(Ts, box) for box in cell.moving], axis=0)
        reasons = {
            "outside the workspace": np.any((origins < lower + slack) | (origins > upper - slack), axis=1),
            "under the table": lowest < cell.table_height + gap,
            "nearer than Min-Z": distance_to_box(origins, cell.object_box) < self.min_z + cell.min_z_margin + slack,
        }
        for name, box in {"the object": cell.object_box, **cell.keep_out}.items():
            reasons[f"touches {name}"] = np.any([~boxes_apart(Ts, moving, box, gap) for moving in cell.moving], axis=0)
        return reasons


def boxes_apart(
    Ts: Float[np.ndarray, "n 4 4"], moving: CornerBox, still: CornerBox, gap: float
) -> Bool[np.ndarray, "n"]:
    """Whether a box that is carried by each of the poses stays clear of one that stands still, grown by `gap` [m].

    By separating axes: the three of each box and their nine cross products (Gottschalk, Lin and Manocha 1996).
    """
    (lower, upper), (low, high) = np.array(moving), np.array(still)
    turns, half, other_half = Ts[:, :3, :3], (upper - lower) / 2, (high - low) / 2 + gap
    between = Ts[:, :3, 3] + turns @ ((lower + upper) / 2) - (low + high) / 2  # (n, 3), world
    sizes = np.abs(turns)  # (n, world axis, box axis)
    apart = np.any(np.abs(between) > other_half + sizes @ half, axis=1)
    along = np.einsum("ni,nij->nj", between, turns)
    apart |= np.any(np.abs(along) > half + np.einsum("i,nij->nj", other_half, sizes), axis=1)
    for i in range(3):
        one, two = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            ja, jb = (j + 1) % 3, (j + 2) % 3
            distance = np.abs(between[:, two] * turns[:, one, j] - between[:, one] * turns[:, two, j])
            of_still = other_half[one] * sizes[:, two, j] + other_half[two] * sizes[:, one, j]
            of_moving = half[ja] * sizes[:, i, jb] + half[jb] * sizes[:, i, ja]
            apart |= distance > of_still + of_moving + 1e-12
    return apart


def _lowest(Ts: Float[np.ndarray, "n 4 4"], box: CornerBox) -> Float[np.ndarray, "n"]:
    """Height of the lowest corner of a box that is carried [m]."""
    lower, upper = np.array(box)
    down = np.minimum(Ts[:, 2, :3] * lower, Ts[:, 2, :3] * upper)
    return Ts[:, 2, 3] + down.sum(axis=1)


def _stacked(poses: Sequence[RigidTransform]) -> Float[np.ndarray, "n 4 4"]:
    return np.array([T.as_matrix() for T in poses]).reshape(-1, 4, 4)


def _apart(one: RigidTransform, other: RigidTransform) -> tuple[float, float]:
    """Way [m] and turn [deg] from one pose to the other."""
    turn = (one.rotation.inv() * other.rotation).magnitude()
    return float(np.linalg.norm(other.translation - one.translation)), float(np.degrees(turn))


def _between(one: RigidTransform, other: RigidTransform, n: int) -> Float[np.ndarray, "n 4 4"]:
    """n poses on the straight way from one, which is left out, to the other, which is the last."""
    shares = np.arange(1, n + 1) / n
    turns = Slerp([0.0, 1.0], Rotation.concatenate([one.rotation, other.rotation]))(shares)
    places = one.translation + shares[:, None] * (other.translation - one.translation)
    return RigidTransform.from_components(places, turns).as_matrix()
