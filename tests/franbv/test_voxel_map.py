"""The voxel map against a brute-force traversal and hand-made scans."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.frames import Intrinsics, look_at
from franbv.parameters import Parameters
from franbv.volumetric_information import view_information
from franbv.voxel_map import VoxelMap, empty_map, scan_voxels

TINY = Parameters(voxel_size=0.1, workspace_min=(-0.5, -0.4, -0.3), workspace_max=(0.5, 0.4, 0.3))
GRAZE = 1e-9
"""Ray segments shorter than this inside a voxel may be counted either way [ray parameter]."""


def _brute_force(grid, depth, intrinsics, T_world_cam, carve_on_missing):
    """Hits, misses and doubtful voxels by intersecting every ray with the six planes of every voxel."""
    hits, misses, doubtful = (np.zeros(grid.log_odds.shape, bool) for _ in range(3))
    # Two voxels around the grid as well: the one before a hit outside may be the last one inside.
    indices = np.stack(np.meshgrid(*(np.arange(-2, n + 2) for n in hits.shape), indexing="ij"), axis=-1).reshape(-1, 3)
    corners = (indices + grid.first + np.array([[[-0.5]], [[0.5]]])) * grid.voxel_size  # (2, n, 3)
    for direction, z in zip(intrinsics.pixel_directions().reshape(-1, 3), depth.ravel(), strict=True):
        if z == 0 and not carve_on_missing:
            continue
        t = (corners - T_world_cam.translation) / T_world_cam.rotation.apply(direction)
        enter = np.maximum(t.min(axis=0).max(axis=1), 0.0)
        length = np.minimum(t.max(axis=0).min(axis=1), z if z > 0 else np.inf) - enter
        crossed = np.flatnonzero(length > GRAZE)
        crossed = indices[crossed[np.argsort(enter[crossed])]]
        if z > 0:
            _mark(hits, crossed[-1:])
            crossed = crossed[:-2]
        _mark(misses, crossed)
        _mark(doubtful, indices[np.abs(length) <= GRAZE])
    return hits, misses, doubtful


def _mark(mask, indices):
    for index in indices:
        if np.all(index >= 0) and np.all(index < mask.shape):
            mask[tuple(index)] = True


@pytest.mark.parametrize("carve_on_missing", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_traversal_equals_brute_force(seed, carve_on_missing):
    """Crossed and hit voxels equal those of a loop over every ray and voxel, for cameras outside and inside the grid.

    Depths are random, so rays end inside, before and behind the grid; a fifth has no depth.
    """
    rng = np.random.default_rng(seed)
    eye = rng.uniform(-1, 1, 3) * ([0.3, 0.3, 0.2] if seed % 2 else [1.2, 1.2, 1.2])
    T = look_at(eye, rng.uniform(-0.1, 0.1, 3))
    intrinsics = Intrinsics(4, 3, 3.0, 3.0, 1.5, 1.0)
    depth = rng.uniform(0.05, 2.0, (3, 4)) * (rng.random((3, 4)) > 0.2)
    grid = empty_map(TINY)
    hits, misses = scan_voxels(grid, depth, intrinsics, T, carve_on_missing)
    expected_hits, expected_misses, doubtful = _brute_force(grid, depth, intrinsics, T, carve_on_missing)
    np.testing.assert_array_equal(hits, expected_hits)
    np.testing.assert_array_equal(misses[~doubtful], expected_misses[~doubtful])
    assert expected_misses.sum() > 20


def test_a_ray_along_an_axis_crosses_a_column():
    """Straight down through voxel centres (all slopes exactly 0): from z = 0.5 to the hit at 0, voxels 3 and 2 are
    missed, voxel 1 lies before the hit and voxel 0 is hit."""
    T = RigidTransform.from_components([0.1, -0.2, 0.5], Rotation.from_euler("x", 180, degrees=True))
    hits, misses = scan_voxels(empty_map(TINY), np.array([[0.5]]), Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0), T)
    np.testing.assert_array_equal(np.argwhere(hits), [[6, 2, 3]])
    np.testing.assert_array_equal(np.argwhere(misses), [[6, 2, 5], [6, 2, 6]])


def test_log_odds_follow_octomap():
    """n hits add n ln(0.7 / 0.3) until ln(0.97 / 0.03); misses add ln(0.4 / 0.6) until ln(0.12 / 0.88)."""
    T = RigidTransform.from_components([0.1, -0.2, 0.5], Rotation.from_euler("x", 180, degrees=True))
    octomap = TINY.model_copy(update={"miss_probability": 0.4})
    grid = empty_map(octomap)
    for scan in range(1, 13):
        grid = grid.updated(np.array([[0.5]]), Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0), T, octomap)
        assert grid.log_odds[6, 2, 3] == pytest.approx(min(scan * np.log(0.7 / 0.3), np.log(0.97 / 0.03)))
        assert grid.log_odds[6, 2, 5] == pytest.approx(max(scan * np.log(0.4 / 0.6), np.log(0.12 / 0.88)))
    assert (grid.occupied.sum(), grid.free.sum()) == (1, 2)
    assert grid.uncertain.sum() == grid.log_odds.size - 3


def test_hits_win_and_count_once():
    """Two rays of one scan, the nearer one ending in a voxel that the longer one crosses: one hit, no miss."""
    T = RigidTransform.from_components([0.0, 0.0, 1.0], Rotation.from_euler("x", 180, degrees=True))
    intrinsics = Intrinsics(3, 1, 1000.0, 1000.0, 1.0, 0.0)  # rays 1 mm apart at 1 m
    grid = empty_map(TINY).updated(np.array([[1.0, 0.8, 0.8]]), intrinsics, T, TINY)
    assert grid.log_odds[5, 4, 5] == pytest.approx(np.log(0.7 / 0.3))
    assert grid.log_odds[5, 4, 3] == pytest.approx(np.log(0.7 / 0.3))


def test_missing_depth_changes_nothing():
    """Pixels without depth carve nothing: the map of an all-invalid scan is the map before."""
    T = look_at(np.array([0.0, 0.0, 1.0]), np.zeros(3))
    grid = empty_map(TINY).updated(np.zeros((3, 4)), Intrinsics(4, 3, 3.0, 3.0, 1.5, 1.0), T, TINY)
    assert grid.uncertain.all()


def test_frontier_touches_free_and_occupied():
    """Hand-made: free slab x = 0, occupied voxel (1, 1, 1) in an unknown block.

    The uncertain 26-neighbours of (1, 1, 1) at x = 1 touch x = 0: eight of them; those at x = 2 touch no free voxel.
    """
    log_odds = np.zeros((4, 3, 3))
    log_odds[0] = -1.0
    log_odds[1, 1, 1] = 1.0
    grid = VoxelMap(np.zeros(3, int), 1.0, log_odds)
    expected = np.zeros_like(log_odds, dtype=bool)
    expected[1] = True
    expected[1, 1, 1] = False
    np.testing.assert_array_equal(grid.frontier(), expected)
    assert not grid.frontier(np.zeros_like(expected)).any()


@pytest.mark.parametrize("seed", range(3))
def test_frontier_equals_brute_force(seed):
    """In random maps every voxel's 26 neighbours are looked at one by one; nothing lies outside the grid."""
    rng = np.random.default_rng(seed)
    log_odds = rng.choice([-1.0, 0.0, 1.0], (7, 6, 5), p=[0.1, 0.8, 0.1])
    solid = (log_odds > 0) & (rng.random(log_odds.shape) > 0.5)
    expected = np.zeros_like(solid)
    for index in np.argwhere(log_odds == 0):
        around = tuple(slice(max(i - 1, 0), i + 2) for i in index)
        expected[tuple(index)] = (log_odds[around] < 0).any() and solid[around].any()
    np.testing.assert_array_equal(VoxelMap(np.zeros(3, int), 1.0, log_odds).frontier(solid), expected)
    assert expected.any()


def test_centres_and_lookup_are_inverse():
    """The centre of each voxel, and any point within half a voxel of it, is found in that voxel; outside is False."""
    grid = empty_map(TINY)
    mask = np.random.default_rng(0).random(grid.log_odds.shape) > 0.5
    centres = grid.centres(np.ones_like(mask))
    np.testing.assert_array_equal(grid.lookup(mask, centres + 0.049).reshape(mask.shape), mask)
    np.testing.assert_array_equal(grid.lookup(mask, centres - 0.049).reshape(mask.shape), mask)
    assert not grid.lookup(np.ones_like(mask), np.array([[5.0, 0, 0], [0, 0, -9.0]])).any()
    assert np.any(np.all(np.isclose(centres, 0.0), axis=1))  # a voxel is centred on the table top


def test_what_hits_and_misses_cancel_is_uncertain_and_not_untouched():
    """ln(0.6 / 0.4) + ln(0.4 / 0.6) = 0: one hit and one miss leave a voxel as likely occupied as free.

    In single precision the sum may be a hair beside 0, which would call the voxel free or occupied by rounding; and
    exactly 0 would call it untouched. A wall is seen at 0.3 m, then one behind it through the same voxel.
    """
    parameters = Parameters(hit_probability=0.6, miss_probability=0.4)
    camera, pose = Intrinsics(1, 1, 100.0, 100.0, 0.0, 0.0), look_at(np.array([0.0, 0.0, 0.34]), np.zeros(3))
    grid = empty_map(parameters)
    near, far = (grid.updated(np.full((1, 1), z), camera, pose, parameters) for z in (0.2, 0.25))
    (place,) = np.argwhere(near.occupied)
    both = near.updated(np.full((1, 1), 0.25), camera, pose, parameters)
    assert far.free[tuple(place)]
    assert not both.free[tuple(place)]
    assert not both.occupied[tuple(place)]
    assert both.uncertain[tuple(place)]
    assert both.touched[tuple(place)]
    assert not grid.touched.any()
    np.testing.assert_array_equal(both.touched, near.touched | far.touched)


def test_unobserved_gain_leaves_cancelled_voxels_out():
    """RE's variants that count what no ray has met: a voxel whose hits and misses cancel has been met."""
    log_odds = np.zeros((1, 1, 5), np.float32)
    cancelled = np.zeros(log_odds.shape, bool)
    cancelled[0, 0, 1:3] = True
    grid = VoxelMap(np.zeros(3, np.int64), 1.0, log_odds, cancelled)
    up = RigidTransform.from_translation([0.0, 0.0, -2.0])
    ray = Intrinsics(1, 1, 100.0, 100.0, 0.0, 0.0)
    # Rays lose half of their chance in every voxel of even odds: 1, 1/2, 1/4, 1/8, 1/16.
    found = view_information(grid, ray, [up], "unobserved")
    np.testing.assert_allclose(found, np.log(2) * (1 + 1 / 8 + 1 / 16))
