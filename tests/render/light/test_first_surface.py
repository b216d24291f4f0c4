"""What an imager meets first is traced once for all scenes of one geometry, and only for those."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at
from materials.catalog import material
from materials.lights import Band
from render.d435i import SensorSettings, SimulatedD435i
from render.labels.twin import twin_scene
from render.light.sampling import Sampling
from scenes.build import coupon_scene
from scenes.scene import Mesh

POSE = look_at(np.array([0.25, -0.15, 0.35]), np.array([0.0, 0.0, 0.03]))
ELSEWHERE = look_at(np.array([-0.2, -0.2, 0.3]), np.array([0.0, 0.0, 0.03]))
FEW = Sampling(glossy_paths=4, refined_share=0.0, indirect_directions=16)
SETTINGS = SensorSettings(profile="424x240", crop=None)


@pytest.fixture(scope="module")
def scene():
    """A steel ball on the table."""
    return coupon_scene("ball", material("stainless_austenitic:bright"), "workshop")


def raised(scene):
    """The same scene a centimetre higher."""
    bodies = (replace(b, mesh=Mesh(b.mesh.vertices + np.array([0, 0, 0.01]), b.mesh.faces)) for b in scene.bodies)
    return replace(scene, bodies=tuple(bodies))


def brighter(scene):
    """The same bodies under lamps of twice the radiance."""
    return replace(scene, lamps=tuple(replace(lamp, radiance=2 * lamp.radiance) for lamp in scene.lamps))


def images(camera, pose: RigidTransform):
    """All layers and the true depth."""
    return [image for side in camera.render(pose) for image in (side.projector, side.ambient)] + [
        camera.truth(pose).depth
    ]


@pytest.mark.parametrize(("other", "shared"), [(twin_scene, True), (raised, False), (brighter, False)])
def test_changed_camera_sees_what_a_new_one_sees(scene, other, shared):
    """Before its twin, before moved bodies and under other lamps a camera that has looked from this pose already gives
    the very images of one that has seen nothing yet."""
    camera = SimulatedD435i(scene, SETTINGS, sampling=FEW)
    before = images(camera, POSE)
    changed = camera.changed(scene=other(scene))
    assert (changed.view(POSE) is camera.view(POSE)) == shared
    seen = images(changed, POSE)
    for image, own in zip(seen, images(SimulatedD435i(other(scene), SETTINGS, sampling=FEW), POSE), strict=True):
        np.testing.assert_array_equal(image, own)
    assert not all(np.array_equal(a, b) for a, b in zip(before, seen, strict=True))


def test_another_pose_is_seen_anew(scene):
    """A camera that moves there and back gives the images of one that stood there first."""
    camera = SimulatedD435i(scene, SETTINGS, sampling=FEW)
    first = images(camera, POSE)
    images(camera, ELSEWHERE)
    for image, again in zip(first, images(camera, POSE), strict=True):
        assert np.array_equal(image, again)


def test_geometry_is_more_than_its_shape(scene):
    """The same meshes in another order are another geometry, since bodies are known by their number."""
    assert scene.has_geometry_of(twin_scene(scene))
    assert not scene.has_geometry_of(replace(scene, bodies=scene.bodies[::-1]))
    assert not scene.has_geometry_of(replace(scene, bodies=scene.bodies[:-1]))
    assert not scene.has_geometry_of(replace(scene, lamps=scene.lamps[:-1]))
    assert not scene.has_geometry_of(replace(scene, ambient_radiance=scene.ambient_radiance + 1.0))
    assert not scene.has_geometry_of(replace(scene, lamp_band=Band.HALOGEN))
