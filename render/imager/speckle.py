"""Laser speckle: how much the projected light flickers from pixel to pixel, and one sample of it.

Source: J. W. Goodman, Speckle Phenomena in Optics (2007): degrees of freedom of integrated speckle (chapter 4), of
incoherent sums over modes and polarisations (chapter 3) and of a finite bandwidth on a rough surface (chapter 6).
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float32
from scipy.special import j1

from render.imager.chip import OV9282, Chip
from render.imager.lens import MIXED_VARIANCE, mix_neighbours
from render.imager.settings import WAVELENGTH, ImagerSettings

POLARISATIONS = 2
"""The VCSELs' polarisations are mixed and a rough surface mixes them further: two independent patterns, of which a
polariser before the imager leaves one."""
_FWHM_PER_SIGMA = 2 * np.sqrt(2 * np.log(2))
_NODES = 48


@lru_cache
def aperture_degrees(pitch: float, f_number: float, power: int = 2) -> float:
    """Independent speckle grains that one square pixel of this pitch [m] sums up.

    M = 1 / integral over the pixel's autocorrelation of mu^power, with mu = 2 J1(z) / z, z = pi r / (lambda N), of a
    circular pupil. A grain measures about lambda N = 1.7 um: M = 4.3 for 3 um, 13.3 for 6 um. power: 2 for scattered
    light alone; 1 for its interference with coherent light, whose grains are larger.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    x, w = (nodes + 1) / 2, weights / 2 * (1 - (nodes + 1) / 2)
    z = np.pi * pitch * np.hypot(x[:, None], x[None, :]) / (WAVELENGTH * f_number)
    return float(1 / (4 * w @ (2 * j1(z) / z) ** power @ w))


def bandwidth_degrees(linewidth: float, height: float) -> float:
    """Independent patterns that a Gaussian spectrum makes on Gaussian surface heights, seen in reflection.

    linewidth: full width at half maximum [m]; height: standard deviation [m].
    Fields at wave numbers k and k' correlate with exp(-4 (k - k')^2 height^2 / 2); squared and averaged over the
    spectrum (standard deviation s in k) this gives 1 / M = 1 / sqrt(1 + 16 s^2 height^2).
    """
    s = 2 * np.pi * linewidth / _FWHM_PER_SIGMA / WAVELENGTH**2
    return float(np.sqrt(1 + 16 * s**2 * height**2))


def degrees_of_freedom(width: int, settings: ImagerSettings, chip: Chip = OV9282) -> float:
    """Independent exponential patterns whose mean is the light on one pixel of a stream of this width."""
    polarisers = settings.polarisers
    return (
        aperture_degrees(chip.pitch(width), settings.f_number)
        * bandwidth_degrees(settings.laser_linewidth_nm * 1e-9, settings.surface_height_um * 1e-6)
        * (POLARISATIONS if polarisers is None else polarisers.speckle_patterns)
        * settings.laser_modes
    )


def speckle_contrast(width: int, settings: ImagerSettings, chip: Chip = OV9282) -> float:
    """Standard deviation over mean of the projected light in a rectified image of this width [-].

    0.041 at 640 x 360, 0.072 at 1280 x 720 with the default settings.
    """
    return float(np.sqrt(MIXED_VARIANCE / degrees_of_freedom(width, settings, chip)))


def contrast_kept(
    specular_share: Float32[np.ndarray, "*n"], width: int, settings: ImagerSettings, chip: Chip = OV9282
) -> Float32[np.ndarray, "*n"]:
    """Speckle contrast where a share s of the light is coherent, relative to where none is: 0 at s = 1.

    Of a constant and a circular Gaussian field the intensity varies by (1 - s)^2 / M + 2 s (1 - s) / M' of its squared
    mean (Goodman, chapter 3), M and M' as pixels average the scattered light and its interference with the constant.
    """
    pitch, s = chip.pitch(width), specular_share
    ratio = aperture_degrees(pitch, settings.f_number) / aperture_degrees(pitch, settings.f_number, 1)
    return np.sqrt((1 - s) ** 2 + np.float32(2 * ratio) * s * (1 - s))


def speckle(
    height: int,
    width: int,
    settings: ImagerSettings,
    rng: np.random.Generator,
    chip: Chip = OV9282,
    specular_share: Float32[np.ndarray, "h w"] | None = None,
) -> Float32[np.ndarray, "h w"]:
    """Factor of mean 1 on the projected light of every pixel, still for a still camera.

    Gamma distributed before rectification. Grains are smaller than the pixels, so pixels are drawn independently.
    specular_share: of each pixel's light, without speckle; None = 0.
    """
    degrees = degrees_of_freedom(width, settings, chip)
    drawn = rng.standard_gamma(degrees, (height + 1, width + 1), dtype=np.float32) / np.float32(degrees)
    mixed = mix_neighbours(drawn)
    if specular_share is None or not specular_share.any():
        return mixed
    return 1 + contrast_kept(specular_share, width, settings, chip) * (mixed - 1)
