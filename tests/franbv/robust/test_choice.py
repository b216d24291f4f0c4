"""What is left to be measured, with what chance from where, and the loop on a box with a mirroring side."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at, rolled
from franbv.known_planners import PLANNERS
from franbv.model import model_of
from franbv.parameters import Parameters
from franbv.planners import pb
from franbv.reconstruction import reconstruct
from franbv.robust.choice import face_on, gain_per_second
from franbv.robust.evidence import integrate_robustly, with_scans
from franbv.robust.hypothesis import hypothesis, missing_share, still_supposed, success_chances
from franbv.robust.planner import fra_robust
from franbv.robust.settings import RobustSettings
from franbv.voxel_map import VoxelMap, empty_map
from tests.franbv.analytic_camera import SENSOR, AnalyticCamera, FreeArm
from tests.franbv.robust.mirror_camera import BOX, ROOM, MirrorCamera

PARAMETERS, SETTINGS = Parameters(n_frames=1, max_iterations=9), RobustSettings()


def model_after(camera: AnalyticCamera, eyes: list[tuple[float, float, float]], roll: float = 0.0):
    """The model of these views of the box's middle."""
    voxel_map: VoxelMap = empty_map(PARAMETERS)
    for eye in eyes:
        burst = camera.capture(rolled(look_at(np.array(eye), np.array([0, 0, 0.04])), roll), 1)
        voxel_map = integrate_robustly(voxel_map, burst, PARAMETERS, SETTINGS)
    return model_of(voxel_map, fra_robust(), PARAMETERS, np.random.SeedSequence(0))


AROUND = [(0.3, 0.0, 0.2), (-0.3, 0.0, 0.2), (0.0, 0.3, 0.2), (0.0, -0.3, 0.2), (0.1, 0.0, 0.4)]


def test_nothing_is_left_of_a_box_that_was_seen():
    """Five views of a plain box leave little of its surface, one view the sides that it did not see."""
    box = AnalyticCamera((BOX,), room=ROOM)
    models = [model_after(box, AROUND), model_after(box, AROUND[:1])]
    seen, once = (hypothesis(model, PARAMETERS, SETTINGS) for model in models)
    surface = 2 * 0.08 * (0.1 + 0.08) + 0.1 * 0.08
    assert (seen.areas * seen.left) @ seen.unfound < 0.1 * surface
    assert seen.surface_area == pytest.approx(surface, rel=0.6)
    assert missing_share(models[0], seen, SETTINGS) < 0.5 * missing_share(models[1], once, SETTINGS)
    assert once.areas @ (once.unfound & (once.normals[:, 0] < -0.7)) > 0.3 * 0.08 * 0.08
    assert np.all(once.normals[:, 2] > -0.6)


def test_a_notch_is_refuted_by_what_is_seen_through_it():
    """The hull of an L spans air; views onto its legs say so."""
    legs = (((-0.06, -0.04, 0.0), (0.06, 0.04, 0.02)), ((-0.06, -0.04, 0.0), (-0.04, 0.04, 0.1)))
    eyes = [
        (0.3, 0.0, 0.25),
        (0.25, 0.15, 0.3),
        (0.25, -0.15, 0.3),
        (0.0, 0.3, 0.2),
        (0.0, -0.3, 0.2),
        (-0.3, 0.0, 0.2),
    ]
    model = model_after(AnalyticCamera(legs, room=ROOM), eyes)
    left = hypothesis(model, PARAMETERS, SETTINGS)
    spanning = (left.normals[:, 0] > 0.3) & (left.normals[:, 2] > 0.3)
    assert (left.areas * left.left) @ (left.unfound & spanning) < 0.5 * 0.08 * np.hypot(0.1, 0.08)


def test_a_mirror_is_left_and_looked_at_face_on():
    """The side that views looked through is what is left, and a pose looks along its normal."""
    eyes = [*AROUND[:2], *AROUND[3:], (0.25, 0.25, 0.2), (-0.25, 0.25, 0.2)]
    left = hypothesis(model_after(MirrorCamera(), eyes), PARAMETERS, SETTINGS)
    towards_mirror = left.unfound & (left.normals[:, 1] > 0.9)
    assert left.areas @ (left.unfound & towards_mirror) > 0.5 * 0.1 * 0.08
    assert left.looks[towards_mirror].sum() > 0
    axes = np.array([pose.rotation.as_matrix()[:, 2] for pose in face_on(left, PARAMETERS)])
    assert axes[:, 1].min() < -np.cos(np.radians(15))


def test_chances_by_hand():
    """Beta(1, 1), 40 pixels of success and 20 of failure are two trials and one; half of those in vain count."""
    grid, nothing = with_scans(empty_map(PARAMETERS)), np.zeros((2, 5))
    assert np.all(success_chances(grid, nothing, SETTINGS) == 0.5)
    successes, failures, in_vain = np.zeros((3, 2, 5))
    successes[1, 2], failures[1, 2], in_vain[1, 2] = 40.0, 20.0, 80.0
    counted = replace(grid, successes=successes, failures=failures)
    assert success_chances(counted, nothing, SETTINGS)[1, 2] == pytest.approx(3 / 5)
    assert success_chances(counted, nothing, SETTINGS)[0, 2] == 0.5
    assert success_chances(counted, in_vain, SETTINGS)[1, 2] == pytest.approx(3 / 7)


def test_what_sure_views_miss_is_not_there():
    """By hand at even odds and three mirrors in ten: two misses of views that succeed with 3 in 4 leave a mirror or one
    in 16, face on the mirror's share goes alike, and views that never succeed say nothing."""
    looks, chances = np.zeros((4, 2, 5)), np.zeros((2, 5))
    chances[0, :2] = 0.75
    looks[1, 0, 1] = looks[2, 0, 0] = 2.0
    looks[3, 1, 3] = 9.0
    oblique = 0.3 + 0.7 / 16
    np.testing.assert_allclose(still_supposed(looks, chances, SETTINGS), [0.5, oblique / (oblique + 1), 1 / 17, 0.5])


def test_a_turn_that_failed_is_worth_less():
    """The same pose, on end as it failed, or level as nobody has tried; and a far one costs time."""
    eyes = [*AROUND[:2], (0.0, -0.3, 0.2), (0.0, 0.29, 0.15), (0.02, 0.29, 0.15), (-0.02, 0.29, 0.15)]
    model = model_after(MirrorCamera(right_deg=(80.0, 0.0)), eyes, roll=90.0)
    left = hypothesis(model, PARAMETERS, SETTINGS)
    level = look_at(np.array([0.0, 0.3, 0.15]), np.array([0, 0, 0.04]))
    gains = gain_per_second(model, left, SENSOR, [level, rolled(level, 90.0)], SETTINGS)
    assert gains[0] > gains[1] > 0
    away = RigidTransform.from_translation([0.0, 5.0, 0.0]) * level
    assert gain_per_second(model, left, SENSOR, [away], SETTINGS)[0] < gains[0] / 5


def held_of_the_mirror(run) -> float:
    """Share of points of the mirroring side that have an occupied voxel within a voxel."""
    x, z = np.meshgrid(np.linspace(-0.045, 0.045, 13), np.linspace(0.012, 0.075, 9))
    final = run.acquisitions[-1].model.voxel_map
    held = np.zeros(x.size, bool)
    for dy in (-final.voxel_size, 0.0):
        points = np.stack([x.ravel(), np.full(x.size, BOX[1][1] + dy), z.ravel()], axis=1)
        held |= final.lookup(final.occupied, points)
    return float(held.mean())


def test_it_measures_a_mirror_that_the_camera_fails_on_as_it_is_mounted():
    """On end the side is seen through from everywhere, level it is right up to 30 deg: it is found, and PB's is not."""
    parameters = PARAMETERS.model_copy(update={"roll_deg": 90.0})
    runs = {
        name: reconstruct(MirrorCamera(right_deg=(30.0, 0.0)), FreeArm(), build(), parameters, seed=1)
        for name, build in (("fra-robust", PLANNERS["fra-robust"].build), ("pb", pb))
    }
    assert held_of_the_mirror(runs["fra-robust"]) > 0.8
    assert held_of_the_mirror(runs["pb"]) < 0.3
    believed = [acquisition.missing for acquisition in runs["fra-robust"].acquisitions]
    assert 0.0 <= believed[-1] < 0.2 < believed[0] <= 1.0
    assert {acquisition.missing for acquisition in runs["pb"].acquisitions} == {None}
    again = reconstruct(MirrorCamera(right_deg=(30.0, 0.0)), FreeArm(), fra_robust(), parameters, seed=1)
    for one, other in zip(runs["fra-robust"].acquisitions, again.acquisitions, strict=True):
        np.testing.assert_array_equal(one.burst.T_world_cam.as_matrix(), other.burst.T_world_cam.as_matrix())
