"""How well a cloud agrees with the true surface, and where the map contradicts it (paper, section VI).

Definitions. R: reference points spread evenly over the part of the surface that some view of the upper hemisphere can
see. C: the cloud, all points of all acquisitions in the workspace and above the table; its map-filtered form keeps the
points in voxels that are occupied in the final map.
- coverage at tolerance t: share of R with a point of C within t; `franbv.evaluation.coverage` follows it view by view.
- accuracy: mean and median distance from the points of C to the surface (all of it, hidden parts too).
- precision at t: share of C within t of the surface; F-score: harmonic mean of coverage and precision, both at 5 mm.
- wrongly free: share of the voxels that hold a point of R which the final map calls free.
- wrongly occupied: share of the object's voxels which the surface cannot pass through (false depth that has stayed).
Nothing is reconstructed by an empty cloud: its coverage, precision and F-score are 0, its accuracy NaN.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from franbv.evaluation.reference import TOLERANCE, TOLERANCES, Reference
from franbv.voxel_map import VoxelMap


@dataclass(frozen=True)
class Quality:
    """How well a cloud agrees with the surface: distances from points to the surface [m] and shares [0, 1].

    The formulas stand at the head of the module; of these numbers only the coverage is the paper's (section VI). An
    empty cloud has no coverage, precision and F-score of 0 and an accuracy of NaN. What the map believes is not in it:
    see `wrongly_free_share` and `wrongly_occupied_share`.
    """

    coverage: dict[float, float]
    """By tolerance [m]."""
    accuracy_mean: float
    """[m]"""
    accuracy_median: float
    """[m]"""
    precision: float
    """Share of the cloud within 5 mm of the surface."""
    f_score: float
    """Harmonic mean of precision and coverage at 5 mm."""


def quality(reference: Reference, cloud: Float[np.ndarray, "n 3"]) -> Quality:
    """Coverage at all tolerances, accuracy, precision and F-score of a cloud [m]."""
    if len(cloud) == 0:
        return Quality(dict.fromkeys(TOLERANCES, 0.0), np.nan, np.nan, 0.0, 0.0)
    limit = np.nextafter(max(TOLERANCES), 1.0)
    nearest = KDTree(cloud).query(reference.points, distance_upper_bound=limit)[0]
    coverage = {tolerance: float(np.mean(nearest <= tolerance)) for tolerance in TOLERANCES}
    error = reference.distance(cloud)
    precision = float(np.mean(error <= TOLERANCE))
    both = coverage[TOLERANCE] + precision
    f_score = 2 * coverage[TOLERANCE] * precision / both if both > 0 else 0.0
    return Quality(coverage, float(error.mean()), float(np.median(error)), precision, f_score)


def wrongly_free_share(reference: Reference, voxel_map: VoxelMap) -> float:
    """Share of the voxels that hold a reference point which the map calls free; voxels outside the map do not count."""
    index, inside = voxel_map.indices(reference.points)
    surface = np.unique(index[inside], axis=0)
    return float(np.mean(voxel_map.free[tuple(surface.T)])) if len(surface) else 0.0


def wrongly_occupied_share(reference: Reference, occupied: Float[np.ndarray, "n 3"], voxel_size: float) -> float | None:
    """Share of occupied voxels, given by their centres [m], that lie farther from the surface than half their diagonal.

    None without any. A voxel that the surface passes through is nearer; so are some that it misses.
    """
    if len(occupied) == 0:
        return None
    return float(np.mean(reference.distance(occupied) > np.sqrt(3.0) / 2.0 * voxel_size))
