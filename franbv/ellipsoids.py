"""Ellipsoids that stand in for the object: E_o for occupied voxels and E_f for frontier voxels (paper, section III-B).

Each set of voxels is split by a Gaussian mixture with BIC, and each cluster is wrapped in its smallest ellipsoid. The
ellipsoid holds the voxels as cubes and not just their centres, so that a flat cluster has a volume too.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from franbv.geometry.enclosing_ellipsoid import enclosing_ellipsoids
from franbv.geometry.mixture import select_mixture
from franbv.parameters import Parameters

CUBE = np.stack(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5], indexing="ij"), axis=-1).reshape(8, 3)
"""Corners of a voxel about its centre [voxels]."""
GRAIN = 1e-6
"""Coordinates that differ by less lie on one lattice line [voxels]: a choice, far above rounding, far below a voxel."""


@dataclass(frozen=True, eq=False)
class Ellipsoids:
    """Ellipsoids (x - c)^T S^-1 (x - c) <= 1 in the world frame; there may be none.

    Each is the smallest in volume around the voxels of one cluster, taken as cubes, to `Parameters.enclosing_tolerance`
    (paper, section III-B). The dual of the paper's quadric Q, eq. (1), is Q^-1 = [[S - c c^T, -c], [-c^T, -1]]. They
    stand for where the voxels are and not for the surface: they overlap, and bulge over the rims of their clusters.
    """

    centres: Float[np.ndarray, "k 3"]
    """c [m]."""
    shapes: Float[np.ndarray, "k 3 3"]
    """S, symmetric positive definite; its eigenvalues are the squared semi-axes [m^2]."""
    is_frontier: Bool[np.ndarray, "k"]
    """Whether it stands for frontier voxels (E_f) or for occupied ones (E_o)."""

    def __len__(self) -> int:
        return len(self.centres)

    def of_occupied(self) -> "Ellipsoids":
        """E_o alone."""
        return self._those(~self.is_frontier)

    def of_frontier(self) -> "Ellipsoids":
        """E_f alone."""
        return self._those(self.is_frontier)

    def _those(self, which: Bool[np.ndarray, "k"]) -> "Ellipsoids":
        return Ellipsoids(self.centres[which], self.shapes[which], self.is_frontier[which])


def fit_ellipsoids(
    occupied: Float[np.ndarray, "n 3"],
    frontier: Float[np.ndarray, "m 3"],
    parameters: Parameters,
    seed: int | np.random.SeedSequence,
) -> Ellipsoids:
    """E_o and E_f of voxel centres [m]; either may be empty.

    seed: of the k-means++ starts. The same seed gives the same ellipsoids; a SeedSequence is not used up.
    """
    sequence = seed if isinstance(seed, np.random.SeedSequence) else np.random.SeedSequence(seed)
    seeds = sequence.generate_state(2)
    voxel = parameters.voxel_size
    occupied_labels = cluster_voxels(occupied / voxel, parameters, int(seeds[0]))
    frontier_labels = cluster_voxels(frontier / voxel, parameters, int(seeds[1]))
    n_occupied = occupied_labels.max(initial=-1) + 1
    labels = np.concatenate([occupied_labels, frontier_labels + n_occupied])
    corners, corner_labels = hull_corners(np.concatenate([occupied, frontier]) / voxel, labels)
    centres, shapes = enclosing_ellipsoids(corners, corner_labels, parameters.enclosing_tolerance)
    return Ellipsoids(centres * voxel, shapes * voxel**2, np.arange(len(centres)) >= n_occupied)


def cluster_voxels(voxels: Float[np.ndarray, "n 3"], parameters: Parameters, seed: int) -> Int[np.ndarray, "n"]:
    """Cluster 0..k-1 of each voxel centre [voxels], by the mixture of least BIC; no cluster is empty."""
    if len(voxels) == 0:
        return np.zeros(0, int)
    mixture, _ = select_mixture(voxels, parameters.max_components, parameters.covariance, seed)
    # A component may be no point's most probable one.
    return np.unique(mixture.labels, return_inverse=True)[1]


def hull_corners(
    voxels: Float[np.ndarray, "n 3"], labels: Int[np.ndarray, "n"]
) -> tuple[Float[np.ndarray, "m 3"], Int[np.ndarray, "m"]]:
    """Those corners of each cluster's voxels that can be vertices of its convex hull, and their labels.

    voxels: centres [voxels]. The hull of cubes is the hull of the centres plus a cube, so a centre that is no vertex
    adds none; this and the second sieve leave a few dozen of many hundred corners, with the same hull.
    """
    outer = _ends_of_lines(voxels, labels)
    corners = (voxels[outer, None] + CUBE).reshape(-1, 3)
    labels = np.repeat(labels[outer], len(CUBE))
    outer = _ends_of_lines(corners, labels)
    return corners[outer], labels[outer]


def _ends_of_lines(points, labels):
    """Indices of points that end their lattice line along every axis; what lies between two others is no vertex.

    Off the lattice every point has lines of its own and is kept. Of equal points one is kept.
    """
    if len(points) == 0:
        return np.zeros(0, int)
    rows = np.column_stack([labels, np.round(points / GRAIN).astype(np.int64)])  # (n, 4)
    order = np.lexsort(rows.T)
    kept = order[np.append(True, _changes(rows[order]))]
    for axis in (1, 2, 3):
        line = np.delete(rows[kept], axis, axis=1)
        order = np.lexsort((rows[kept, axis], *line.T))
        changes = _changes(line[order])
        kept = kept[order[np.append(True, changes) | np.append(changes, True)]]
    return kept


def _changes(rows):
    """Whether each row differs from the one before it, from the second row on."""
    return np.any(rows[1:] != rows[:-1], axis=1)
