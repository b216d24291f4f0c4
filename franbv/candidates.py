"""Candidate sensor poses on a hemisphere around the object's box (paper, section III-C), and the first view."""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at
from franbv.oriented_box import OrientedBox, axis_aligned_box
from franbv.parameters import Parameters


def candidate_poses(box: OrientedBox, parameters: Parameters, azimuth_offset: float) -> list[RigidTransform]:
    """N_pos poses T_world_cam on rings around the box's centre, all looking at it.

    The rings' polar angles are evenly spaced and the poses are shared out by ring length, so that they are about
    equally far apart. The radius is gamma plus the box's half diagonal.
    azimuth_offset: turns all rings [rad]; a new one per iteration keeps the same 32 poses from being offered again.
    """
    polar = np.radians(np.linspace(parameters.polar_min_deg, parameters.polar_max_deg, parameters.n_rings))
    counts = ring_counts(np.sin(polar), parameters.n_candidates)
    radius = parameters.stand_off + box.half_diagonal
    return [
        _facing(box.centre, radius, angle, azimuth_offset + 2 * np.pi * k / count)
        for angle, count in zip(polar, counts, strict=True)
        for k in range(count)
    ]


def first_view(parameters: Parameters, azimuth_deg: float) -> RigidTransform:
    """The pose T_world_cam of the first acquisition: the prior box seen from the given azimuth."""
    prior = axis_aligned_box(np.array(parameters.prior_min), np.array(parameters.prior_max))
    polar = np.radians(90.0 - parameters.first_elevation_deg)
    return _facing(prior.centre, parameters.stand_off + prior.half_diagonal, polar, np.radians(azimuth_deg))


def ring_counts(lengths: Float[np.ndarray, "r"], total: int) -> Int[np.ndarray, "r"]:
    """`total` shared out in proportion to `lengths`, by largest remainder."""
    quota = total * lengths / lengths.sum()
    counts = np.floor(quota).astype(int)
    counts[np.argsort(-(quota - counts), kind="stable")[: total - counts.sum()]] += 1
    return counts


def _facing(centre, radius, polar, azimuth):
    direction = [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)]
    return look_at(centre + radius * np.array(direction), centre)
