"""Candidate sensor poses on a hemisphere around the object's box (paper, section III-C), and the first view."""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.frames import rolled
from franbv.geometry.oriented_box import OrientedBox, axis_aligned_box
from franbv.parameters import Parameters


def candidate_poses(box: OrientedBox, parameters: Parameters, azimuth_offset: float) -> list[RigidTransform]:
    """N_pos poses T_world_cam on rings around the box's centre, all looking at it, turned by the camera's roll.

    The rings' polar angles are evenly spaced and the poses are shared out by ring length, so that they are about
    equally far apart. The radius is gamma plus the box's half diagonal.
    azimuth_offset: turns all rings [rad]; a new one per iteration keeps the same 32 poses from being offered again.
    """
    polar = np.radians(np.linspace(parameters.polar_min_deg, parameters.polar_max_deg, parameters.n_rings))
    counts = ring_counts(np.sin(polar), parameters.n_candidates)
    azimuth = azimuth_offset + np.concatenate([2 * np.pi * np.arange(count) / count for count in counts])
    radius = parameters.stand_off + box.half_diagonal
    poses = rolled(_facing(box.centre, radius, np.repeat(polar, counts), azimuth), parameters.roll_deg)
    return [poses[k] for k in range(len(azimuth))]


def first_view(parameters: Parameters, azimuth_deg: float) -> RigidTransform:
    """The pose T_world_cam of the first acquisition: the prior box seen from the given azimuth, the camera's roll in
    it."""
    prior = axis_aligned_box(np.array(parameters.prior_min), np.array(parameters.prior_max))
    polar = np.radians([90.0 - parameters.first_elevation_deg])
    pose = _facing(prior.centre, parameters.stand_off + prior.half_diagonal, polar, np.radians([azimuth_deg]))[0]
    return rolled(pose, parameters.roll_deg)


def ring_counts(lengths: Float[np.ndarray, "r"], total: int) -> Int[np.ndarray, "r"]:
    """`total` shared out in proportion to `lengths`, by largest remainder."""
    quota = total * lengths / lengths.sum()
    counts = np.floor(quota).astype(int)
    counts[np.argsort(-(quota - counts), kind="stable")[: total - counts.sum()]] += 1
    return counts


def _facing(centre, radius, polar, azimuth):
    """Poses (n,) on a sphere that look at its centre, world z up in the image; all at once, as `look_at` is for one."""
    zeros = np.zeros_like(azimuth)
    outwards = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1)
    x = np.stack([-np.sin(azimuth), np.cos(azimuth), zeros], axis=-1)
    rotation = np.stack([x, np.cross(-outwards, x), -outwards], axis=-1)
    return RigidTransform.from_components(centre + radius * outwards, Rotation.from_matrix(rotation))
