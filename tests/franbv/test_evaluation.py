"""Evaluation measures on clouds whose coverage, accuracy and F-score are known by counting."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.acquisition import Acquisition
from franbv.ellipsoids import Ellipsoids
from franbv.evaluation.coverage import MAP_MEASURE, RAW_MEASURE, Measure, history
from franbv.evaluation.quality import quality, wrongly_free_share, wrongly_occupied_share
from franbv.evaluation.reference import Reference, distance_to_samples
from franbv.frames import Intrinsics
from franbv.model import Model
from franbv.object_model import object_model
from franbv.parameters import Parameters
from franbv.recovery import RecoveryPoses
from franbv.sensing import DepthBurst
from franbv.voxel_map import VoxelMap, empty_map

PARAMETERS = Parameters(voxel_size=0.02, workspace_min=(0.0, 0.0, 0.0), workspace_max=(0.18, 0.08, 0.04))
X, Y = np.meshgrid(np.arange(10) * 0.02, np.arange(5) * 0.02, indexing="ij")
PLANE = np.column_stack([X.ravel(), Y.ravel(), np.full(X.size, 0.02)])
"""50 reference points 2 cm apart on the plane z = 2 cm: each in its own voxel, none near enough to cover another."""
REFERENCE = Reference(PLANE, lambda points: np.abs(points[:, 2] - 0.02))


def _acquisition(kind, points, voxel_map, activates=False):
    burst = DepthBurst(np.zeros((1, 1, 1), np.float32), Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0), RigidTransform.identity())
    ellipsoids = Ellipsoids(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros(0, bool))
    model = Model(voxel_map, object_model(voxel_map, PARAMETERS), ellipsoids)
    poses = (
        RecoveryPoses((RigidTransform.identity(),), np.zeros(3), np.array([0.0, 0.0, 1.0]), False, 0, 0, 0, 0)
        if activates
        else None
    )
    return Acquisition(0, 0, kind, burst, points, model, None, 0, None, poses, None, None, None, {}, 0.0, 0.0)


def test_half_a_plane_at_four_millimetres():
    """Half of the points doubled 4 mm above: coverage 0 at 2.5 mm and 1/2 from 5 mm on; error 4 mm; F = 2/3."""
    result = quality(REFERENCE, PLANE[:25] + np.array([0.0, 0.0, 0.004]))
    assert list(result.coverage.values()) == [0.0, 0.5, 0.5, 0.5]
    assert result.accuracy_mean == pytest.approx(0.004)
    assert result.accuracy_median == pytest.approx(0.004)
    assert result.precision == 1.0
    assert result.f_score == pytest.approx(2 / 3)


def test_floaters_cost_precision_and_not_coverage():
    """All points exact plus as many 3 cm above: coverage 1, precision 1/2, F 2/3, mean error 1.5 cm."""
    result = quality(REFERENCE, np.concatenate([PLANE, PLANE + np.array([0.0, 0.0, 0.03])]))
    assert result.coverage[0.0025] == 1.0
    assert (result.precision, result.f_score) == (0.5, pytest.approx(2 / 3))
    assert result.accuracy_mean == pytest.approx(0.015)


def test_an_empty_cloud_reconstructs_nothing():
    """Coverage, precision and F-score 0; an accuracy of no points does not exist."""
    result = quality(REFERENCE, np.zeros((0, 3)))
    assert set(result.coverage.values()) == {0.0}
    assert (result.precision, result.f_score) == (0.0, 0.0)
    assert np.isnan(result.accuracy_mean)


def test_increments_are_attributed_to_their_kind():
    """10 points, then 20 new ones by a recovery, then 5 old and 5 new: C = 0.2, 0.6, 0.7; recovery 0.4, share 4/7."""
    grid = empty_map(PARAMETERS)
    clouds = [PLANE[:10], PLANE[10:30], PLANE[25:35]]
    kinds = ["first", "recovery", "nbv"]
    runs = [_acquisition(k, c, grid, activates=k == "first") for k, c in zip(kinds, clouds, strict=True)]
    result = history(REFERENCE, runs)
    np.testing.assert_allclose(result.coverage[RAW_MEASURE], [0.2, 0.6, 0.7])
    np.testing.assert_allclose(result.increments(RAW_MEASURE), [0.2, 0.4, 0.1])
    np.testing.assert_allclose(result.coverage[MAP_MEASURE], 0.0)  # nothing is occupied in an empty map
    assert result.n_activations == 1
    assert result.recovery_contribution(RAW_MEASURE) == pytest.approx(0.4)
    assert result.recovery_share == pytest.approx(4 / 7)


def test_coverage_of_the_map_follows_the_map_of_its_time():
    """The first map holds x < 10 cm occupied, the second nothing: all 25 points there count at first, none later.

    So the recovery view that carved them away contributed -1/2 to the map's coverage, and nothing to the raw one.
    """
    grid = empty_map(PARAMETERS)
    log_odds = grid.log_odds.copy()
    log_odds[:5] = 1.0
    runs = [
        _acquisition("first", PLANE, VoxelMap(grid.first, grid.voxel_size, log_odds)),
        _acquisition("recovery", PLANE, grid),
    ]
    result = history(REFERENCE, runs)
    np.testing.assert_allclose(result.coverage[MAP_MEASURE], [0.5, 0.0])
    np.testing.assert_allclose(result.increments(MAP_MEASURE), [0.5, -0.5])
    np.testing.assert_allclose(result.coverage[RAW_MEASURE], 1.0)
    assert result.recovery_contribution(MAP_MEASURE) == pytest.approx(-0.5)
    assert result.recovery_share == 0.0


def test_a_base_that_no_view_sees_caps_the_coverage():
    """A block of 160 x 100 x 40 mm upright on its smallest face, all but that face seen: 488 of 528 cm^2 are 92.4 %.

    One point stands for each cm^2, those that are seen at z = 2 cm in occupied voxels, those of the base 10 m below.
    """
    seen, base = np.tile(PLANE, (10, 1))[:488], np.tile([0.0, 0.0, -10.0], (40, 1))
    grid = empty_map(PARAMETERS)
    occupied = VoxelMap(grid.first, grid.voxel_size, np.ones_like(grid.log_odds))
    result = history(Reference(seen, REFERENCE.distance, base), [_acquisition("first", PLANE, occupied)])
    for counted in ("raw", "filtered", "voxel"):
        assert result.coverage[Measure(counted)][0] == 1.0
        assert result.coverage[Measure(counted, with_base=True)][0] == pytest.approx(0.924, abs=0.0005)


def test_all_measures_are_those_of_brute_force():
    """Maps that gain and lose voxels at random under random clouds: the formulas from all pairs, at every acquisition.

    Counted are all points so far, those in voxels occupied now, and the centres of the object's voxels.
    """
    rng = np.random.default_rng(5)
    low, high = np.array(PARAMETERS.workspace_min), np.array(PARAMETERS.workspace_max)
    seen, base = rng.uniform(low, high, (300, 3)), rng.uniform(low, high, (60, 3))
    grid = empty_map(PARAMETERS)
    runs = []
    for k in range(8):
        log_odds = rng.normal(size=grid.log_odds.shape).astype(np.float32)
        points = rng.uniform(low, high, (0 if k == 3 else 40, 3))
        runs.append(_acquisition("nbv", points, VoxelMap(grid.first, grid.voxel_size, log_odds)))
    result = history(Reference(seen, REFERENCE.distance, base), runs)
    for k, run in enumerate(runs):
        cloud = np.concatenate([earlier.points for earlier in runs[: k + 1]])
        voxel = np.floor(cloud / 0.02 + 0.5).astype(int) - grid.first
        mapped = cloud[run.model.voxel_map.log_odds[tuple(voxel.T)] > 0]
        counted = {"raw": cloud, "filtered": mapped, "voxel": run.model.object.occupied}
        for measure, curve in result.coverage.items():
            surface = np.concatenate([seen, base]) if measure.with_base else seen
            distance = np.linalg.norm(surface[:, None] - counted[measure.counted], axis=-1)
            assert curve[k] == np.mean(distance.min(axis=1, initial=np.inf) <= measure.tolerance), (k, measure)
    assert any(np.any(np.diff(curve) < 0) for curve in result.coverage.values())


def test_wrongly_free_counts_surface_voxels():
    """Of the 50 voxels that hold a reference point, 5 of the surface are free; free space elsewhere does not count."""
    grid = empty_map(PARAMETERS)
    log_odds = grid.log_odds.copy()
    log_odds[0, :, 1] = -1.0  # one row of five surface voxels
    log_odds[:, :, 2] = -1.0  # above the surface
    assert wrongly_free_share(REFERENCE, VoxelMap(grid.first, grid.voxel_size, log_odds)) == pytest.approx(0.1)


def test_distance_to_samples_is_close_and_never_too_small():
    """3 mm off a sphere the nearest of its samples is at least that far, and no farther than the law of cosines says.

    h is the distance from the sphere's point below the probe to its nearest sample.
    """
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(50_000, 3))
    samples = 0.05 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    probe = rng.normal(size=(200, 3))
    probe /= np.linalg.norm(probe, axis=1, keepdims=True)
    on_sphere, true = 0.05 * probe, 0.003
    h = distance_to_samples(samples)(on_sphere)
    found = distance_to_samples(samples)((0.05 + true) * probe)
    assert np.all(found >= true)
    # |p - s|^2 = d^2 + h^2 (1 + d / R) for a sphere of radius R.
    assert np.all(found <= np.sqrt(true**2 + h**2 * (1 + true / 0.05)) + 1e-12)


def test_wrongly_occupied_voxels_are_counted():
    """Voxels of 2 cm: half a diagonal is 17.3 mm. At 0, 17, 18, 40 mm: two of four cannot touch."""
    centres = np.array([0.0, 0.0, 0.02]) + np.outer([0.0, 0.017, -0.018, 0.04], [0.0, 0.0, 1.0])
    assert wrongly_occupied_share(REFERENCE, centres, 0.02) == 0.5
    assert wrongly_occupied_share(REFERENCE, np.zeros((0, 3)), 0.02) is None
