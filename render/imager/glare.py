"""Veiling glare: the share of the light that lenses, cover glass and chip throw about, spread wide over the image.

A point's stray light falls off as (1 + (r / b)^2)^(-3/2) / (2 pi b^2), of integral 1: the form that Jansson and Breault
gave the stray light of imaging systems (Correcting color-measurement error caused by stray light in image scanners,
Color and Imaging Conference 1998), with the one exponent whose Fourier transform is plain, exp(-2 pi b frequency). A
black square of half side a in a white surround then gets, in its middle, the index times 1 - 2/pi asin(a^2 / (a^2 +
b^2)).

What lies beyond the image is not known: it is taken as the image mirrored at its border, so that as much light comes in
as goes out. Left out: ghosts, which are images of bright things, and light from outside the field.
"""

from functools import lru_cache

import cv2
import numpy as np
from jaxtyping import Float32
from scipy.fft import dctn, idctn

from render.imager.chip import OV9282, Chip
from render.imager.settings import ImagerSettings

COARSEST_PX = 16
"""Most pixels along a side of the blocks in which stray light is computed (choice: a fifth of b at 640x360)."""


def with_glare(
    image: Float32[np.ndarray, "h w"], settings: ImagerSettings, chip: Chip = OV9282
) -> Float32[np.ndarray, "h w"]:
    """An image on the chip with `settings.veiling_glare` of its light spread; the sum stays, the unit too."""
    share = settings.veiling_glare
    if share == 0:
        return image
    height, width = image.shape
    rows, columns = _block(height), _block(width)
    coarse = cv2.resize(image, (width // columns, height // rows), interpolation=cv2.INTER_AREA)
    spread = _spectrum(height, width, settings.glare_width_um * 1e-6 / chip.pitch(width))
    veil = np.asarray(idctn(dctn(coarse) * spread), np.float32)
    return cv2.addWeighted(
        image, 1 - share, cv2.resize(veil, (width, height), interpolation=cv2.INTER_LINEAR), share, 0
    )


def _block(pixels: int) -> int:
    """The largest divisor up to COARSEST_PX: whole blocks keep the sum."""
    return max(d for d in range(1, COARSEST_PX + 1) if pixels % d == 0)


@lru_cache(maxsize=8)
def _spectrum(height: int, width: int, reach: float) -> Float32[np.ndarray, "rows columns"]:
    """exp(-2 pi b frequency) at the frequencies of the cosine transform of the blocks; reach: b [px]."""
    rows, columns = height // _block(height), width // _block(width)
    vertical = np.arange(rows)[:, None] / (2 * height)  # cycles a pixel
    horizontal = np.arange(columns)[None, :] / (2 * width)
    return np.exp(-2 * np.pi * reach * np.hypot(vertical, horizontal)).astype(np.float32)
