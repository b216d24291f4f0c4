"""How much of the object a run has reconstructed, and how well (paper, section VI), against a known surface.

Definitions. R: reference points spread evenly over the part of the surface that some view of the upper hemisphere can
see. C: the cloud, all points of all acquisitions in the workspace and above the table; its map-filtered form keeps the
points in voxels that are occupied at that time.
- coverage at tolerance t: share of R with a point of C within t. The paper's measure is t = 5 mm on the raw cloud.
- accuracy: mean and median distance from the points of C to the surface (all of it, hidden parts too).
- precision at t: share of C within t of the surface; F-score: harmonic mean of coverage and precision, both at 5 mm.
- wrongly free: share of the voxels that hold a point of R which the final map calls free.
- wrongly occupied: share of the object's voxels which the surface cannot pass through (false depth that has stayed).
- increments: Delta C_k = C_k - C_(k-1), C_k the coverage at 5 mm after acquisition k, C_-1 = 0.
- recovery contribution: sum of the increments of recovery acquisitions, in coverage and as a share of the final one.
Nothing is reconstructed by an empty cloud: its coverage, precision and F-score are 0, its accuracy NaN.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from franbv.acquisition import Acquisition
from franbv.voxel_map import VoxelMap

TOLERANCES = (0.0025, 0.005, 0.0075, 0.010)
"""Coverage is reported at these [m]: half, whole, one and a half times and twice the paper's 5 mm."""

TOLERANCE = 0.005
"""Where no tolerance is named [m]: the paper's measure."""

DistanceToSurface = Callable[[Float[np.ndarray, "n 3"]], Float[np.ndarray, "n"]]


@dataclass(frozen=True, eq=False)
class Reference:
    """The true surface that a run is judged against.

    Coverage counts `points` alone, so that what no view can see lowers nothing; accuracy and precision are measured to
    all of the surface, hidden parts too.
    """

    points: Float[np.ndarray, "n 3"]
    """Area-uniform points that some view of the upper hemisphere can see, world frame [m]."""
    distance: DistanceToSurface
    """Distance from world points to the whole surface [m]: exact, or `distance_to_samples`."""


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


@dataclass(frozen=True, eq=False)
class History:
    """Coverage acquisition by acquisition, at 5 mm; k counts all of them, recoveries too.

    Delta C_k = C_k - C_(k-1) (paper, section VI), so that the increments add up to the final coverage and each point
    counts for the acquisition that was first to see it. `recovery_gain` therefore is what recoveries brought in this
    order, and not what the run would lack without them. The raw coverage cannot fall; the filtered one can.
    """

    coverage: Float[np.ndarray, "k"]
    """C_k of the raw cloud."""
    filtered_coverage: Float[np.ndarray, "k"]
    """The same of the points so far that lie in voxels occupied so far."""
    increments: Float[np.ndarray, "k"]
    """Delta C_k of the raw cloud."""
    n_activations: int
    """Acquisitions that set off a recovery."""
    recovery_gain: float
    """Coverage that the recovery acquisitions added."""

    @property
    def recovery_share(self) -> float:
        """Recovery gain over the final coverage; 0 if nothing is covered."""
        return self.recovery_gain / self.coverage[-1] if self.coverage[-1] > 0 else 0.0


def distance_to_samples(samples: Float[np.ndarray, "n 3"]) -> DistanceToSurface:
    """Distance to the nearest of dense surface samples.

    It is too large by less than h^2 / (2 d) at true distance d and by at most h near the surface, h the distance from
    the surface's nearest point to a sample. 300,000 random samples on 0.04 m^2 have h of 0.2 mm on average, enough for
    errors of millimetres.
    """
    tree = KDTree(samples)
    return lambda points: tree.query(points)[0]


def quality(reference: Reference, cloud: Float[np.ndarray, "n 3"]) -> Quality:
    """Coverage at all tolerances, accuracy, precision and F-score of a cloud [m]."""
    nearest = _nearest(reference, cloud)
    coverage = {tolerance: float(np.mean(nearest <= tolerance)) for tolerance in TOLERANCES}
    if len(cloud) == 0:
        return Quality(coverage, np.nan, np.nan, 0.0, 0.0)
    error = reference.distance(cloud)
    precision = float(np.mean(error <= TOLERANCE))
    both = coverage[TOLERANCE] + precision
    f_score = 2 * coverage[TOLERANCE] * precision / both if both > 0 else 0.0
    return Quality(coverage, float(error.mean()), float(np.median(error)), precision, f_score)


def history(reference: Reference, acquisitions: Sequence[Acquisition]) -> History:
    """Coverage after each acquisition, and what the recoveries have to do with it."""
    coverage, filtered = [], []
    nearest = np.full(len(reference.points), np.inf)
    for k, acquisition in enumerate(acquisitions):
        nearest = np.minimum(nearest, _nearest(reference, acquisition.points))
        coverage.append(np.mean(nearest <= TOLERANCE))
        cloud = np.concatenate([a.points for a in acquisitions[: k + 1]])
        grid = acquisition.model.voxel_map
        filtered.append(np.mean(_nearest(reference, cloud[grid.lookup(grid.occupied, cloud)]) <= TOLERANCE))
    increments = np.diff(coverage, prepend=0.0)
    recovery = np.array([acquisition.kind == "recovery" for acquisition in acquisitions])
    return History(
        np.array(coverage),
        np.array(filtered),
        increments,
        sum(acquisition.activates for acquisition in acquisitions),
        float(increments[recovery].sum()),
    )


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


def _nearest(reference: Reference, cloud: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "m"]:
    """Distance from each reference point to the cloud [m], infinite beyond the largest tolerance."""
    if len(cloud) == 0:
        return np.full(len(reference.points), np.inf)
    return KDTree(cloud).query(reference.points, distance_upper_bound=np.nextafter(max(TOLERANCES), 1.0))[0]
