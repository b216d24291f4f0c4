"""Light of Lambertian surfaces that is looked up instead of being computed again."""

import numpy as np
import pytest

from franbv.frames import look_at
from materials.fresnel import conductor_reflectance
from materials.material import Matte, RoughConductor
from render.light.first_surface import FirstSurface
from render.light.pattern import d435_pattern
from render.light.projector import ProjectorLight
from render.light.radiance import render_layers
from render.light.sampling import Sampling
from render.light.smooth import smooth_light
from render.world import backend
from render.world.mitsuba_scene import load_scene
from render.world.rig import d435i_rig
from render.world.scene_geometry import NO_BODY
from render.world.surface import surface_map
from scenes.build import coupon_scene
from scenes.scene import Body, Scene
from tests.physics.simple_scenes import lamp_at, rectangle

RIG = d435i_rig("424x240")
POSE = look_at(np.array([0.25, -0.15, 0.35]), np.array([0.0, 0.0, 0.03]))
ALIKE = 0.06
"""Relative: interpolated light on the wall, and the width of a near-mirror's lobe."""


@pytest.fixture(scope="module")
def light():
    return ProjectorLight.at(RIG.projector(POSE), d435_pattern(), 0.3)


def test_points_are_known_where_the_imager_sees_them_and_nowhere_else(light):
    """Every Lambertian point that an imager sees is known to it with its own value; the same points pushed a centimetre
    along their normal, or called another body's, are unknown."""
    world = load_scene(coupon_scene("ball", Matte("ball", 0.5), "workshop"))
    surface = surface_map(world, RIG.intrinsics, POSE)
    first = FirstSurface(world, light, RIG.intrinsics, POSE)
    smooth = smooth_light(world, first, Sampling(), 0, np.zeros((2, *first.shape), np.float32), None)
    seen, radiance = lamps_at(smooth, surface)
    there = surface.body.ravel() != NO_BODY
    assert np.array_equal(seen, there)
    np.testing.assert_array_equal(radiance[there], smooth.lamps.ravel()[there])
    off = type(surface)(surface.body, surface.position + 0.01 * surface.normal, surface.normal)
    near = np.linalg.norm(surface.position - POSE.translation, axis=-1) < 0.5
    assert not np.any(lamps_at(smooth, off)[0] & near.ravel())
    other = type(surface)((surface.body + 1).astype(np.uint8), surface.position, surface.normal)
    assert not np.any(lamps_at(smooth, other)[0])


def lamps_at(smooth, points):
    """Where the light on the points of another map is known, and there the lamps'."""
    mi = backend.mitsuba()
    position, normal = (mi.Point3f(np.ascontiguousarray(a.reshape(-1, 3).T)) for a in (points.position, points.normal))
    body = mi.UInt32(points.body.ravel().astype(np.uint32))
    seen, there = smooth.at(position, mi.Normal3f(normal), body, mi.Bool(True))
    return seen.numpy().astype(bool), there.lamps.numpy()


def test_metal_mirrors_the_wall_as_bright_as_it_is_seen():
    """A near-mirror of reflectance R0 beside a lit wall shows R0 times the wall's own radiance at the mirrored points
    (law of reflection); both are read from the same image, the wall within it."""
    wall = Body("wall", rectangle([0.0, 0.0, 0.6], [0.0, -1.0, 0.6], 2.0, 2.0), Matte("wall", 0.6), True)
    n, k, alpha = 2.5, 4.0, 0.005
    mirror = Body(
        "mirror",
        rectangle([0.4, -0.4, 0.6], [-1.0, -0.4, 0.6], 0.5, 0.5),
        RoughConductor("m", n, k, alpha, alpha),
        True,
    )
    lamp = lamp_at([-0.8, -1.6, 0.9], [0.0, 0.0, 0.6], 0.4, 40.0)
    scene = Scene("mirror beside a wall", (wall, mirror), (lamp,), 0.0)
    pose = look_at(np.array([-0.5, -1.1, 0.6]), np.array([0.15, -0.2, 0.6]))
    world = load_scene(scene)
    light = ProjectorLight.at(RIG.projector(pose), d435_pattern(), 0.3)
    surface = surface_map(world, RIG.intrinsics, pose)
    image = render_layers(world, light, RIG.intrinsics, pose, Sampling(max_depth=2, closing=False)).ambient
    found, expected, bright = mirrored_wall(surface, image, pose, n, k)
    assert found > 100
    np.testing.assert_allclose(bright, expected, rtol=ALIKE)


def mirrored_wall(surface, image, pose, n, k):
    """How many mirror pixels show a visible place of the wall, what they ought to show, and what they do."""
    intrinsics, shown, ought = RIG.intrinsics, [], []
    for row, column in np.argwhere(surface.body == 1):
        place, normal = surface.position[row, column].astype(float), surface.normal[row, column].astype(float)
        towards = place - pose.translation
        towards /= np.linalg.norm(towards)
        cosine = -towards @ normal
        onwards = towards + 2 * cosine * normal
        if onwards[1] <= 0:
            continue
        wall = place + onwards * (-place[1] / onwards[1])
        local = pose.inv().apply(wall)
        u, v = (intrinsics.fx * local[:2] / local[2] + [intrinsics.cx, intrinsics.cy]).round().astype(int)
        if (
            not (2 <= u < intrinsics.width - 2 and 2 <= v < intrinsics.height - 2)
            or np.any(surface.body[v - 2 : v + 3, u - 2 : u + 3] != 0)
            or np.any(surface.body[row - 2 : row + 3, column - 2 : column + 3] != 1)
        ):
            continue
        shown.append(image[row, column])
        ought.append(conductor_reflectance(np.arccos(np.array([cosine])), n, k)[0] * image[v, u])
    return len(shown), np.array(ought), np.array(shown)
