"""What imagers see of a scene: exact depths of tilted plates, and highlights where mirror geometry puts them."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at
from materials.catalog import material
from materials.material import Matte, RoughPlastic
from render.imager.surface_speckle import coherent_share, surface_height
from render.world.mitsuba_scene import load_scene
from render.world.rig import d435i_rig
from render.world.seen_surfaces import glossy_part, seen_surfaces
from render.world.surface import surface_map
from scenes.build import coupon_scene

POSE = look_at(np.array([0.0, -0.02, 0.35]), np.array([0.0, 0.02, 0.0]))
"""So that the plate mirrors the projector."""


def seen_plate(made_of):
    """A level plate on its table, its pixels, and the projector's place."""
    scene, rig = coupon_scene("plate", made_of), d435i_rig()
    surface = surface_map(load_scene(scene), rig.intrinsics, POSE)
    projector = rig.projector(POSE).translation
    seen = seen_surfaces(surface, [body.material for body in scene.bodies], POSE, projector)
    plate = np.isin(surface.body, [i for i, body in enumerate(scene.bodies) if body.is_part])
    return seen, surface, plate, projector, rig


def test_depth_is_that_along_the_optical_axis():
    """Every point lies where the intrinsics put its pixel at one over the inverse depth."""
    seen, surface, plate, _, rig = seen_plate(material("iron:polished"))
    v, u = np.nonzero(plate)
    z, k = 1 / seen.inverse_depth[v, u].astype(float), rig.intrinsics
    points = POSE.apply(np.stack([(u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z], axis=1))
    np.testing.assert_allclose(points, surface.position[v, u], atol=2e-6)


@pytest.mark.parametrize("finish", ["mirror", "polished"])
def test_the_highlight_is_where_the_mirror_shows_the_projector(finish):
    """The brightest coherent pixel of the level plate is where the line from the eye to the projector's mirror image
    meets it, and its share there the coherent one of the finish; the table has none."""
    made_of = material(f"iron:{finish}")
    seen, surface, plate, projector, _ = seen_plate(made_of)
    height = np.median(surface.position[plate][:, 2])
    image = projector * [1, 1, -1] + [0, 0, 2 * height]
    eye = POSE.translation
    meets = eye + (image - eye) * (eye[2] - height) / (eye[2] - image[2])
    brightest = surface.position[np.unravel_index(np.argmax(seen.specular_share), seen.specular_share.shape)]
    assert np.linalg.norm(brightest - meets) < 2e-3
    cosine = (eye[2] - height) / np.linalg.norm(eye - meets)
    kept = coherent_share(surface_height(np.array([made_of.alpha_v])), np.array([cosine]))[0]
    assert seen.specular_share.max() == pytest.approx(float(kept), rel=0.02)
    assert not seen.specular_share[~plate].any()


def test_rough_surfaces_send_nothing_coherently():
    """Blasted metal, matte paint, measured and oxidised surfaces speckle fully."""
    for name in ("iron:blasted", "iron:brushed", "iron:oxidised"):
        assert glossy_part(material(name))[1] == 0
    assert glossy_part(Matte("wall", 0.5))[1] == 0


def test_a_coat_shares_the_light_with_its_base():
    """In a smooth coat's highlight over a black base all light is the coat's; the rougher the coat, the more is the
    base's: at alpha 0.05 over white 0.04 / (4 x 0.0025) = 4 stand beside the base's 0.6 or so."""
    assert glossy_part(RoughPlastic("black", 1.5, 0.02, 0.0))[1] == pytest.approx(1)
    share = glossy_part(RoughPlastic("white", 1.5, 0.05, 0.8))[1]
    assert share == pytest.approx(4 / (4 + 0.6), abs=0.05)


def test_nothing_is_infinitely_far():
    """Where a ray leaves the scene the inverse depth is 0."""
    away = RigidTransform.from_components(POSE.translation, look_at(np.zeros(3), np.array([0, 0, 1.0])).rotation)
    scene, rig = coupon_scene("plate", material("iron:polished")), d435i_rig()
    surface = surface_map(load_scene(scene), rig.intrinsics, away)
    seen = seen_surfaces(surface, [b.material for b in scene.bodies], away, rig.projector(away).translation)
    nothing = surface.body == 255
    assert np.all(seen.inverse_depth[nothing] == 0)
    assert np.all(seen.inverse_depth[~nothing] > 0)
