"""Holes of a box whose sides are measured from aslant, or are not: what is a mirror's and what is not."""

from dataclasses import replace

import numpy as np
import pytest

from franbv.frames import look_at
from franbv.model import Model, model_of
from franbv.parameters import Parameters
from franbv.robust.dull_surface import measured_aslant, of_dull_surface
from franbv.robust.evidence import integrate_robustly
from franbv.robust.planner import fra_robust
from franbv.robust.regions import RobustDetection, detect_robustly
from franbv.robust.settings import RobustSettings
from franbv.sensing import DepthBurst
from franbv.voxel_map import VoxelMap, empty_map
from tests.franbv.analytic_camera import AnalyticCamera
from tests.franbv.robust.mirror_camera import BOX, ROOM, MirrorCamera

PARAMETERS, SETTINGS = Parameters(n_frames=3), RobustSettings()
NEVER_DULL = SETTINGS.model_copy(update={"dull": 1.0})
SIDE = np.array([0.0, BOX[1][1], 0.04])
"""Middle of the side towards +y, which mirrors if any does."""
MIN_Z = AnalyticCamera.min_z
AROUND = [(0.3, 0.0, 0.2), (-0.3, 0.0, 0.2), (0.0, -0.3, 0.2), (0.1, 0.0, 0.4)]
SQUARE_ON = (0.0, 0.34, 0.06)


def at_incidence(degrees: float, distance: float = 0.3) -> np.ndarray:
    """An eye level with the middle of the side that sees it at this angle."""
    angle = np.radians(degrees)
    return SIDE + distance * np.array([np.sin(angle), np.cos(angle), 0.0])


def model_after(camera: AnalyticCamera, eyes: list, last: DepthBurst) -> Model:
    """The model of these views of the side and of a last burst."""
    voxel_map: VoxelMap = empty_map(PARAMETERS)
    bursts = [camera.capture(look_at(np.array(eye), SIDE), 3) for eye in eyes]
    for burst in (*bursts, last):
        voxel_map = integrate_robustly(voxel_map, burst, PARAMETERS, SETTINGS)
    return model_of(voxel_map, fra_robust(), PARAMETERS, np.random.SeedSequence(0))


def with_hole(camera: AnalyticCamera, radius: float = 0.018) -> tuple[DepthBurst, np.ndarray]:
    """A burst square on in which a disc about the middle of the side is missing, and the disc's pixels."""
    burst = camera.capture(look_at(np.array(SQUARE_ON), SIDE), 3)
    rays = burst.T_world_cam.rotation.apply(burst.intrinsics.pixel_directions().reshape(-1, 3))
    eye = burst.T_world_cam.translation
    points = eye + ((SIDE[1] - eye[1]) / rays[:, 1])[:, None] * rays
    disc = (np.linalg.norm(points - SIDE, axis=1) < radius).reshape(burst.depths.shape[1:])
    return replace(burst, depths=np.where(disc, 0, burst.depths).astype(np.float32)), disc


def named(
    camera: AnalyticCamera, eyes: list, settings: RobustSettings = SETTINGS
) -> tuple[RobustDetection, np.ndarray]:
    """What a hole square on is called after these views."""
    last, disc = with_hole(camera)
    return detect_robustly(last, model_after(camera, [*AROUND, *eyes], last), PARAMETERS, MIN_Z, settings), disc


def test_a_hole_in_a_side_that_is_measured_from_aslant_is_none_of_reflection():
    """Square on a highlight may drown a matte side, which was measured at 50 deg from both sides before. That is what
    keeps it from being named: with the rule off it is."""
    matte, eyes = AnalyticCamera((BOX,), room=ROOM), [at_incidence(50.0), at_incidence(-50.0)]
    found, disc = named(matte, eyes)
    assert disc.sum() > 10
    assert not found.candidates.any()
    assert np.isnan(found.places).all()
    off, _ = named(matte, eyes, NEVER_DULL)
    assert off.holes[disc].all()


def test_a_hole_in_a_side_that_mirrors_from_aslant_is_one_of_reflection():
    """The same side measured face on, to 15 deg, and passed at 50 deg: the rest of the box is matte."""
    mirror = MirrorCamera(room=ROOM)
    found, disc = named(mirror, [at_incidence(0.0), at_incidence(8.0), at_incidence(50.0), at_incidence(-50.0)])
    assert found.holes[disc].all()
    assert np.nanmax(np.abs(found.places[disc][:, 1] - SIDE[1])) < PARAMETERS.voxel_size


def test_surface_alike_is_expected_to_do_as_the_run_does():
    """A side that was measured square on alone is expected to be measured from aslant as the other sides are."""
    eyes = [(0.3, 0.25, 0.06), (-0.3, 0.25, 0.06), (0.0, 0.34, 0.1)]
    found, _ = named(AnalyticCamera((BOX,), room=ROOM), eyes)
    assert not found.holes.any()


@pytest.mark.parametrize("n", [1, 2, 3])
def test_the_share_from_aslant_by_closed_form(n):
    """n views measured a place that they saw from 55 deg by its normal: beside one success to `mirror_trials` failures,
    which weighs `alike_trials`, n successes; by a normal from which they are not aslant that prior alone. Surface alike
    counts for nothing where a trial takes a billion pixels."""
    settings = SETTINGS.model_copy(update={"pixels_per_trial": 1e9})
    camera = AnalyticCamera((BOX,), room=ROOM)
    last, _ = with_hole(camera)
    model = model_after(camera, [at_incidence(35.0, 0.3 + 0.01 * k) for k in range(n)], last)
    prior = SETTINGS.alike_trials / (1.0 + SETTINGS.mirror_trials)
    for tilt, trials in ((45.0, n), (-45.0, n), (60.0, 0)):
        normal = np.array([[0.0, np.cos(np.radians(tilt)), -np.sin(np.radians(tilt))]])
        angle = np.degrees(np.arccos(np.cos(np.radians(35.0)) * np.cos(np.radians(tilt))))
        assert (45 < angle < 60) == (trials > 0)
        expected = (prior + trials) / (SETTINGS.alike_trials + trials)
        assert measured_aslant(model, SIDE[None], normal, settings) == pytest.approx([expected])


def test_regions_are_dull_as_a_whole():
    """Of two regions the one with shares of 0.4 and 0.9 is dull, that with 0.2 and 0.7 is not; no pixels, none."""
    pixels = np.zeros((3, 5), bool)
    pixels[0, :2] = pixels[2, 3:] = True
    dull = of_dull_surface(pixels, np.array([0.4, 0.9, 0.2, 0.7]), SETTINGS)
    assert dull[0, :2].all()
    assert dull.sum() == 2
    assert not of_dull_surface(np.zeros((3, 5), bool), np.zeros(0), SETTINGS).any()


def test_what_lies_nearer_than_the_camera_measures_is_no_hole():
    """From 10 cm a side gives no depth to a camera that begins at 12.8 cm, whatever it is; to one that should measure
    there the same is a hole."""
    camera = AnalyticCamera((BOX,), room=ROOM)
    last = camera.capture(look_at(np.array([0.0, 0.14, 0.05]), SIDE), 3)
    model = model_after(camera, [*AROUND, (0.0, 0.3, 0.1), (0.1, 0.3, 0.1)], last)
    assert not detect_robustly(last, model, PARAMETERS, MIN_Z, NEVER_DULL).candidates.any()
    assert detect_robustly(last, model, PARAMETERS, 0.05, NEVER_DULL).holes.sum() > 20


def test_a_hole_that_begins_where_the_camera_ends_is_too_near():
    """The map knows the box, and before it stands something that slants towards the camera, past its least depth: the
    hole borders on depth of hardly more than that, and is one of reflection where that does not count."""
    known, real = (AnalyticCamera(boxes, room=ROOM) for boxes in ((BOX,), (BOX, ((-0.3, 0.04, 0.0), (0.3, 0.23, 0.3)))))
    last = real.capture(look_at(np.array([0.25, 0.32, 0.05]), SIDE), 3)
    model = model_after(known, [*AROUND, (0.0, 0.3, 0.1)], last)
    alone = NEVER_DULL.model_copy(update={"bordering": 10_000})
    assert detect_robustly(last, model, PARAMETERS, MIN_Z, alone).holes.any()
    assert not detect_robustly(last, model, PARAMETERS, MIN_Z, NEVER_DULL).holes.any()
