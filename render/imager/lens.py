"""What lens and rectification do to an image: filter, blur, vignetting, glare, and mixing of neighbouring pixels."""

from functools import lru_cache

import cv2
import numpy as np
from jaxtyping import Float32, Float64
from scipy.special import ive

from render.imager.band_pass import BandPass
from render.imager.chip import OV9282, Chip
from render.imager.defocus import DiscMap, defocused
from render.imager.glare import with_glare
from render.imager.settings import WAVELENGTH, ImagerSettings

MIX_NEAR = (1 + 1 / np.sqrt(3)) / 2
"""Weight of the nearer of two neighbours in the mean rectification; see `MIX_FAR`."""
MIX_FAR = 1 - MIX_NEAR
"""Weight of the farther one. The camera rectifies by bilinear interpolation whose sub-pixel phase t drifts over the
image. Over uniform t the variance of (1 - t) a + t b is E[(1 - t)^2 + t^2] = 2/3 of a pixel's and its covariance with
the next one is E[t (1 - t)] = 1/6: just what the two fixed weights give (squares sum to 2/3, product 1/6)."""
MIXED_VARIANCE = (MIX_NEAR**2 + MIX_FAR**2) ** 2
"""Variance of a pixel mixed along both axes, in units of one before: 4/9."""
RECTIFICATION_VARIANCE = 1 / 6
"""Blur of bilinear interpolation along one axis [px^2]: its kernel has variance t (1 - t), E = 1/6."""
_KERNEL_REACH = 4.0


def blur_sigma_px(width: int, settings: ImagerSettings, chip: Chip = OV9282) -> float:
    """Standard deviation of the point spread of lens and rectification in focus, in pixels of a stream of this width.

    0.55 px at 640 x 360 (1.3 px full width at half maximum); the pixel's own aperture is the renderer's box filter.
    """
    lens = settings.lens_sigma_um * 1e-6 / chip.pitch(width)
    return float(np.sqrt(lens**2 + RECTIFICATION_VARIANCE))


def _tan_squared(height: int, width: int, chip: Chip) -> Float64[np.ndarray, "h w"]:
    """Squared tangent of each pixel's field angle; the axis meets the image centre."""
    scale = chip.pitch(width) / chip.focal_length
    x = (np.arange(width) - (width - 1) / 2) * scale
    y = (np.arange(height) - (height - 1) / 2) * scale
    return x[None, :] ** 2 + y[:, None] ** 2


@lru_cache(maxsize=8)
def vignetting(height: int, width: int, exponent: float, chip: Chip = OV9282) -> Float32[np.ndarray, "h w"]:
    """Irradiance relative to the optical axis, cos(field angle)^exponent; the axis meets the image centre."""
    share = ((1 + _tan_squared(height, width, chip)) ** (-exponent / 2)).astype(np.float32)
    share.setflags(write=False)
    return share


def projector_through(band_pass: BandPass, height: int, width: int, chip: Chip = OV9282) -> Float32[np.ndarray, "h w"]:
    """Share of the projector's light that passes a filter towards each pixel [0, 1]."""
    tan_squared = _tan_squared(height, width, chip)
    sine = np.sqrt(tan_squared / (1 + tan_squared))
    return band_pass.transmission(np.full_like(sine, WAVELENGTH * 1e9), sine).astype(np.float32)


def through_lens(
    radiance: Float32[np.ndarray, "h w"], settings: ImagerSettings, chip: Chip = OV9282, discs: DiscMap | None = None
) -> Float32[np.ndarray, "h w"]:
    """Radiance of the full stream image, blurred, vignetted and under glare, same unit. Applied before saturation.

    discs: the defocus of each pixel; None: all in focus. The rectification blurs after saturation in a camera: only the
    rim of saturated areas notices.
    """
    height, width = radiance.shape
    kernel = _gaussian_kernel(blur_sigma_px(width, settings, chip))
    blurred = cv2.sepFilter2D(radiance, cv2.CV_32F, kernel, kernel, borderType=cv2.BORDER_REPLICATE)
    if discs is not None:
        blurred = defocused(blurred, discs)
    return with_glare(blurred * vignetting(height, width, settings.vignetting_exponent, chip), settings, chip)


def _gaussian_kernel(sigma: float) -> Float64[np.ndarray, "k"]:
    """The discrete Gaussian exp(-t) I_n(t), t = sigma^2 (Lindeberg 1990).

    Its variance is sigma^2 exactly; a sampled Gaussian as narrow as this one would lack 6 %.
    """
    reach = int(np.ceil(_KERNEL_REACH * sigma)) + 1
    kernel = ive(np.abs(np.arange(-reach, reach + 1)), sigma**2)
    return kernel / kernel.sum()


def mix_neighbours(independent: Float32[np.ndarray, "h1 w1"]) -> Float32[np.ndarray, "h w"]:
    """Independent pixel values as a rectified image of one row and column less shows them.

    Variance 4/9 of theirs, correlation of neighbours 1/4, along a diagonal 1/16.
    """
    near, far = np.float32(MIX_NEAR), np.float32(MIX_FAR)
    rows = near * independent[:-1] + far * independent[1:]
    return near * rows[:, :-1] + far * rows[:, 1:]
