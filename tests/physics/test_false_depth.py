"""Mirrors show things where the laws of reflection put them, and the measured depth believes what it sees."""

import numpy as np
import pytest

from render.d435i import SensorSettings, SimulatedD435i
from tests.physics.ball_bias import ball_bias, camera_near, camera_of_published_frame
from tests.physics.mirror_optics import mirrored_stereo_depth, reflection_point, virtual_image_depth
from tests.physics.mirror_scenes import (
    PLATE_DISTANCE,
    WALL_OFFSET,
    ball_from_above,
    corner_with_mirror,
    floor_behind_mirror,
    plate_before_wall,
    steel,
)

UNLIT = SensorSettings(crop=None, auto_exposure=False)
"""Whole image at the camera's default exposure: before black surroundings auto-exposure would clip everything."""
NEAR = 0.02
"""Relative error of depth that counts as agreement: the datasheet's Z-accuracy."""
CEILING = 1.95
"""Height of the lamps over the table [m], the farthest thing that the balls mirror."""


@pytest.mark.parametrize("alpha", [0.005, 0.01, 0.02])
def test_plate_shows_the_mirrored_wall(alpha):
    """A near-mirror at 45 deg shows the wall beside it square to the axis at 0.4 + 0.25 m, 63 % behind its own
    surface. All of the plate is filled; at most a tenth strays at alpha 0.02, whose lobe (2 alpha over 0.25 m) is as
    wide as the dots lie apart and leaves 2 grey values of texture; nothing shows the plate itself."""
    view = plate_before_wall(alpha)
    camera = SimulatedD435i(view.scene, UNLIT, seed=1)
    depth, plate = camera.measure(view.T_world_cam, 1).depths[0], view.mirror_pixels(camera)
    assert np.mean(depth[plate] > 0) > 0.98
    found = depth[plate & (depth > 0)]
    virtual = PLATE_DISTANCE + WALL_OFFSET
    assert np.median(found) == pytest.approx(virtual, rel=0.005)
    assert np.mean(np.abs(found / virtual - 1) < NEAR) > 0.9
    surface = camera.truth(view.T_world_cam).depth[plate & (depth > 0)]
    assert np.mean(np.abs(found / surface - 1) < NEAR) < 0.01


@pytest.mark.parametrize("alpha", [0.005, 0.01])
def test_corner_carries_its_floor_on_behind_the_mirror(alpha):
    """Mirrored at the upright plate, floor points at (x, y, z) appear at (x, 2 y_mirror - y, z): in the floor's own
    plane, so the expected depth is where the pixel's ray meets that plane. Up to 0.2 m behind the mirror."""
    view = corner_with_mirror(alpha)
    camera = SimulatedD435i(view.scene, UNLIT, seed=1)
    depth, expected = camera.measure(view.T_world_cam, 1).depths[0], floor_behind_mirror(camera, view)
    seen = view.mirror_pixels(camera) & np.isfinite(expected)
    assert np.mean(depth[seen] > 0) > 0.95
    found = seen & (depth > 0)
    assert np.median(depth[found] / expected[found]) == pytest.approx(1.0, abs=0.005)
    assert np.mean(np.abs(depth[found] / expected[found] - 1) < NEAR) > 0.9
    surface = camera.truth(view.T_world_cam).depth
    assert np.mean(np.abs(depth[found] / surface[found] - 1) < NEAR) < 0.01


def test_reflection_point_obeys_the_law_of_reflection():
    """At the point found for a thing at random, the normal lies in the plane of both directions and halves them."""
    rng = np.random.default_rng(3)
    centre, radius, eye = np.array([0.0, 0.0, 0.9]), 0.0435, np.zeros(3)
    things = rng.uniform([-1, -1, -1], [1, 1, 0.3], (200, 3))
    point = reflection_point(eye, things, centre, radius)
    normal = (point - centre) / radius
    to_eye, to_thing = (d / np.linalg.norm(d, axis=1, keepdims=True) for d in (eye - point, things - point))
    np.testing.assert_allclose(to_eye + to_thing, 2 * np.sum(normal * to_eye, axis=1)[:, None] * normal, atol=1e-9)


@pytest.mark.parametrize("distance", [0.3, 2.0, 1e4])
def test_stereo_sees_the_mirror_equation_on_the_axis(distance):
    """Triangulating exact reflections near the axis with a short baseline gives the paraxial image distance
    s R / (2 s + R) behind the pole, and R / 2 for things at infinity."""
    radius = 0.05
    rays = np.array([[1e-4, 1e-4, 1.0]])
    surface, seen = mirrored_stereo_depth(
        rays / np.linalg.norm(rays), np.array([0.0, 0.0, 0.8]), radius, distance, baseline=1e-3
    )
    assert (seen - surface)[0] == pytest.approx(virtual_image_depth(distance, radius), rel=1e-3)


def test_ball_is_seen_half_its_radius_too_deep():
    """A mirror ball of R 43.5 mm on a wooden table 0.59 m below the camera: its middle shows ceiling and lamps, whose
    virtual images lie s R / (2 s + R), nearly R / 2, behind the pole. Within 10 %; a tenth of a pixel is 0.8 mm.

    Of its pixels 95 % are filled, to within what noise does: from seed to seed the share differs by 0.013 (0.950 and
    0.937 of two on one processor), and on another processor by a few pixels."""
    radius = 0.0435
    view = ball_from_above(steel(0.01), radius, 0.5 + 2 * radius)
    bias = ball_bias(camera_near(view), view, radius)
    assert bias.filled > 0.95 - 2 * 0.013
    assert bias.middle_mm == pytest.approx(1e3 * virtual_image_depth(CEILING - 2 * radius, radius), rel=0.1)


@pytest.mark.slow
def test_bias_of_mirror_balls_grows_as_half_the_radius():
    """Five balls at 0.5 m: each bias within 10 % of the mirror equation, and a straight line through them rises by
    one half, as R / 2 does."""
    radii = np.array([0.015, 0.025, 0.035, 0.0435, 0.060])
    biases = []
    for radius in radii:
        view = ball_from_above(steel(0.01), radius, 0.5 + 2 * radius)
        biases.append(ball_bias(camera_near(view), view, radius).middle_mm / 1e3)
        assert biases[-1] == pytest.approx(virtual_image_depth(CEILING - 2 * radius, radius), rel=0.1)
    assert np.polyfit(radii, biases, 1)[0] == pytest.approx(0.5, rel=0.15)


@pytest.mark.slow
@pytest.mark.parametrize("alpha", [0.01, 0.03])
def test_ball_of_the_published_frame(alpha):
    """A real camera 0.93 m above a metal table filled 98 % of a polished ball of R 43.5 mm, +17 mm too deep (+18 in
    the middle, +12 at the rim). The rendered one: at least 95 %, +12 to +22 mm, most in the middle."""
    radius = 0.0435
    view = ball_from_above(steel(alpha), radius, 0.93, steel(0.2))
    bias = ball_bias(camera_of_published_frame(view), view, radius)
    assert bias.filled >= 0.95
    assert 12 <= bias.median_mm <= 22
    assert bias.middle_mm == pytest.approx(1e3 * virtual_image_depth(CEILING - 2 * radius, radius), rel=0.1)
