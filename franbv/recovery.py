"""Recovery of a reflective region: poses that see it at other angles, and how much came back (paper, section V-B)."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at, rolled
from franbv.geometry.oriented_box import OrientedBox
from franbv.parameters import Parameters
from franbv.voxel_map import VoxelMap

EQUAL = 1e-6
"""Faces whose areas differ by less than this share are equally large: a choice, far above rounding."""


@dataclass(frozen=True, eq=False)
class RecoveryPoses:
    """X_r, the poses that can be taken, and what became of the others (of both diamonds, if a second was tried).

    Positions o_k = c_r + d n_r + rho (cos theta_k t_1 + sin theta_k t_2), eq. (12), looking at c_r, eq. (13). The paper
    does not say what happens to poses that cannot be taken: here they are pushed back or dropped, and a diamond with
    too few of them is turned once (`Parameters.min_recovery_poses`, `diamond_turn_deg`). Min-Z is kept from c_r, and
    not from all else that a pose may see.
    """

    poses: tuple[RigidTransform, ...]
    """T_world_cam of each pose; all look at `target`."""
    target: Float[np.ndarray, "3"]
    """c_r, centre of the region's face, world frame [m]."""
    normal: Float[np.ndarray, "3"]
    """n_r, unit normal of that face, towards the camera that saw the hole."""
    turned: bool
    """Whether these are the poses of the turned diamond."""
    n_pushed_back: int
    """Of `poses`: moved back along their view axis because the sensor could not measure from so near."""
    n_too_near: int
    """Dropped: too near for the sensor, and not reachable farther back."""
    n_under_table: int
    """Dropped: not above the table top."""
    n_unreachable: int
    """Dropped: in collision or beyond the arm's reach."""


def diamond_poses(
    region: OrientedBox,
    T_world_cam_seen: RigidTransform,
    parameters: Parameters,
    reachable: Callable[[RigidTransform], bool],
    min_z: float,
) -> RecoveryPoses:
    """Poses around the region's largest face that look at its centre; eqs. (11) to (13).

    region: B_r*.
    T_world_cam_seen: the pose that saw the hole; of the largest faces the one towards it is taken.
    reachable: whether the arm can stand at a pose.
    min_z: least depth that the sensor measures [m]; the poses keep it and a margin from the face's centre.
    """
    target, normal = largest_face(region, T_world_cam_seen.translation)
    nearest = min_z + parameters.min_z_margin

    def attempt(first_angle_deg: float) -> tuple[list[RigidTransform], Counter[str]]:
        eyes = diamond_positions(target, normal, parameters, first_angle_deg)
        return _usable(eyes, target, nearest, parameters, reachable)

    poses, fates = attempt(parameters.diamond_angle_deg)
    turned_poses, turned_fates = [], Counter()
    if len(poses) < parameters.min_recovery_poses:
        turned_poses, turned_fates = attempt(parameters.diamond_angle_deg + parameters.diamond_turn_deg)
    turned = len(turned_poses) > len(poses)
    dropped = fates + turned_fates
    return RecoveryPoses(
        poses=tuple(turned_poses if turned else poses),
        target=target,
        normal=normal,
        turned=turned,
        n_pushed_back=(turned_fates if turned else fates)["pushed back"],
        n_too_near=dropped["too near"],
        n_under_table=dropped["under table"],
        n_unreachable=dropped["unreachable"],
    )


def largest_face(
    region: OrientedBox, camera: Float[np.ndarray, "3"]
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Centre c_r and outward unit normal n_r of the largest face that looks towards the camera.

    The two largest faces lie across the shortest side. A box with two sides equally short (a line of points) has four
    or six largest faces; the one that faces the camera best is taken.
    """
    shortest = region.half_extents <= region.half_extents.min() * (1.0 + EQUAL)
    towards = (camera - region.centre) @ region.axes
    axis = int(np.argmax(np.where(shortest, np.abs(towards), -1.0)))
    normal = region.axes[:, axis] * (1.0 if towards[axis] >= 0 else -1.0)
    return region.centre + region.half_extents[axis] * normal, normal


def diamond_positions(
    target: Float[np.ndarray, "3"], normal: Float[np.ndarray, "3"], parameters: Parameters, first_angle_deg: float
) -> Float[np.ndarray, "n 3"]:
    """Camera positions o_k, evenly spaced on a circle of radius rho, d in front of the face [m]; eq. (12)."""
    t1, t2 = tangents(normal)
    n = parameters.n_recovery_poses
    angles = np.radians(first_angle_deg) + 2.0 * np.pi * np.arange(n)[:, None] / n
    lateral = np.cos(angles) * t1 + np.sin(angles) * t2
    return target + parameters.recovery_distance * normal + parameters.lateral_offset * lateral


def tangents(normal: Float[np.ndarray, "3"]) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """t_1, horizontal, and t_2 = n x t_1; eq. (11). For a vertical normal t_1 is the world's x axis."""
    t1 = np.cross([0.0, 0.0, 1.0], normal)
    length = np.linalg.norm(t1)
    t1 = t1 / length if length > EQUAL else np.array([1.0, 0.0, 0.0])
    return t1, np.cross(normal, t1)


def _usable(eyes, target, nearest, parameters, reachable):
    """Poses that can be taken from these positions, and a count of what became of the others."""
    poses, fates = [], Counter()
    for position in eyes:
        distance = np.linalg.norm(position - target)
        too_near = distance < nearest
        eye = target + (position - target) * (nearest / distance) if too_near else position
        pose = rolled(look_at(eye, target), parameters.roll_deg)
        if eye[2] <= parameters.table_height:
            fates["under table"] += 1
        elif not reachable(pose):
            fates["too near" if too_near else "unreachable"] += 1
        else:
            poses.append(pose)
            fates["pushed back"] += int(too_near)
    return poses, fates


def recovery_index(
    occupied_before: Bool[np.ndarray, "x y z"],
    occupied_now: Bool[np.ndarray, "x y z"],
    region: OrientedBox,
    voxel_map: VoxelMap,
    parameters: Parameters,
) -> tuple[float, float]:
    """Gamma = N_added / N_cap, eq. (15), and N_added over what a surface across the region can add.

    occupied_before: at activation; occupied_now: after the recovery views so far.
    N_cap: voxels whose centre lies in the region grown by a voxel on every side. A sheet fills a third of them at most,
    so Gamma alone says little about how complete a recovery is; with `Parameters.capacity` "sheet" both are the second.
    """
    size = parameters.voxel_size
    centres = voxels_in(region.grown(size), size)
    n_added = np.count_nonzero(voxel_map.lookup(occupied_now & ~occupied_before, centres))
    attained = n_added / min(sheet_voxels(region, size), len(centres))
    return attained if parameters.capacity == "sheet" else n_added / len(centres), attained


def voxels_in(box: OrientedBox, voxel_size: float) -> Float[np.ndarray, "n 3"]:
    """Centres of the map's voxels, integer multiples of the voxel size, within the box [m]."""
    corners = box.corners() / voxel_size
    ranges = [np.arange(lo, hi + 1) for lo, hi in zip(np.floor(corners.min(0)), np.ceil(corners.max(0)), strict=True)]
    centres = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, 3) * voxel_size
    return centres[box.contains(centres)]


def sheet_voxels(region: OrientedBox, voxel_size: float) -> float:
    """Voxels that a flat sheet as large as the region's largest face passes through, on average over its position.

    A plane of area A and unit normal n crosses A |n_i| / s^2 grid lines along axis i and enters a voxel at each of
    their planes: A (|n_x| + |n_y| + |n_z|) / s^2 voxels.
    """
    thin = int(np.argmin(region.half_extents))
    area = 4.0 * np.prod(np.delete(region.half_extents, thin))
    return float(area * np.abs(region.axes[:, thin]).sum() / voxel_size**2)
