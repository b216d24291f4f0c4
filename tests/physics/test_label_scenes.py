"""Every cause of a hole, in a scene made for it: the label says so on 99 % of the pixels meant."""

import numpy as np
import pytest

from materials.catalog import material, matte_twin
from materials.material import Matte
from render.d435i import SensorSettings, SimulatedD435i
from render.labels.causes import Cause, is_hole, is_of
from render.labels.labels import label_frame
from render.labels.twin import measure_twin, twin_camera, twin_scene
from render.world.truth import looks_at_part
from scenes.build import part_scene
from tests.physics import label_scenes as scenes
from tests.physics.simple_scenes import facing_x

MEANT_SHARE = 0.99
"""Share of the meant pixels without depth that must have the cause."""

SCENES = [
    # scene, cause, least share of the meant pixels that must be without depth for the scene to show anything
    (scenes.too_near, Cause.OUT_OF_RANGE, 0.9),
    (scenes.nothing_there, Cause.OUT_OF_RANGE, 0.8),
    (scenes.without_dots, Cause.OUT_OF_REACH, 0.2),
    (scenes.in_darkness, Cause.OUT_OF_REACH, 0.9),
    (scenes.left_band, Cause.NO_OVERLAP, 0.9),
    (scenes.half_hidden, Cause.OCCLUSION, 0.9),
    (scenes.steep_plate, Cause.OCCLUSION_WINDOW, 0.2),
    (scenes.before_the_projector, Cause.PROJECTOR_SHADOW, 0.5),
    (scenes.over_exposed, Cause.OVER_EXPOSED, 0.9),
    (scenes.dark_mirror, Cause.REFLECTION_DARK, 0.2),
    (scenes.mirrored_lamp, Cause.REFLECTION_SATURATED, 0.2),
    (scenes.twisted_mirror, Cause.REFLECTION_DISAGREEING, 0.2),
    (scenes.lit_by_a_screen, Cause.REFLECTION_INTERREFLECTION, 0.2),
]


@pytest.mark.parametrize(("scene", "cause", "least"), SCENES, ids=[scene.__name__ for scene, _, _ in SCENES])
def test_scene_made_for_a_cause_is_labelled_with_it(scene, cause, least):
    """Which pixels are meant, and why, follows from the geometry that each scene's docstring states; the label must
    name that cause wherever the matcher gives no depth there. What it fills in all the same needs no cause."""
    case = scene()
    lost = case.meant & case.invalid
    assert lost.sum() >= least * case.meant.sum() > 0
    assert np.mean(case.labels.cause[lost] == cause) >= MEANT_SHARE


def test_matte_scene_has_no_reflection():
    """A matte surface is its own twin, so the twin of a matte scene is measured with the very same images: nothing can
    come back in it, and no depth is false by reflection."""
    scene = part_scene("D1", room=False).with_materials(lambda body: matte_twin(body.material))
    camera = SimulatedD435i(scene, SensorSettings(profile="424x240", crop=None))
    pose = scenes.looking_at_the_table(40.0)
    labels = label_frame(camera, pose, camera.measure(pose, 3))
    assert np.count_nonzero(is_of(labels.cause, "occlusion")) > 100
    assert not is_of(labels.cause, "reflection").any()
    assert not is_of(labels.cause_decimated, "reflection").any()
    assert not labels.false_by_reflection.any()


def test_twin_depends_on_geometry_alone():
    """The twin of a part is the same whatever the part is made of, so one serves all metals."""
    pose = scenes.looking_at_the_table(40.0)
    twins = []
    for metal in ("stainless_austenitic:polished", "aluminium:blasted"):
        scene = part_scene("C1", room=False).with_materials(lambda b, m=metal: material(m) if b.is_part else b.material)
        twins.append(measure_twin(SimulatedD435i(scene, scenes.WHOLE), pose, 1))
    for name in ("invalid", "is_false", "invalid_decimated", "false_decimated"):
        assert np.array_equal(getattr(twins[0].outcome, name), getattr(twins[1].outcome, name))
    assert np.array_equal(twins[0].lost_to_shadow, twins[1].lost_to_shadow)
    assert np.array_equal(twins[0].lost_to_exposure, twins[1].lost_to_exposure)


def test_twin_chooses_its_own_exposure():
    """A mirror that fills the image of a dim room makes the camera expose far longer than matte paint would need: with
    the real frame's exposure the twin would drown and acquit the mirror of any hole, with its own it has depth."""
    plate = scenes.tilted_plate(material("silver:mirror"), 35.0, side=1.0)
    camera = SimulatedD435i(scenes.scene_of(plate, lamps=(scenes.behind_camera(0.5),)), scenes.WHOLE)
    measurement = camera.measure(facing_x(), 1)
    middle = np.zeros((scenes.H, scenes.W), bool)
    middle[60:180, 120:300] = True
    twin = measure_twin(camera, facing_x(), 1)
    assert np.mean(twin.outcome.right[middle]) > 0.95
    drowned = camera.changed(scene=twin_scene(camera.world.source), imager=measurement.imager).measure(facing_x(), 1)
    assert np.mean(drowned.lefts[0][middle] == 255) > 0.9


def test_false_depth_of_a_mirror_is_reflections():
    """A mirror at 45 deg shows a wall; the matcher measures the wall's mirror image and not the mirror, and on a matte
    plate it would have measured the plate."""
    plate = scenes.tilted_plate(material("silver:mirror"), 45.0)
    above = scenes.rectangle([0.35, 0, 0.35], [0.35, 0, 0], 1.5, 1.5)
    board = scenes.Body("board", above, Matte("board", 0.5), False)
    camera = SimulatedD435i(scenes.scene_of(plate, board, scenes.wall_at(0.8)), scenes.WHOLE)
    measurement = camera.measure(facing_x(), 1)
    labels = label_frame(camera, facing_x(), measurement)
    has_depth = scenes.inner(plate) & (measurement.z16[0] > 0)
    wrong = np.abs(measurement.depths[0] - camera.truth(facing_x()).depth) > 0.005
    assert np.count_nonzero(has_depth & wrong) > 200
    assert np.array_equal(labels.false_depth[has_depth], wrong[has_depth])
    assert np.mean(labels.false_by_reflection[has_depth & wrong]) > 0.95


def test_no_hole_is_reflections_where_the_twin_is_wrong():
    """A hole comes back only with *right* depth. Around the edges of a mirror-like part the matte twin often has the
    depth of what lies beside (foreground fattening), which is no proof against the metal: no pixel whose twin is off by
    more than 5 mm and three sigma, found here from its raw frames, may be called reflection. It has a cause all the
    same, and nearly always one that geometry gives. Where the twin is right, every hole of the part that could be
    measured at all is reflection's."""
    steel = material("stainless_austenitic:polished")
    scene = part_scene("C1", room=False).with_materials(lambda body: steel if body.is_part else body.material)
    camera, pose = SimulatedD435i(scene, scenes.WHOLE), scenes.looking_at_the_table(40.0)
    measurement = camera.measure(pose, 1)
    labels = label_frame(camera, pose, measurement)
    true = camera.truth(pose).depth
    of_twin = twin_camera(camera).measure(pose, 1).depths[0]
    sigma = true**2 * 0.1 / camera.rig.focal_baseline
    wrong = (of_twin > 0) & (np.abs(of_twin - true) > np.maximum(0.005, 3 * sigma))
    lost = (measurement.z16[0] == 0) & wrong & (true > 0)
    assert np.count_nonzero(lost) > 100
    assert not is_of(labels.cause[lost], "reflection").any()
    assert np.all(is_hole(labels.cause[lost]))
    assert np.mean(labels.cause[lost] == Cause.UNEXPLAINED) < 0.01
    convicted = (measurement.z16[0] == 0) & (of_twin > 0) & ~wrong & looks_at_part(camera.truth(pose), scene)
    convicted &= ~np.isin(labels.cause, (Cause.OUT_OF_RANGE, Cause.NO_OVERLAP, Cause.OCCLUSION))
    assert np.count_nonzero(convicted) > 100
    assert is_of(labels.cause[convicted], "reflection").all()
