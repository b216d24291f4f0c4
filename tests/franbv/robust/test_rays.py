"""Rays through voxels against the other map's traversal and against steps of a hundredth of a voxel."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.frames import Intrinsics, look_at, rolled
from franbv.robust.rays import SurfaceGrid, add_evidence, cells_of, first_surfaces
from franbv.voxel_map import VoxelMap, scan_voxels

CAMERA = Intrinsics(12, 9, 9.0, 9.0, 5.5, 4.0)
SIZE = 0.01
GRID = VoxelMap(np.array([-10, -12, -3]), SIZE, np.zeros((21, 25, 16), np.float32))


def random_scan(seed: int):
    """A pose somewhere around the grid, depths of a few decimetres, some without any."""
    rng = np.random.default_rng(seed)
    eye = rng.uniform([-0.3, -0.3, 0.0], 0.3)
    pose = rolled(look_at(eye, rng.uniform(-0.05, 0.05, 3)), rng.uniform(0, 360))
    depth = rng.uniform(0.05, 0.5, (9, 12)) * (rng.random((9, 12)) > 0.2)
    return pose, depth


def rays_of(pose: RigidTransform, depth: np.ndarray):
    """Origin and unit rays in cells, lengths [m]."""
    rays = CAMERA.pixel_directions().reshape(-1, 3)
    norm = np.linalg.norm(rays, axis=1)
    origin = cells_of(pose.translation[None], GRID.first, SIZE)[0]
    return origin, pose.rotation.apply(rays / norm[:, None]) / SIZE, depth.ravel() * norm


@pytest.mark.parametrize("seed", range(40))
def test_hits_and_passes_are_those_of_the_other_map(seed: int):
    """With whole trust in all rays: each voxel once, a hit outweighs passes, the voxel before the end is spared."""
    pose, depth = random_scan(seed)
    origin, directions, lengths = rays_of(pose, depth)
    hits, passes = np.zeros((2, *GRID.log_odds.shape), np.float32)
    add_evidence(GRID.log_odds.shape, origin, directions, lengths, lengths, np.ones(len(lengths)), hits, passes)
    hit, crossed = scan_voxels(GRID, depth, CAMERA, pose)
    np.testing.assert_array_equal(hits > 0, hit)
    np.testing.assert_array_equal(passes > 0, crossed & ~hit)
    assert set(np.unique(hits)) | set(np.unique(passes)) <= {0.0, 1.0}


def test_the_best_ray_of_a_scan_counts():
    """Two rays into one voxel: the trust of the better; two scans add up."""
    origin, directions = np.array([0.5, 12.5, 8.5]), np.array([[100.0, 0, 0], [100.0, 0.1, 0]])
    hits, passes = np.zeros((2, *GRID.log_odds.shape), np.float32)
    lengths, trust = np.full(2, 0.1), np.array([0.3, 0.8])
    for _ in range(2):
        add_evidence(GRID.log_odds.shape, origin, directions, lengths, lengths, trust, hits, passes)
    assert hits[10, 12, 8] == pytest.approx(1.6)
    assert hits.sum() == pytest.approx(1.6)
    np.testing.assert_allclose(passes[:9, 12, 8], 1.6)
    assert passes[9:].sum() == 0


@pytest.mark.parametrize("seed", range(20))
def test_first_surface_by_small_steps(seed: int):
    """The first voxel with a normal that the ray does not graze, at the middle of its way through it."""
    rng = np.random.default_rng(seed)
    normals = np.zeros((*GRID.log_odds.shape, 3), np.float32)
    solid = rng.random(GRID.log_odds.shape) < 0.05
    normals[solid] = Rotation.random(int(solid.sum()), rng=rng).apply([0, 0, 1]).astype(np.float32)
    pose, depth = random_scan(seed)
    origin, directions, _ = rays_of(pose, depth)
    reach = np.full(len(directions), 0.6)
    found, cosine = first_surfaces(
        SurfaceGrid.of(normals, solid), np.tile(origin, (len(directions), 1)), directions, 0.4, reach
    )
    steps = np.arange(0.0, 0.6, SIZE / 100)
    met = 0
    for ray, direction in enumerate(directions):
        cells = np.floor(origin + steps[:, None] * direction).astype(int)
        inside = np.all((cells >= 0) & (cells < GRID.log_odds.shape), axis=1)
        along = np.zeros(len(steps))
        along[inside] = np.abs(normals[tuple(cells[inside].T)] @ (direction * SIZE))
        if not np.any(along > 0.4):
            continue  # it may clip a corner between two steps
        first = int(np.argmax(along > 0.4))
        last = first + int(np.argmin(np.all(cells[first:] == cells[first], axis=1)))
        if last - first < 5:
            continue
        met += 1
        if found[ray] < steps[first] - SIZE / 50:
            continue  # a corner that the steps jumped over
        assert found[ray] == pytest.approx((steps[first] + steps[last]) / 2, abs=SIZE / 40)
        assert cosine[ray] == pytest.approx(along[first], abs=1e-4)
    assert met > 3
