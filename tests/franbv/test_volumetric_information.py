"""The ray-cast entropy baseline: against rays followed in plain Python, and against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.frames import Intrinsics, look_at
from franbv.geometry.oriented_box import axis_aligned_box
from franbv.parameters import Parameters
from franbv.planners import random_views, ray_entropy
from franbv.reconstruction import reconstruct
from franbv.volumetric_information import GAINS, MEETING, view_information
from franbv.voxel_map import VoxelMap
from tests.franbv.plain_information import plain_information

SENSOR = Intrinsics(9, 7, 8.0, 8.0, 3.9, 3.2)
ONE_RAY = Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0)
SIZE = 0.01
EXACT = 1e-6
"""Relative. The chance below which a ray is given up leaves out less."""


def grid(log_odds: np.ndarray) -> VoxelMap:
    """These voxels, the first one centred on (-5, -4, 0) voxels."""
    return VoxelMap(np.array([-5, -4, 0]), SIZE, log_odds.astype(np.float32))


def random_grid(seed: int) -> VoxelMap:
    """A third of the voxels untouched, the others anything between the clamps."""
    rng = np.random.default_rng(seed)
    log_odds = rng.uniform(-2.0, 3.4, (12, 10, 8))
    return grid(np.where(rng.uniform(size=log_odds.shape) < 0.33, 0.0, log_odds))


def poses_around() -> list[RigidTransform]:
    """From outside, from inside, from above, and turned away."""
    eyes = [(0.15, 0.11, 0.13), (-0.2, 0.03, 0.01), (0.013, -0.017, 0.033), (0.011, 0.007, 0.3)]
    away = look_at(np.array([0.3, 0.0, 0.05]), np.array([0.6, 0.0, 0.05]))
    return [look_at(np.array(eye), np.array([0.004, 0.003, 0.041])) for eye in eyes] + [away]


@pytest.mark.parametrize("gain", GAINS)
def test_same_as_rays_in_plain_python(gain):
    """Every gain, from every side: the sum of the brute-force loop."""
    for seed in range(3):
        voxel_map = random_grid(seed)
        found = view_information(voxel_map, SENSOR, poses_around(), gain)
        expected = [plain_information(voxel_map, SENSOR, pose, gain) for pose in poses_around()]
        np.testing.assert_allclose(found, expected, rtol=EXACT, atol=1e-12)
        assert np.all(found[:4] > 0)
        assert found[4] == 0.0


@pytest.mark.parametrize("gain", GAINS)
def test_region_cuts_the_rays(gain):
    """Within a box the rays see its voxels alone: those of the brute-force loop between the same indices."""
    voxel_map = random_grid(3)
    region = axis_aligned_box(np.array([-0.021, -0.012, 0.018]), np.array([0.032, 0.04, 0.052]))
    # Voxel i of the grid spans (i + first -+ 0.5) SIZE: x from -2.1 to 3.2 voxels lies in voxels -2..3, indices 3..8.
    indices = ((3, 3, 2), (9, 9, 6))
    found = view_information(voxel_map, SENSOR, poses_around(), gain, region)
    expected = [plain_information(voxel_map, SENSOR, pose, gain, indices) for pose in poses_around()]
    np.testing.assert_allclose(found, expected, rtol=EXACT, atol=1e-12)
    assert np.any(found < view_information(voxel_map, SENSOR, poses_around(), gain))


def test_region_beside_the_map_is_cut_to_it():
    """A box that leaves the map does no harm, however far."""
    far = axis_aligned_box(np.array([-9.0, -9.0, -9.0]), np.array([9.0, 9.0, 9.0]))
    beside = axis_aligned_box(np.array([8.0, 8.0, 8.0]), np.array([9.0, 9.0, 9.0]))
    voxel_map = random_grid(4)
    whole = view_information(voxel_map, SENSOR, poses_around())
    np.testing.assert_array_equal(view_information(voxel_map, SENSOR, poses_around(), region=far), whole)
    assert np.all(np.isfinite(view_information(voxel_map, SENSOR, poses_around(), region=beside)))


@pytest.mark.parametrize(("axis", "length"), [(0, 12), (1, 10), (2, 8)])
@pytest.mark.parametrize("backwards", [False, True])
def test_ray_along_an_axis_in_a_uniform_map(axis, length, backwards):
    """n equal voxels of occupancy P: H (1 - (1 - P)^n) / P, a geometric series; two components of the ray are 0."""
    log_odds = -0.8
    p = 1.0 / (1.0 + np.exp(0.8))
    entropy = -p * np.log(p) - (1 - p) * np.log(1 - p)
    direction = np.eye(3)[axis] * (-1.0 if backwards else 1.0)
    eye = np.array([0.001, 0.002, 0.034]) - direction
    pose = RigidTransform.from_components(eye, Rotation.align_vectors([direction], [[0.0, 0.0, 1.0]])[0])
    pose = RigidTransform.from_components(eye, Rotation.from_matrix(np.round(pose.rotation.as_matrix())))
    found = view_information(grid(np.full((12, 10, 8), log_odds)), ONE_RAY, [pose], "occlusion_aware")
    np.testing.assert_allclose(found, entropy * (1 - (1 - p) ** length) / p, rtol=1e-6)  # log-odds are float32


def test_parallel_ray_beside_the_map_sees_nothing():
    """It runs along z, 1 cm off the map's side, and never enters it."""
    beside = RigidTransform.from_translation([0.075, 0.0, -1.0])
    assert view_information(random_grid(0), ONE_RAY, [beside])[0] == 0.0


def test_gains_on_a_worked_ray():
    """Along x: free (l = -1), untouched, occupied (l = 2), untouched, untouched."""
    log_odds = np.zeros((5, 1, 1))
    log_odds[:, 0, 0] = [-1.0, 0.0, 2.0, 0.0, 0.0]
    p = 1.0 / (1.0 + np.exp([1.0, 0.0, -2.0, 0.0, 0.0]))
    h = -p * np.log(p) - (1 - p) * np.log(1 - p)
    reach = np.cumprod([1.0, *(1 - p[:-1])])
    expected = {
        "observable": np.log(2),
        "occlusion_aware": np.sum(h * reach),
        "unobserved": np.log(2) * (reach[1] + reach[3] + reach[4]),
        "entropy": h[:3].sum(),
        "rear_side": 1.0,
    }
    voxel_map = VoxelMap(np.zeros(3, np.int64), 1.0, log_odds.astype(np.float32))
    pose = look_at(np.array([-3.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]))
    for gain in GAINS:
        np.testing.assert_allclose(view_information(voxel_map, ONE_RAY, [pose], gain)[0], expected[gain], rtol=1e-7)


def test_free_space_promises_more_than_the_unknown():
    """In a long ray the series tends to H / P: 1.39 nat in the unknown, 3.06 nat in space that is free to the clamp."""
    p = 0.12
    free, unknown = np.full((400, 1, 1), np.log(p / (1 - p))), np.zeros((400, 1, 1))
    pose = look_at(np.array([-9.0, -0.04, 0.0]), np.array([1.0, -0.04, 0.0]))
    found = [view_information(grid(values), ONE_RAY, [pose], "occlusion_aware")[0] for values in (free, unknown)]
    entropy = -p * np.log(p) - (1 - p) * np.log(1 - p)
    np.testing.assert_allclose(found, [entropy / p, 2 * np.log(2)], rtol=1e-6)


def test_rays_look_through_free_space_and_into_the_unknown_as_deep_as_they_may():
    """Observable: free voxels cost and bring nothing, however many; of unknown ones each keeps the same share, so that
    a long row of them is worth ln 2 over that share; behind a surface nothing is worth anything."""
    free, hit = np.log(0.12 / 0.88), np.log(0.97 / 0.03)
    pose = look_at(np.array([-9.0, -0.04, 0.0]), np.array([1.0, -0.04, 0.0]))

    def row(*values: float) -> float:
        return view_information(grid(np.array(values).reshape(-1, 1, 1)), ONE_RAY, [pose])[0]

    assert row(*[free] * 30, 0.0, hit, 0.0) == pytest.approx(np.log(2))
    assert row(0.0, hit, 0.0) == pytest.approx(np.log(2))
    assert row(0.0, *[free] * 5, 0.0) == pytest.approx(np.log(2) * (2 - MEETING))
    assert row(*[0.0] * 400) == pytest.approx(np.log(2) / MEETING, rel=1e-6)
    assert row(hit, 0.0, 0.0) == row(free, free) == 0.0


def test_a_voxel_whose_hits_and_misses_cancel_is_as_unknown_as_an_untouched_one():
    """To the observable gain; what tells them apart for other gains does not make it free."""
    untouched = grid(np.zeros((6, 1, 1)))
    pose = look_at(np.array([-9.0, -0.04, 0.0]), np.array([1.0, -0.04, 0.0]))
    cancelled = replace(untouched, cancelled=np.ones((6, 1, 1), bool))
    found = [view_information(known, ONE_RAY, [pose])[0] for known in (untouched, cancelled)]
    assert found[0] == pytest.approx(found[1])
    assert found[0] == pytest.approx(np.log(2) * (1 - (1 - MEETING) ** 6) / MEETING)


def test_a_hit_that_does_not_make_a_voxel_occupied_ends_no_ray():
    """Where the map asks for more than one hit, a voxel with one is uncertain: it is worth its entropy, and what lies
    behind it 1 - MEETING of that of an untouched one. Two hits end the ray."""
    hit = np.log(0.7 / 0.3)
    pose = look_at(np.array([-9.0, -0.04, 0.0]), np.array([1.0, -0.04, 0.0]))
    entropy = -0.7 * np.log(0.7) - 0.3 * np.log(0.3)
    for n_hits, expected in ((1, entropy + (1 - MEETING) * np.log(2)), (2, 0.0)):
        strict = replace(grid(np.array([n_hits * hit, 0.0]).reshape(-1, 1, 1)), threshold=float(hit))
        assert view_information(strict, ONE_RAY, [pose])[0] == pytest.approx(expected, rel=1e-6)


def test_unknown_gain_is_refused():
    """The message lists those that there are."""
    with pytest.raises(ValueError, match="choose observable, occlusion_aware"):
        view_information(random_grid(0), SENSOR, poses_around(), "curiosity")  # type: ignore[arg-type]


@pytest.mark.parametrize("planner", [ray_entropy(), ray_entropy("unobserved", within_object=True), random_views()])
def test_runs_in_the_loop_without_ellipsoids(analytic_camera, free_arm, planner):
    """Twice the same views for one seed; no ellipsoids, no recoveries; utilities are those of the map before."""
    parameters = Parameters(n_frames=1, max_iterations=3)

    def views():
        camera = analytic_camera((((-0.04, -0.03, 0.0), (0.04, 0.03, 0.06)),))
        return reconstruct(camera, free_arm(), planner, parameters, seed=5).acquisitions

    first, second = views(), views()
    assert [a.kind for a in first] == ["first", "nbv", "nbv", "nbv"]
    for a, b in zip(first, second, strict=True):
        np.testing.assert_array_equal(a.burst.T_world_cam.as_matrix(), b.burst.T_world_cam.as_matrix())
        assert len(a.model.ellipsoids) == 0
    if planner.name == "re":
        chosen, model = first[2], first[1].model
        again = planner.score(model, chosen.burst.intrinsics, [chosen.burst.T_world_cam], parameters)
        assert chosen.utility == pytest.approx(again[0])
