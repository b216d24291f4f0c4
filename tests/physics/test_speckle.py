"""Laws of laser speckle: degrees of freedom against simulated wave fields, contrast, stability, independence."""

import numpy as np
import pytest

from render.imager.expose import expose_burst
from render.imager.settings import WAVELENGTH, ImagerSettings
from render.imager.speckle import aperture_degrees, bandwidth_degrees, degrees_of_freedom, speckle, speckle_contrast


@pytest.mark.parametrize("pitch_um", [3.0, 6.0])
def test_aperture_degrees_against_diffraction(pitch_um):
    """A rough surface is imaged through a round f/2 pupil by FFT; the pixels' sums have contrast M^(-1/2).

    Samples are 0.25 um apart (the field's cutoff is 1 / (2 lambda N) = 0.29 per um), pixels sum 12 or 24 of them.
    """
    rng = np.random.default_rng(1)
    size, step = 1536, 0.25e-6
    frequency = np.fft.fftfreq(size, step)
    pupil = np.hypot(frequency[:, None], frequency[None, :]) <= 1 / (2 * WAVELENGTH * 2.0)
    scattered = np.exp(2j * np.pi * rng.random((size, size)))
    intensity = np.abs(np.fft.ifft2(np.fft.fft2(scattered) * pupil)) ** 2
    k = round(pitch_um * 1e-6 / step)
    pixels = intensity[: size // k * k, : size // k * k].reshape(size // k, k, size // k, k).sum(axis=(1, 3))
    assert intensity.std() / intensity.mean() == pytest.approx(1.0, rel=0.03)
    contrast = pixels.std() / pixels.mean()
    assert contrast == pytest.approx(aperture_degrees(pitch_um * 1e-6, 2.0) ** -0.5, rel=0.05)


def test_bandwidth_degrees_against_scatterers():
    """Light of 31 wavelengths from 150 random heights: contrast M^(-1/2). A smooth surface keeps contrast 1."""
    rng = np.random.default_rng(2)
    linewidth, height = 4e-9, 40e-6
    sigma = 2 * np.pi * linewidth / (2 * np.sqrt(2 * np.log(2))) / WAVELENGTH**2
    offsets = np.linspace(-4, 4, 31)
    weights = np.exp(-(offsets**2) / 2)
    wave_numbers = 2 * np.pi / WAVELENGTH + sigma * offsets
    heights = rng.normal(0, height, (4000, 150, 1))
    phases = 2 * np.pi * rng.random((4000, 150, 1))
    intensity = np.zeros(4000)
    for weight, k in zip(weights, wave_numbers, strict=True):
        intensity += weight * np.abs(np.exp(1j * (2 * k * heights + phases)).sum(axis=(1, 2))) ** 2
    contrast = intensity.std() / intensity.mean()
    assert contrast == pytest.approx(bandwidth_degrees(linewidth, height) ** -0.5, rel=0.05)
    assert bandwidth_degrees(linewidth, 0.0) == 1.0


@pytest.mark.parametrize(("width", "stated"), [(1280, 0.072), (640, 0.041)])
def test_contrast_is_as_stated(width, stated):
    """The factor has mean 1 and the contrast that `speckle_contrast` states; streams that bin more see less of it."""
    settings = ImagerSettings()
    drawn = speckle(200, width, settings, np.random.default_rng(3))
    assert drawn.mean() == pytest.approx(1.0, abs=1e-3)
    assert drawn.std() == pytest.approx(speckle_contrast(width, settings), rel=0.02)
    assert speckle_contrast(width, settings) == pytest.approx(stated, abs=5e-4)


def test_contrast_falls_with_modes_and_aperture():
    """Contrast falls as one over the root of the modes; a smaller aperture makes coarser grains and more of it."""
    one, four = (speckle_contrast(640, ImagerSettings(laser_modes=m)) for m in (1.0, 4.0))
    assert one / four == pytest.approx(2.0)
    assert speckle_contrast(640, ImagerSettings(f_number=4.0)) > 1.5 * speckle_contrast(640, ImagerSettings())
    assert degrees_of_freedom(640, ImagerSettings(laser_modes=1.0)) > 2 * 36 / (4 / np.pi * 1.7**2)  # pixel over grain


def test_speckle_stands_still_and_differs_between_imagers():
    """In a burst the pattern is common to all frames: their mean keeps its contrast. Two imagers share nothing."""
    settings = ImagerSettings(vignetting_exponent=0.0)
    wall, dark = np.full((120, 640), 0.06, np.float32), np.zeros((120, 640), np.float32)
    bursts = [expose_burst(wall, dark, settings, 30, s) for s in np.random.SeedSequence(1).spawn(2)]
    left, right = (burst.mean(axis=0) - 17 for burst in bursts)
    assert left.std() / left.mean() == pytest.approx(speckle_contrast(640, settings), rel=0.03)
    assert abs(np.corrcoef(left.ravel(), right.ravel())[0, 1]) < 4 / np.sqrt(left.size)
    halves = bursts[0][:15].mean(axis=0), bursts[0][15:].mean(axis=0)
    assert np.corrcoef(halves[0].ravel(), halves[1].ravel())[0, 1] > 0.9


def test_ambient_light_has_no_speckle():
    """Lamps are incoherent: the mean of many frames of a lamp-lit wall is flat to the noise that is left."""
    settings = ImagerSettings(vignetting_exponent=0.0)
    wall, dark = np.full((120, 640), 0.06, np.float32), np.zeros((120, 640), np.float32)
    mean = expose_burst(dark, wall, settings, 30, 4).mean(axis=0) - 17
    assert mean.std() / mean.mean() < 0.1 * speckle_contrast(640, settings)
