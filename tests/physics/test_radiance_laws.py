"""Rendered radiance against closed forms."""

import numpy as np
import pytest

from materials.material import Matte, RoughConductor
from render.light.pattern import d435_pattern
from render.light.projector import ProjectorLight
from render.light.radiance import render_layers
from render.light.sampling import Sampling
from render.world.mitsuba_scene import load_scene
from render.world.rig import d435i_rig
from scenes.scene import Body, Scene
from tests.physics.simple_scenes import facing_x, lamp_at, rectangle, wall

WHITE_WALL_MEAN = 0.3
"""s, the radiance of a white wall at 1 m averaged over the field [W m^-2 sr^-1]; any value serves."""
TWO_VERTICES = Sampling(max_depth=2, closing=False, indirect_directions=1024)


def layers_of(scene, sampling=None, pose=None, profile="424x240"):
    rig, pose = d435i_rig(profile), pose or facing_x()
    light = ProjectorLight.at(rig.projector(pose), d435_pattern(), WHITE_WALL_MEAN)
    return render_layers(load_scene(scene), light, rig.intrinsics, pose, sampling or Sampling())


@pytest.mark.parametrize("distance", [0.3, 1.0])
def test_wall_radiance_is_rho_s_over_z2(distance):
    """A Lambertian wall at distance z shows rho s / z^2 at each dot. The pattern's mean is 1, so the mean over a region
    is rho s / z^2 too, up to how many dots fall into it: 3 % for the some 400 dots of the middle of the image."""
    image = layers_of(wall(distance, Matte("wall", 0.4))).projector
    middle = image[60:-60, 100:-100]
    assert middle.mean() == pytest.approx(0.4 * WHITE_WALL_MEAN / distance**2, rel=0.03)


def test_dots_keep_their_power_under_whole_paths():
    """Whole light paths and the quick way for Lambertian pixels estimate the same integral; on a wall without indirect
    light both are nearly exact, so every pixel agrees within the width of a texel (5 % of the brightest dot)."""
    quick = layers_of(wall(0.5), Sampling(subpixels=64)).projector
    whole = layers_of(wall(0.5), Sampling(glossy_paths=64, whole_paths_everywhere=True)).projector
    np.testing.assert_allclose(quick, whole, atol=0.05 * whole.max())


def test_projector_field_ends_hard():
    """The field is 86 x 57 deg; the imager sees 90 x 59: beyond tan(43 deg) f columns left of the projector's axis
    there is no light, and within the field there is light everywhere (the pattern's background share)."""
    rig = d435i_rig("640x360")
    image = layers_of(wall(1.0), profile="640x360").projector
    k = rig.intrinsics
    axis = k.cx + k.fx * rig.projector_offset / 1.0
    left, right = (axis + side * np.tan(np.radians(43)) * k.fx for side in (-1, 1))
    row = image[k.height // 2]
    assert np.all(row[: int(left) - 1] == 0)
    assert np.all(row[int(left) + 2 : int(right) - 1] > 0)
    assert np.all(row[int(right) + 2 :] == 0)


def test_lamp_lights_wall_by_its_solid_angle():
    """A small lamp of radiance L and area A opposite the wall's centre at distance d gives E = L A cos cos / d^2 and
    the wall shows rho E / pi."""
    side, radiance, distance = 0.02, 50.0, 1.0
    scene = wall(distance, Matte("wall", 0.6), (lamp_at([-1.0, 0, 0], [1, 0, 0], side, radiance),))
    image = layers_of(scene, Sampling(max_depth=1)).ambient
    expected = 0.6 / np.pi * radiance * side**2 / (distance + 1.0) ** 2
    assert image[115:125, 207:217].mean() == pytest.approx(expected, rel=0.01)


def test_white_wall_vanishes_in_a_furnace():
    """A plane of albedo 1 under a constant environment of radiance 1 shows exactly 1."""
    box = wall(0.5, Matte("white", 1.0))
    scene = Scene("furnace", box.bodies, (), 1.0)
    image = layers_of(scene, Sampling(max_depth=1, subpixels=4)).ambient
    assert image.mean() == pytest.approx(1.0, rel=0.02)


def test_indirect_light_between_two_walls():
    """A wall lit only by way of a second, far smaller wall: radiance rho_1 / pi * L_2 A_2 cos cos / d^2, with L_2 the
    smaller wall's own radiance under the lamp, rho_2 / pi L A cos cos / d^2. Direct light is kept off the first wall by
    aiming the (one-sided) lamp away from it; tolerance is that of 1024 directions towards a small target."""
    small = rectangle([0.0, 0.0, 0.6], [1.0, 0, 0.6], 0.5, 0.5)
    first = wall(1.0).bodies[0]
    lamp = lamp_at([0.9, 0.0, 0.6], [0, 0, 0.6], 0.05, 100.0)
    scene = Scene("two", (first, Body("small", small, Matte("small", 0.8), False)), (lamp,), 0.0)
    image = layers_of(scene, TWO_VERTICES).ambient
    rng = np.random.default_rng(0)
    expected = _two_bounce_radiance(rng, small, lamp, rho=(0.5, 0.8))
    assert image[120, 212] == pytest.approx(expected, rel=0.05)


def _two_bounce_radiance(rng, small, lamp, rho):
    """Independent Monte Carlo over pairs of points on the lamp and the small wall, for the point (1, 0, 0)."""
    n = 200_000
    low, high = small.vertices.min(axis=0), small.vertices.max(axis=0)
    q = rng.uniform(low, high, (n, 3))
    p = lamp.T_world_lamp.apply(np.column_stack([*rng.uniform(-0.5, 0.5, (2, n)) * lamp.width, np.zeros(n)]))
    x, to_first = np.array([1.0, 0, 0]), np.array([-1.0, 0, 0])
    normal_small, normal_lamp = np.array([1.0, 0, 0]), np.array([-1.0, 0, 0])
    qp, qx = p - q, x - q
    e_small = lamp.radiance * lamp.width**2 * _cosines(qp, normal_small, normal_lamp)
    l_small = rho[1] / np.pi * e_small
    area = np.prod((high - low)[1:])
    return rho[0] / np.pi * area * np.mean(l_small * _cosines(qx, normal_small, to_first))


def _cosines(between, normal_here, normal_there):
    """cos cos / d^2 of points apart by `between` (n, 3)."""
    d2 = np.sum(between**2, axis=1)
    return np.maximum(between @ normal_here, 0) * np.maximum(-between @ normal_there, 0) / d2**2


def test_mirror_shows_lamp_at_the_mirrored_place():
    """A near-mirror plate facing the camera shows a lamp beside the camera where the law of reflection says, at
    radiance R0 L with R0 = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2); GGX's tails miss the lamp with under 0.5 % of the
    light."""
    n, k = 3.249, 4.905
    mirror = RoughConductor("mirror", n, k, 0.001, 0.001)
    scene = wall(0.5, mirror, (lamp_at([0.0, -0.1, 0.05], [0.5, -0.1, 0.05], 0.06, 7.0),))
    image = layers_of(scene, Sampling(max_depth=1, glossy_paths=64)).ambient
    rig = d435i_rig("424x240")
    # The virtual lamp stands at twice the mirror's distance; camera x is world -y, camera y is world -z.
    u, v = (
        (rig.intrinsics.fx * np.array([0.1, -0.05]) / 1.0 + [rig.intrinsics.cx, rig.intrinsics.cy]).round().astype(int)
    )
    reflectance = ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)
    assert image[v, u] == pytest.approx(7.0 * reflectance, rel=0.02)
    assert image[v, u - 30] < 0.02 * image[v, u]
