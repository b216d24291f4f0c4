"""Laws of the imager: electron budget, linearity, photon transfer, read noise, saturation, exposure, randomness.

Flat fields are seen without vignetting, so that all pixels share one expectation; projector layers are 0 where speckle
would only disturb.
"""

from itertools import pairwise

import numpy as np
import pytest

from render.imager.expose import expose, expose_burst
from render.imager.exposure import auto_exposure, electrons_per_radiance, mean_electrons
from render.imager.settings import ImagerSettings

SHAPE = (120, 640)
"""Rows of a 640-column stream: 2 x 2 native pixels are averaged."""
FLAT = ImagerSettings(vignetting_exponent=0.0)
RECTIFIED = 4 / 9
"""Share of the variance that bilinear interpolation at evenly spread phases leaves: (2/3)^2."""
ROUNDING = 1 / 12
"""Variance of rounding to whole grey values [DN^2]."""


def radiance(grey: float, settings: ImagerSettings, shape=SHAPE) -> np.ndarray:
    """The flat radiance that gives this mean grey value [W m^-2 sr^-1]."""
    electrons = (grey - settings.pedestal) / settings.dn_per_electron
    return np.full(shape, electrons / electrons_per_radiance(settings.exposure_us, settings), np.float32)


def dark(shape=SHAPE) -> np.ndarray:
    """No light."""
    return np.zeros(shape, np.float32)


def second_difference_noise(image: np.ndarray) -> float:
    """Noise of a smooth image from its second differences along both axes (Immerkaer 1996), right for white noise."""
    rows = image[:, 2:] - 2 * image[:, 1:-1] + image[:, :-2]
    return float(np.std(rows[2:] - 2 * rows[1:-1] + rows[:-2]) / 6)


def test_electron_budget():
    """150 mW over 86 x 57 deg on a matte wall (albedo 0.5) at 0.5 m give 1,040 e- in 8.5 ms.

    Field 2 x 0.5 tan 43 by 2 x 0.5 tan 28.5 = 0.506 m^2; L = 0.5 x 0.15 / 0.506 / pi = 0.0472 W m^-2 sr^-1; on the
    sensor pi L 0.9 / 16 = 8.34 mW/m^2; in 9 um^2 and 8.5 ms 6.38e-16 J = 2,730 photons of 2.337e-19 J; times 0.38.
    """
    wall = np.full((3, 5), 0.5 * 0.15 / 0.506 / np.pi, np.float32)
    from_projector, from_ambient = mean_electrons(wall, 0 * wall, FLAT)
    np.testing.assert_allclose(from_projector, 1037, rtol=0.005)
    assert not from_ambient.any()


@pytest.mark.parametrize(
    ("change", "factor"),
    [
        ({"exposure_us": 17_000.0}, 2.0),
        ({"gain": 128.0}, 2.0),
        ({"f_number": 4.0}, 0.25),
        ({"quantum_efficiency": 0.19}, 0.5),
        ({"full_well": 12_000.0}, 0.5),
    ],
)
def test_grey_values_are_linear(change, factor):
    """Above the pedestal the mean is proportional to time, gain, QE, 1 / N^2, 1 / full well and radiance.

    At gain 64 the noise exceeds 0.4 DN, so that rounding does not bias the mean.
    """
    settings = FLAT.model_copy(update={"gain": 64.0})
    light = radiance(60.0, settings)
    assert expose_burst(dark(), light, settings, 4, 0).mean() - 17 == pytest.approx(43, abs=0.02)
    assert expose_burst(dark(), 2 * light, settings, 4, 0).mean() - 17 == pytest.approx(86, abs=0.03)
    changed = settings.model_copy(update=change)
    assert expose_burst(dark(), light, changed, 4, 0).mean() - 17 == pytest.approx(43 * factor, abs=0.03)


def test_laser_power_scales_the_projector_alone():
    """360 mW give 2.4 times the light of 150 mW; ambient light does not know of the laser."""
    light = radiance(60.0, FLAT)
    strong, off = FLAT.model_copy(update={"laser_power_mw": 360.0}), FLAT.model_copy(update={"laser_power_mw": 0.0})
    assert expose_burst(light, dark(), strong, 2, 0).mean() - 17 == pytest.approx(2.4 * 43, abs=0.2)
    assert expose_burst(light, dark(), off, 2, 0).mean() == pytest.approx(17, abs=0.01)
    assert expose_burst(dark(), light, strong, 2, 0).mean() - 17 == pytest.approx(43, abs=0.05)


def test_projector_stops_with_its_pulse():
    """With a pulse of 4 ms, 4 or 8 ms of exposure collect the same laser light, but twice the ambient light."""
    light = np.full((3, 5), 0.05, np.float32)
    short = FLAT.model_copy(update={"exposure_us": 4000.0, "laser_pulse_us": 4000.0})
    long = short.model_copy(update={"exposure_us": 8000.0})
    (laser_short, ambient_short), (laser_long, ambient_long) = (mean_electrons(light, light, s) for s in (short, long))
    np.testing.assert_allclose(laser_long, laser_short)
    np.testing.assert_allclose(ambient_long, 2 * ambient_short, rtol=1e-6)


@pytest.mark.parametrize(("width", "averaged"), [(1280, 1.0), (848, (1280 / 848) ** 2), (640, 4.0)])
def test_photon_transfer_curve(width, averaged):
    """Temporal variance over mean is a line of slope DN per e-, over the pixels averaged, times the rectification."""
    settings = FLAT.model_copy(update={"gain": 128.0})
    shape = (60, width)
    means, variances = [], []
    for seed, grey in enumerate((50.0, 80.0, 110.0, 140.0, 170.0)):
        frames = expose_burst(dark(shape), radiance(grey, settings, shape), settings, 40, seed)
        means.append(frames.mean() - 17)
        variances.append(frames.var(axis=0, ddof=1, dtype=float).mean() - ROUNDING)
    unit = settings.dn_per_electron / averaged * RECTIFIED
    slope, _ = np.polyfit(means, variances, 1)
    assert slope == pytest.approx(unit, rel=0.02)


def test_read_noise_in_the_dark():
    """At gain 248 a dark frame shows 2.5 e- of each of four averaged pixels, rectified and rounded, on the pedestal."""
    settings = FLAT.model_copy(update={"gain": 248.0})
    frames = expose_burst(dark(), dark(), settings, 40, 1)
    expected = (2.5 * settings.dn_per_electron) ** 2 / 4 * RECTIFIED + ROUNDING
    assert frames.mean() == pytest.approx(17, abs=0.01)
    assert frames.var(dtype=float) == pytest.approx(expected, rel=0.02)


def test_noise_of_neighbours():
    """Rectification leaves neighbours correlated by (1/6) / (2/3) = 1/4 and diagonal ones by 1/16, others not."""
    settings = FLAT.model_copy(update={"gain": 248.0})
    frames = expose_burst(dark(), radiance(130.0, settings), settings, 20, 2).astype(float)
    noise = frames - frames.mean()

    def correlation(a, b):
        return float((a * b).mean() / noise.var())

    assert correlation(noise[:, :, 1:], noise[:, :, :-1]) == pytest.approx(1 / 4, abs=0.01)
    assert correlation(noise[:, 1:], noise[:, :-1]) == pytest.approx(1 / 4, abs=0.01)
    assert correlation(noise[:, 1:, 1:], noise[:, :-1, :-1]) == pytest.approx(1 / 16, abs=0.01)
    assert correlation(noise[:, :, 2:], noise[:, :, :-2]) == pytest.approx(0.0, abs=0.01)
    assert correlation(noise[1:], noise[:-1]) == pytest.approx(0.0, abs=0.01)


def test_noise_at_mid_grey():
    """At gain 16 and 128 DN, 640 x 360: 2,798 e- make 2.1 DN of shot noise, 1.05 averaged over four, 0.70 rectified.

    Second differences, which is how noise is read off a single real frame, then show 1.05 x 4/9 = 0.47 DN: real frames
    stay below 0.5 DN.
    """
    settings = FLAT.model_copy(update={"full_well": 6000.0})
    frames = expose_burst(dark((200, 640)), radiance(128.0, settings, (200, 640)), settings, 30, 3).astype(float)
    temporal = np.sqrt(frames.var(axis=0, ddof=1).mean() - ROUNDING)
    assert temporal == pytest.approx(0.70, abs=0.01)
    spatial = np.sqrt(np.mean([second_difference_noise(f) ** 2 for f in frames]) - ROUNDING)
    assert spatial == pytest.approx(0.466, abs=0.01)


def test_saturation_share():
    """Of a ramp from dark to twice what fills the wells one half is white, and sharply so."""
    white = float(radiance(255.0, FLAT)[0, 0])
    ramp = np.broadcast_to(np.linspace(0, 2 * white, 640, dtype=np.float32), SHAPE)
    frames = expose_burst(dark(), ramp, FLAT, 4, 4)
    assert np.mean(frames == 255) == pytest.approx(0.5, abs=0.005)
    assert not np.any(frames[..., :300] == 255)
    assert np.all(frames[..., 340:] == 255)


@pytest.mark.parametrize("level", [0.002, 0.02, 0.2, 2.0])
def test_auto_exposure_reaches_the_set_point(level):
    """Over two decades and more of light, dots and lamps mixed, the middle of the image averages 96 DN."""
    rng = np.random.default_rng(5)
    projector = (level * rng.gamma(0.5, 2.0, (360, 640))).astype(np.float32)
    ambient = np.full((360, 640), 0.3 * level, np.float32)
    exposure, gain = auto_exposure(projector, ambient, ImagerSettings())
    settings = ImagerSettings(exposure_us=exposure, gain=gain)
    image = expose(projector, ambient, settings, rng)
    assert image[36:324, 64:576].mean() == pytest.approx(96, abs=1.5)
    assert gain == 16 or exposure > 30_000  # the gain of a dim scene is rounded up, its exposure then trimmed


def test_auto_exposure_limits():
    """Darkness ends at 33 ms and full gain, glare at 1 us and gain 16."""
    assert auto_exposure(dark(), dark(), FLAT) == (33_000.0, 248.0)
    assert auto_exposure(dark(), dark() + np.float32(1e5), FLAT) == (1.0, 16.0)


def test_auto_exposure_looks_at_its_region():
    """A dark region in a bright image gets the longer exposure: in proportion, as nothing else differs.

    Without glare, by which the bright surroundings would light the dark region."""
    clear = FLAT.model_copy(update={"veiling_glare": 0.0})
    ambient = np.full((360, 640), 0.05, np.float32)
    ambient[100:200, 100:300] /= 2
    inner, outer = np.zeros((2, 360, 640), bool)
    inner[120:180, 120:280] = outer[120:180, 400:560] = True
    inside, _ = auto_exposure(dark((360, 640)), ambient, clear, inner)
    outside, _ = auto_exposure(dark((360, 640)), ambient, clear, outer)
    assert inside / outside == pytest.approx(2.0, rel=1e-3)


def test_same_seed_same_bytes_and_longer_bursts_begin_alike():
    """A seed fixes every byte, also as a SeedSequence used before; frame k does not depend on the number of frames."""
    light = radiance(100.0, FLAT)
    seed = np.random.SeedSequence(7, spawn_key=(3, 1))
    first = expose_burst(light, light, FLAT, 5, seed)
    np.testing.assert_array_equal(first, expose_burst(light, light, FLAT, 5, seed))
    np.testing.assert_array_equal(first[:2], expose_burst(light, light, FLAT, 2, seed))
    assert not np.array_equal(first, expose_burst(light, light, FLAT, 5, np.random.SeedSequence(7, spawn_key=(3, 2))))
    one = expose(light, light, FLAT, np.random.default_rng(1))
    np.testing.assert_array_equal(one, expose(light, light, FLAT, np.random.default_rng(1)))


def test_left_and_right_noise_are_uncorrelated():
    """Two imagers of one pose have seeds of their own: noise correlates less than 4 standard errors, frames differ."""
    settings = FLAT.model_copy(update={"gain": 64.0})
    light = radiance(100.0, settings)
    left, right = (expose_burst(dark(), light, settings, 4, s) for s in np.random.SeedSequence(0).spawn(2))
    correlation = np.corrcoef(left.ravel(), right.ravel())[0, 1]
    assert abs(correlation) < 4 / np.sqrt(left.size)
    assert all(np.mean(a != b) > 0.5 for a, b in pairwise(left))
