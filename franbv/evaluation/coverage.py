"""Coverage after each acquisition: what is counted, within which tolerance, of which surface (paper, section VI).

A coverage is the share of reference points that have something counted within the tolerance. The paper states 5 mm and
10,000 points drawn evenly over the CAD surface, and leaves open what is counted and whether the face that the object
stands on is among the points. The alternatives, after acquisition k:
- what is counted. `raw`: the cloud, all points so far in the workspace and above the table. `filtered`: those points of
  it that lie in voxels which the map of acquisition k holds occupied. `voxel`: the centres of the object's occupied
  voxels, the planner's own O_t: the table is cut away, and so are floaters (all occupied voxels above the table would
  add those alone, which lie off the surface).
- tolerance: 5 mm, or 7.5 mm, a voxel's side. A voxel's centre lies up to 6.5 mm from a surface through the voxel, so
  that at 5 mm voxels cover a sound surface in part only.
- surface: R, what some view of the upper hemisphere can see; or with the base face as well, which none can: a block of
  160 x 100 x 40 mm that stands on its smallest face then cannot pass 92.4 %.
The raw coverage cannot fall. The others can, where later rays carve occupied voxels away, and the paper's does: its
increments reach -14 points (figures of its authors).
- MAP_MEASURE is the headline, the coverage of the map: `filtered` at 5 mm without the base. Points are as fine as the
  tolerance, voxels are not, and what no view can see is no fault of a planner.
- increments: Delta C_k = C_k - C_(k-1), C_-1 = 0, so that they add up to the final coverage.
- recovery contribution: sum of the increments of the recovery acquisitions. It is what they brought in this order, and
  not what the run would lack without them; where coverage can fall it can be negative.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import KDTree

from franbv.acquisition import Acquisition
from franbv.evaluation.reference import TOLERANCE, TOLERANCES, Reference, no_points

CoveringSet = Literal["raw", "filtered", "voxel"]
COVERING_SETS: tuple[CoveringSet, ...] = ("raw", "filtered", "voxel")


class Measure(NamedTuple):
    """One way to say how much of the surface is covered; the alternatives stand at the head of the module."""

    counted: CoveringSet
    tolerance: float = TOLERANCE
    """[m]"""
    with_base: bool = False
    """Whether the face that the object stands on is among the reference points."""


RAW_MEASURE = Measure("raw")
"""Of the growing cloud."""
MAP_MEASURE = Measure("filtered")
"""The headline, coverage of the map; its tolerance is the paper's. To judge all runs by an alternative, change this."""

NARROW_AND_WIDE = (TOLERANCE, 0.0075)
"""Tolerances of the alternatives [m]: the paper's, and the side of its voxels."""
MEASURES = (
    *(Measure("raw", tolerance) for tolerance in TOLERANCES),
    *(Measure(counted, tolerance) for counted in ("filtered", "voxel") for tolerance in NARROW_AND_WIDE),
    *(Measure(counted, tolerance, with_base=True) for counted in COVERING_SETS for tolerance in NARROW_AND_WIDE),
)
"""What is followed through a run."""


@dataclass(frozen=True, eq=False)
class History:
    """Coverage acquisition by acquisition, of each of MEASURES; k counts all of them, recoveries too."""

    coverage: Mapping[Measure, Float[np.ndarray, "k"]]
    """C_k."""
    is_recovery: Bool[np.ndarray, "k"]
    """Which acquisitions are recovery views."""
    n_activations: int
    """Acquisitions that set off a recovery."""

    def increments(self, measure: Measure) -> Float[np.ndarray, "k"]:
        """Delta C_k."""
        return np.diff(self.coverage[measure], prepend=0.0)

    def recovery_contribution(self, measure: Measure) -> float:
        """Sum of the increments of the recovery acquisitions."""
        return float(self.increments(measure)[self.is_recovery].sum())

    @property
    def recovery_share(self) -> float:
        """Recovery contribution to the raw coverage over the final one; 0 if nothing is covered."""
        final = self.coverage[RAW_MEASURE][-1]
        return self.recovery_contribution(RAW_MEASURE) / final if final > 0 else 0.0


def history(reference: Reference, acquisitions: Iterable[Acquisition]) -> History:
    """Coverage after each acquisition, and what the recoveries have to do with it."""
    record = CoverageRecord(reference)
    for acquisition in acquisitions:
        record.add(acquisition)
    return record.history()


class CoverageRecord:
    """Follows all of MEASURES through a run, acquisition by acquisition, at the cost of what each one changes.

    The maps of a run share one grid, and its points stay where they are: between two acquisitions some voxels become
    occupied or cease to be, and with them the points inside begin or cease to count.
    """

    def __init__(self, reference: Reference) -> None:
        points = np.concatenate([reference.points, reference.base])
        self._n_seen = len(reference.points)
        self._near = {counted: _Neighbours(points) for counted in COVERING_SETS}
        self._cloud = no_points()
        self._counts = np.zeros(0, bool)  # which points of the cloud lie in occupied voxels
        self._voxels: Bool[np.ndarray, "x y z"] | None = None
        self._rows: list[dict[Measure, float]] = []
        self._is_recovery: list[bool] = []
        self._n_activations = 0

    def add(self, acquisition: Acquisition) -> dict[Measure, float]:
        """Coverage after this acquisition, which follows those that were added before."""
        self._near["raw"].add(acquisition.points)
        self._add_to_filtered(acquisition)
        self._add_to_voxels(acquisition)
        self._is_recovery.append(acquisition.kind == "recovery")
        self._n_activations += acquisition.activates
        self._rows.append({measure: float(np.mean(self.covered(measure))) for measure in MEASURES})
        return self._rows[-1]

    def covered(self, measure: Measure) -> Bool[np.ndarray, "n"]:
        """Which reference points are covered now: the visible ones, then those of the base where the measure has it."""
        covered = self._near[measure.counted].within(measure.tolerance)
        return covered if measure.with_base else covered[: self._n_seen]

    def history(self) -> History:
        """All that was added."""
        curves = {measure: np.array([row[measure] for row in self._rows]) for measure in MEASURES}
        return History(curves, np.array(self._is_recovery, bool), self._n_activations)

    def _add_to_filtered(self, acquisition: Acquisition) -> None:
        self._cloud = np.concatenate([self._cloud, acquisition.points])
        before = np.concatenate([self._counts, np.zeros(len(acquisition.points), bool)])
        grid = acquisition.model.voxel_map
        self._counts = grid.lookup(grid.occupied, self._cloud)
        self._near["filtered"].add(self._cloud[self._counts & ~before])
        self._near["filtered"].remove(self._cloud[before & ~self._counts])

    def _add_to_voxels(self, acquisition: Acquisition) -> None:
        grid = acquisition.model.voxel_map
        before = np.zeros(grid.log_odds.shape, bool) if self._voxels is None else self._voxels
        index, _ = grid.indices(acquisition.model.object.occupied)
        self._voxels = np.zeros(grid.log_odds.shape, bool)
        self._voxels[tuple(index.T)] = True
        self._near["voxel"].add(grid.centres(self._voxels & ~before))
        self._near["voxel"].remove(grid.centres(before & ~self._voxels))


class _Neighbours:
    """How many of the counted points lie within each tolerance of each reference point."""

    REACH = 1.001 * max(TOLERANCES)
    """Within this pairs are looked for [m]: a little more, so that rounding in the search decides about none."""

    def __init__(self, reference: Float[np.ndarray, "n 3"]) -> None:
        self._tree = KDTree(reference)
        self._counts = {tolerance: np.zeros(len(reference), np.int64) for tolerance in TOLERANCES}

    def add(self, points: Float[np.ndarray, "m 3"]) -> None:
        """Count these as well."""
        self._change(points, 1)

    def remove(self, points: Float[np.ndarray, "m 3"]) -> None:
        """Count these no more; they were added before."""
        self._change(points, -1)

    def within(self, tolerance: float) -> Bool[np.ndarray, "n"]:
        """Which reference points have a counted point within one of TOLERANCES [m]."""
        return self._counts[tolerance] > 0

    def _change(self, points: Float[np.ndarray, "m 3"], by: int) -> None:
        if len(points) == 0:
            return
        pairs = self._tree.sparse_distance_matrix(KDTree(points), self.REACH, output_type="ndarray")
        for tolerance in TOLERANCES:
            found = pairs["i"][pairs["v"] <= tolerance]
            self._counts[tolerance] += by * np.bincount(found, minlength=self._tree.n)
