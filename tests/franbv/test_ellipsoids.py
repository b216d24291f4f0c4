"""Ellipsoids of voxel clouds: all voxels held, none dropped for being flat, the sieve of corners exact."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from franbv.ellipsoids import cluster_voxels, fit_ellipsoids, hull_corners
from franbv.parameters import Parameters

PARAMETERS = Parameters()
SIZE = PARAMETERS.voxel_size
NONE = np.zeros((0, 3))
CUBE = np.array(list(product([-0.5, 0.5], repeat=3)))


def layer(nx: int, ny: int, z: float = 10.0) -> np.ndarray:
    """Centres of a flat layer of voxels [m]."""
    return np.array([[x, y, z] for x in range(nx) for y in range(ny)], float) * SIZE


def ball(radius: float) -> np.ndarray:
    """Centres of the voxels of a solid ball [voxels]."""
    steps = np.arange(-np.ceil(radius), np.ceil(radius) + 1)
    points = np.array(list(product(steps, repeat=3)))
    return points[np.linalg.norm(points, axis=1) <= radius]


def holds(ellipsoids, points) -> np.ndarray:
    """Which points lie in any of the ellipsoids, on the surface included."""
    offset = points[:, None] - ellipsoids.centres
    reach = np.einsum("nki,kij,nkj->nk", offset, np.linalg.inv(ellipsoids.shapes), offset)
    return reach.min(axis=1) <= 1.0 + 1e-9


def test_every_corner_of_every_voxel_is_held():
    """Clusters share out the voxels and each ellipsoid encloses the cubes of its own, so no corner is left out."""
    rng = np.random.default_rng(0)
    occupied = np.unique(rng.integers(0, 12, size=(300, 3)), axis=0) * SIZE
    frontier = layer(9, 14)
    ellipsoids = fit_ellipsoids(occupied, frontier, PARAMETERS, 1)
    for voxels, kind in ((occupied, False), (frontier, True)):
        of_kind = type(ellipsoids)(
            ellipsoids.centres[ellipsoids.is_frontier == kind],
            ellipsoids.shapes[ellipsoids.is_frontier == kind],
            ellipsoids.is_frontier[ellipsoids.is_frontier == kind],
        )
        assert len(of_kind) > 0
        assert np.all(holds(of_kind, (voxels[:, None] + CUBE * SIZE).reshape(-1, 3)))


def test_flat_and_line_like_clouds_keep_a_volume():
    """No cluster is dropped for being flat: around n x m x 1 voxels the semi-axes are sqrt(3)/2 n, m and 1 voxels.

    One component is forced, so that the box is known; a smallest ellipsoid goes along with affine maps of the cube.
    """
    single = PARAMETERS.model_copy(update={"max_components": 1})
    for nx, ny in ((6, 4), (5, 1), (1, 1)):
        ellipsoids = fit_ellipsoids(layer(nx, ny), NONE, single, 0)
        axes = np.sqrt(np.linalg.eigvalsh(ellipsoids.shapes[0]))
        np.testing.assert_allclose(axes, np.sort(np.sqrt(3.0) / 2.0 * SIZE * np.array([nx, ny, 1])), rtol=0.01)
        np.testing.assert_allclose(
            ellipsoids.centres[0], np.array([(nx - 1) / 2, (ny - 1) / 2, 10.0]) * SIZE, atol=1e-12
        )


def test_all_clusters_of_a_flat_cloud_have_ellipsoids():
    """Two flat patches far apart: as many ellipsoids as clusters, two at least."""
    occupied = np.concatenate([layer(5, 5), layer(5, 5) + np.array([0.3, 0.0, 0.0])])
    n_clusters = cluster_voxels(occupied / SIZE, PARAMETERS, 0).max() + 1
    assert n_clusters >= 2
    seeds = np.random.SeedSequence(3).generate_state(2)
    n_clusters = cluster_voxels(occupied / SIZE, PARAMETERS, int(seeds[0])).max() + 1
    assert len(fit_ellipsoids(occupied, NONE, PARAMETERS, 3)) == n_clusters


@pytest.mark.parametrize(("occupied", "frontier"), [(NONE, NONE), (layer(4, 4), NONE), (NONE, layer(4, 4))])
def test_either_cloud_may_be_empty(occupied, frontier):
    """Only the kinds that exist are stood for."""
    ellipsoids = fit_ellipsoids(occupied, frontier, PARAMETERS, 0)
    assert np.any(~ellipsoids.is_frontier) == (len(occupied) > 0)
    assert np.any(ellipsoids.is_frontier) == (len(frontier) > 0)
    assert ellipsoids.centres.shape == (len(ellipsoids), 3)


def test_sieved_corners_span_the_same_hull():
    """The corners that are kept have the convex hull, in volume and in area, of all corners; few of them are kept."""
    for voxels in (ball(4.2), np.unique(np.random.default_rng(5).integers(0, 9, size=(150, 3)), axis=0).astype(float)):
        labels = (voxels[:, 0] > voxels[:, 0].mean()).astype(int)
        corners, corner_labels = hull_corners(voxels, labels)
        for k in range(2):
            everything = ConvexHull((voxels[labels == k, None] + CUBE).reshape(-1, 3))
            kept = ConvexHull(corners[corner_labels == k])
            assert kept.volume == pytest.approx(everything.volume, rel=1e-12)
            assert kept.area == pytest.approx(everything.area, rel=1e-12)
        assert len(corners) < 0.25 * 8 * len(voxels)


def test_a_box_of_voxels_keeps_its_eight_corners():
    """All other corners lie between two others on a lattice line."""
    box = np.array(list(product(range(5), range(3), range(4))), float)
    corners, _ = hull_corners(box, np.zeros(len(box), int))
    expected = {(x, y, z) for x in (-0.5, 4.5) for y in (-0.5, 2.5) for z in (-0.5, 3.5)}
    assert {tuple(corner) for corner in corners.tolist()} == expected


def test_off_the_lattice_nothing_is_lost():
    """Points in general position share no lattice line; every centre is kept, and the hull with it."""
    voxels = np.random.default_rng(6).uniform(0, 5, size=(40, 3))
    corners, _ = hull_corners(voxels, np.zeros(40, int))
    everything = ConvexHull((voxels[:, None] + CUBE).reshape(-1, 3))
    assert ConvexHull(corners).volume == pytest.approx(everything.volume, rel=1e-12)


def test_one_seed_gives_one_result():
    """Bit for bit, from the number or from a SeedSequence, which is not used up; another seed differs."""
    solid = ball(6.3)
    cloud = solid[np.linalg.norm(solid, axis=1) > 5.3] * SIZE  # a shell, which takes several components
    first = fit_ellipsoids(cloud, cloud + 0.2, PARAMETERS, 5)
    sequence = np.random.SeedSequence(5)
    for again in (fit_ellipsoids(cloud, cloud + 0.2, PARAMETERS, sequence) for _ in range(2)):
        np.testing.assert_array_equal(first.centres, again.centres)
        np.testing.assert_array_equal(first.shapes, again.shapes)
    other = fit_ellipsoids(cloud, cloud + 0.2, PARAMETERS, 6)
    assert not np.array_equal(first.centres, other.centres)
