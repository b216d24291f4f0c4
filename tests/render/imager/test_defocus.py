"""Laws of defocus: size of the disc, its variance and energy, uniform fields, what decides at an edge."""

import numpy as np
import pytest

from render.imager.chip import OV2740, OV9282
from render.imager.defocus import (
    DISC_DIAMETERS_PX,
    defocused,
    disc_diameter_px,
    disc_kernel,
    disc_map,
    hyperfocal_distance,
)
from render.imager.expose import expose_burst
from render.imager.exposure import auto_exposure
from render.imager.seen_surfaces import SeenSurfaces
from render.imager.settings import ImagerSettings

SETTINGS = ImagerSettings()


def at(distance: float, shape=(81, 640)) -> np.ndarray:
    """One over the depth of a wall [1/m]."""
    return np.full(shape, 1 / distance, np.float32)


def thin_lens_disc(z: float, focus: float, focal: float, f_number: float) -> float:
    """Diameter of the disc [m] by similar triangles behind a thin lens, no approximation: aperture f / N, image of the
    point at v, chip at the image of the focus."""
    v, chip = (1 / (1 / focal - 1 / s) for s in (z, focus))
    return focal / f_number * abs(v - chip) / v


@pytest.mark.parametrize(("z", "stated_px"), [(0.141, 1.69), (0.2, 1.05), (0.3, 0.53), (2.0, 0.35)])
def test_disc_diameter(z, stated_px):
    """Within 1.5 % of exact ray geometry, which differs by f / z; 1.7 px of 640x360 at a recovery pose's 141 mm."""
    focus = hyperfocal_distance(SETTINGS)
    exact = thin_lens_disc(z, focus, OV9282.focal_length, 2.0)
    found = float(disc_diameter_px(at(z), SETTINGS)[0, 0])
    assert found * 6e-6 == pytest.approx(exact, rel=0.015)
    assert found == pytest.approx(stated_px, abs=0.005)


def test_hyperfocal_distance():
    """1.926 mm, f/2 and 3 um make 0.618 m; focused there, infinity and half of it are blurred by one native pixel."""
    assert hyperfocal_distance(SETTINGS) == pytest.approx(0.618, abs=5e-4)
    assert hyperfocal_distance(SETTINGS, OV2740) == pytest.approx(1.27, abs=0.005)
    for inverse in (np.zeros((1, 1280), np.float32), at(0.309123, (1, 1280))):
        assert disc_diameter_px(inverse, SETTINGS)[0, 0] == pytest.approx(1.0, rel=1e-4)


def test_focus_can_be_set():
    """A wall in focus has no disc; the disc of the rest is proportional to the difference of the inverse distances."""
    near = SETTINGS.model_copy(update={"focus_distance": 0.2})
    assert disc_diameter_px(at(0.2), near)[0, 0] == pytest.approx(0, abs=1e-6)
    ratio = disc_diameter_px(at(0.1), near)[0, 0] / disc_diameter_px(at(0.4), near)[0, 0]
    assert ratio == pytest.approx((10 - 5) / (5 - 2.5), rel=1e-5)


@pytest.mark.parametrize("diameter", DISC_DIAMETERS_PX[1:])
def test_disc_has_a_disc_s_variance(diameter):
    """A uniform disc has variance d^2 / 16 along an axis and the same along the other; weights are areas of sum 1."""
    kernel = disc_kernel(diameter)
    offsets = np.arange(len(kernel)) - len(kernel) // 2
    assert kernel.sum() == pytest.approx(1)
    assert kernel.min() >= 0
    for axis in (0, 1):
        assert kernel.sum(axis=axis) @ offsets**2 == pytest.approx(diameter**2 / 16, rel=1e-9)


def test_large_disc_is_flat_and_round():
    """Inside 20 px every weight is that of the disc's density, 4 / (pi d^2); beyond its rim there is nothing."""
    kernel = disc_kernel(20.0)
    v, u = np.indices(kernel.shape) - len(kernel) // 2
    radius = np.hypot(u, v)
    np.testing.assert_allclose(kernel[radius < 9], 4 / (np.pi * 20**2), rtol=0.01)
    assert not kernel[radius > 11].any()


@pytest.mark.parametrize("z", [0.06, 0.141, 0.25, 0.618])
def test_point_on_a_wall(z):
    """A point keeps its energy and spreads with variance c^2 / 16 along both axes, also between the discs of the
    stack."""
    image = np.zeros((81, 640), np.float32)
    image[40, 320] = 100.0
    spread = defocused(image, disc_map(at(z), SETTINGS))
    assert spread.sum() == pytest.approx(100, rel=1e-5)
    expected = float(disc_diameter_px(at(z), SETTINGS)[0, 0]) ** 2 / 16
    for axis, middle in ((0, 320), (1, 40)):
        line = spread.sum(axis=axis) / spread.sum()
        assert line @ (np.arange(line.size) - middle) ** 2 == pytest.approx(expected, rel=1e-3, abs=1e-6)


def test_uniform_light_stays_uniform_over_any_depth():
    """Radiance does not change along a ray: before a step, a slope and nothing a uniform image is uniform."""
    inverse = np.linspace(0, 12, 640, dtype=np.float32)[None, :] * np.ones((80, 1), np.float32)
    inverse[:40, 300:] = 1 / 0.09
    flat = np.full(inverse.shape, 3.0, np.float32)
    np.testing.assert_allclose(defocused(flat, disc_map(inverse, SETTINGS)), flat, rtol=1e-6)


def test_a_near_edge_is_blurred_on_both_sides_and_the_rest_is_sharp():
    """A bright near thing spills over its rim as far as its disc reaches, 1.5 px at 75 mm; stripes on the wall behind,
    in focus, stay as they are beyond that."""
    columns = np.arange(640)
    inverse = np.where(columns < 320, np.float32(1 / 0.075), np.float32(1 / 0.618)) * np.ones((80, 1), np.float32)
    image = np.where(columns < 320, 10.0, columns % 2).astype(np.float32) * np.ones((80, 1), np.float32)
    blurred = defocused(image, disc_map(inverse, SETTINGS))
    disc = float(disc_diameter_px(inverse, SETTINGS).max())
    assert disc == pytest.approx(3.6, abs=0.1)
    assert blurred[40, 320] > 1.5
    assert blurred[40, 319] < 9.0
    np.testing.assert_allclose(blurred[40, 325:600], image[40, 325:600], atol=1e-3)
    np.testing.assert_allclose(blurred[40, 20:315], 10.0, atol=1e-4)


def test_exposure_sees_the_same_blur():
    """Points so bright that each is one white pixel in focus, out of it several, 2.9 px wide: less of their light is
    cut off, the mean rises, and auto-exposure answers with less time. The frames are those of the blurred image."""
    settings = ImagerSettings(vignetting_exponent=0.0, veiling_glare=0.0, lens_sigma_um=0.0)
    projector = np.zeros((120, 640), np.float32)
    ambient = np.full((120, 640), 0.05, np.float32)
    ambient[6::12, 6::12] = 2.0
    rough = np.zeros((120, 640), np.float32)
    near, focus = (SeenSurfaces(at(z, (120, 640)), rough) for z in (0.09, 0.618))
    times = [auto_exposure(projector, ambient, settings, seen=seen)[0] for seen in (near, focus)]
    assert times[0] < 0.97 * times[1]
    white = [np.mean(expose_burst(projector, ambient, settings, 1, 0, seen=seen) == 255) for seen in (near, focus)]
    assert white[0] > 1.5 * white[1]
