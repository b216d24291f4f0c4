"""Which surfaces speckle: heights by roughness, the coherent share, where it is seen, and the contrast that is left."""

import numpy as np
import pytest

from render.imager.chip import OV9282
from render.imager.expose import expose_burst
from render.imager.seen_surfaces import SeenSurfaces
from render.imager.settings import WAVELENGTH, ImagerSettings
from render.imager.speckle import aperture_degrees, contrast_kept, speckle, speckle_contrast
from render.imager.surface_speckle import HEIGHTS, coherent_share, specular_share, surface_height

SETTINGS = ImagerSettings()


def test_heights_of_known_finishes():
    """At the table's alphas they are Ra times sqrt(pi / 2), Gaussian heights' standard over mean deviation; in between
    they rise, and far below a smoother surface is flatter in proportion."""
    alphas, ra = np.array(HEIGHTS).T
    np.testing.assert_allclose(surface_height(alphas), 1.2533 * ra * 1e-6, rtol=1e-4)
    assert np.all(np.diff(surface_height(np.geomspace(0.001, 1.0, 60))) > 0)
    assert surface_height(np.array([0.001]))[0] == pytest.approx(surface_height(np.array([0.01]))[0] / 10)


@pytest.mark.parametrize("height", [20e-9, 60e-9, 120e-9])
def test_coherent_share_against_a_random_surface(height):
    """The mean field of a million Gaussian heights, each with the phase of its way there and back, squared."""
    heights = np.random.default_rng(1).normal(0, height, 1_000_000)
    for incidence in (0.0, np.radians(50)):
        phases = 4 * np.pi * heights * np.cos(incidence) / WAVELENGTH
        share = abs(np.exp(1j * phases).mean()) ** 2
        assert coherent_share(np.array([height]), np.cos([incidence]))[0] == pytest.approx(share, abs=0.002)


def test_limits_of_the_share_in_the_mirror_direction():
    """At incidence and reflection of 30 deg: a surface without roughness sends all light coherently, a ground one
    none."""
    direction = np.array([[0.5, 0.0, np.sqrt(0.75)]], np.float32)
    mirrored = direction * np.array([-1, 1, 1], np.float32)
    up = np.array([[0, 0, 1]], np.float32)
    alphas = np.array([[1e-3], [0.01], [0.03], [0.15]], np.float32)
    shares = [specular_share(direction, mirrored, up, a, surface_height(a).astype(np.float32))[0] for a in alphas]
    assert shares[0] == pytest.approx(1, abs=0.005)
    assert shares[0] > shares[1] > shares[2] > shares[3]
    assert shares[3] < 1e-6


def test_off_the_highlight_every_surface_speckles():
    """Two lobes' widths from the mirror direction less than e^-4 of the light is coherent, of any finish; along the
    lobe it falls as the Gaussian core."""
    up = np.array([[0, 0, 1]], np.float32)
    for alpha in (0.01, 0.03, 0.07):
        tilts = alpha * np.array([0.0, 1.0, 2.0])
        half = np.stack([np.sin(np.arctan(tilts)), 0 * tilts, np.cos(np.arctan(tilts))], axis=1).astype(np.float32)
        one, height = np.full(3, alpha, np.float32), surface_height(np.array([alpha]))
        shares = specular_share(half, half, np.repeat(up, 3, axis=0), one, np.full(3, height[0], np.float32))
        kept = coherent_share(height, np.ones(1))
        np.testing.assert_allclose(shares, kept * np.exp(-np.array([0.0, 1.0, 4.0])), rtol=1e-2)


@pytest.mark.parametrize("coherent", [0.2, 0.5, 0.8])
def test_contrast_of_partly_coherent_light_against_diffraction(coherent):
    """A constant field beside scattered light is imaged through a round f/2 pupil by FFT and summed over 3 um pixels:
    the contrast, relative to that of the scattered light alone, is the formula's.

    Samples are 0.25 um apart (the field's cutoff is 0.29 per um); a pixel sums 12 of them.
    """
    rng = np.random.default_rng(2)
    size, step, side = 1536, 0.25e-6, 12
    frequency = np.fft.fftfreq(size, step)
    pupil = np.hypot(frequency[:, None], frequency[None, :]) <= 1 / (2 * WAVELENGTH * 2.0)
    scattered = np.fft.ifft2(np.fft.fft2(np.exp(2j * np.pi * rng.random((size, size)))) * pupil)
    scattered -= scattered.mean()
    scattered /= np.sqrt(np.mean(np.abs(scattered) ** 2))

    def contrast(share):
        light = np.abs(np.sqrt(share) + np.sqrt(1 - share) * scattered) ** 2
        pixels = light.reshape(size // side, side, size // side, side).sum(axis=(1, 3))
        return pixels.std() / pixels.mean()

    kept = contrast_kept(np.array([coherent], np.float32), 1280, SETTINGS)[0]
    assert contrast(coherent) / contrast(0.0) == pytest.approx(kept, rel=0.03)


def test_aperture_averages_interference_less():
    """mu falls off more slowly than mu^2, so fewer independent grains of it fall on a pixel; on one far larger than a
    grain their number is the pixel's area over the integral of mu, (lambda N)^2 4 / pi, which is that of mu^2 too."""
    assert aperture_degrees(3e-6, 2.0, 1) < aperture_degrees(3e-6, 2.0)
    pixel = 60e-6
    assert aperture_degrees(pixel, 2.0) == pytest.approx(np.pi / 4 * pixel**2 / (2 * WAVELENGTH) ** 2, rel=0.05)


def test_limits_of_the_contrast():
    """No coherent light: today's contrast and the same draws; nothing else: none. In between the pattern is the same
    one, of mean 1."""
    shape, draws = (120, 640), [np.random.default_rng(3) for _ in range(4)]
    plain = speckle(*shape, SETTINGS, draws[0])
    rough, half, smooth = (
        speckle(*shape, SETTINGS, rng, OV9282, np.full(shape, share, np.float32))
        for rng, share in zip(draws[1:], (0.0, 0.5, 1.0), strict=True)
    )
    np.testing.assert_array_equal(plain, rough)
    np.testing.assert_array_equal(smooth, 1.0)
    assert half.mean() == pytest.approx(1, abs=1e-3)
    assert half.std() < plain.std()
    assert np.corrcoef(half.ravel(), plain.ravel())[0, 1] == pytest.approx(1, abs=1e-4)


def test_longer_bursts_begin_alike_and_imagers_share_nothing():
    """With coherent light in half of the image the frames of a burst still begin those of a longer one; the rough half
    has the stated contrast, the other none; left and right are independent."""
    settings = ImagerSettings(vignetting_exponent=0.0, veiling_glare=0.0)
    wall, dark = np.full((120, 640), 0.06, np.float32), np.zeros((120, 640), np.float32)
    share = np.zeros((120, 640), np.float32)
    share[:, 320:] = 1.0
    seen = SeenSurfaces(np.full((120, 640), 1 / 0.618, np.float32), share)
    left, right = (expose_burst(wall, dark, settings, 30, s, seen=seen) for s in np.random.SeedSequence(1).spawn(2))
    np.testing.assert_array_equal(
        left[:3], expose_burst(wall, dark, settings, 3, np.random.SeedSequence(1).spawn(1)[0], seen=seen)
    )
    means = [burst.mean(axis=0) - 17 for burst in (left, right)]
    for mean in means:
        assert mean[:, :310].std() / mean[:, :310].mean() == pytest.approx(speckle_contrast(640, settings), rel=0.04)
        assert mean[:, 330:].std() / mean[:, 330:].mean() < 0.1 * speckle_contrast(640, settings)
    assert abs(np.corrcoef(means[0][:, :310].ravel(), means[1][:, :310].ravel())[0, 1]) < 4 / np.sqrt(120 * 310)
