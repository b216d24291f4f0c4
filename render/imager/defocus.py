"""Defocus of a fixed lens: how large a point's disc is by its distance, and an image blurred pixel by pixel with it.

A thin lens of focal length f and f-number N, focused at z_f, images a point at z as a disc of diameter

    c = f^2 / N |1 / z - 1 / z_f|,   z >> f,

which the f/2 pupil fills evenly (geometrical optics: diffraction, about 2 um, is in the lens's own point spread). The
image is blurred with a few discs of fixed size, and every pixel takes the mean of the two next to its own, weighted so
that the variance c^2 / 16 is exact. Within a disc's reach of an edge the nearer surface decides the disc.

That keeps a uniform image uniform, and the energy of all that lies at one depth. Left out: what a near thing's blurred
rim lets through of the background that it hides (up to half of what a pixel beside the rim gets, in a seam as wide as
the disc), and that mirrored things are as far as their virtual images: they get the mirror's own blur, at 0.15 m 1.6 px
of 640x360 where dots mirrored from 0.15 m farther away would have 0.5 px.
"""

from dataclasses import dataclass
from functools import cache
from typing import cast, no_type_check

import cv2
import numba
import numpy as np
from jaxtyping import Float32, Float64, UInt8
from scipy.optimize import brentq

from render.imager.chip import OV9282, Chip
from render.imager.settings import ImagerSettings

DISC_DIAMETERS_PX = (0.0, 0.75, 1.5, 2.25, 3.0, 4.0, 5.5, 7.5, 10.0, 14.0, 20.0)
"""Of the discs that images are blurred with [px]. A larger one counts as 20 px, which a point 17 mm before the lenses
has at 640x360."""
_CHORDS = 200
"""Lines by which a disc is drawn, for each pixel it covers."""


def hyperfocal_distance(settings: ImagerSettings, chip: Chip = OV9282) -> float:
    """Distance of focus at which infinity is blurred by one native pixel [m]: f^2 / (N p)."""
    return chip.focal_length**2 / (settings.f_number * chip.pixel_pitch)


def disc_diameter_px(
    inverse_depth: Float32[np.ndarray, "h w"], settings: ImagerSettings, chip: Chip = OV9282
) -> Float32[np.ndarray, "h w"]:
    """Diameter of the disc of a point at each pixel's depth, in pixels of this stream. inverse_depth: [1/m]."""
    focus = settings.focus_distance or hyperfocal_distance(settings, chip)
    scale = chip.focal_length**2 / settings.f_number / chip.pitch(inverse_depth.shape[1])
    return np.float32(scale) * np.abs(inverse_depth - np.float32(1 / focus))


@dataclass(frozen=True, eq=False)
class DiscMap:
    """Every pixel's disc as a mean of two of `DISC_DIAMETERS_PX`."""

    lower: UInt8[np.ndarray, "h w"]
    """Number of the smaller one."""
    upper_share: Float32[np.ndarray, "h w"]
    """Weight of the next larger one [0, 1]."""


def disc_map(inverse_depth: Float32[np.ndarray, "h w"], settings: ImagerSettings, chip: Chip = OV9282) -> DiscMap:
    """The disc of each pixel's depth [1/m], or of a nearer surface's whose disc reaches the pixel."""
    own = disc_diameter_px(inverse_depth, settings, chip)
    reach = int(np.ceil(min(float(own.max()), DISC_DIAMETERS_PX[-1]) / 2 - 0.5))
    if reach > 0:
        window = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
        own = disc_diameter_px(cv2.dilate(inverse_depth, window), settings, chip)
    lower, upper_share = np.zeros(own.shape, np.uint8), np.zeros(own.shape, np.float32)
    _place(own, np.array(DISC_DIAMETERS_PX, np.float32) ** 2, lower, upper_share)
    return DiscMap(lower, upper_share)


def defocused(image: Float32[np.ndarray, "h w"], discs: DiscMap) -> Float32[np.ndarray, "h w"]:
    """The image, each pixel blurred with its disc."""
    first, last = int(discs.lower.min()), int(discs.lower.max()) + 1
    blurred = np.stack([_blurred(image, diameter) for diameter in DISC_DIAMETERS_PX[first : last + 1]])
    mixed = np.zeros_like(image)
    _mix_levels(blurred, discs.lower, np.uint8(first), discs.upper_share, mixed)
    return mixed


def _blurred(image: Float32[np.ndarray, "h w"], diameter: float) -> Float32[np.ndarray, "h w"]:
    if diameter == 0:
        return image
    return cv2.filter2D(image, cv2.CV_32F, disc_kernel(diameter), borderType=cv2.BORDER_REPLICATE)


@cache
def disc_kernel(diameter: float) -> Float64[np.ndarray, "k k"]:
    """Weights of a disc on pixels: the areas that a disc covers, as large as makes their variance diameter^2 / 16.

    That is the variance of a disc along one axis; the areas of the disc itself would have up to 1/12 px^2 more, since
    the image's pixels are areas already, or, below a pixel, none.
    """
    wanted = diameter**2 / 16
    solved = cast(float, brentq(lambda d: _variance(_covered(d)) - wanted, 1.0, diameter + 1.5, xtol=1e-12))
    return _covered(solved)


def _covered(diameter: float) -> Float64[np.ndarray, "k k"]:
    """Share of a disc that falls on each pixel; its centre is that of the middle one."""
    radius = diameter / 2
    reach = int(np.ceil(max(radius - 0.5, 0)))
    edges = np.arange(-reach, reach + 2) - 0.5
    x = (np.arange(_CHORDS * (2 * reach + 1)) + 0.5) / _CHORDS - reach - 0.5
    half = np.sqrt(np.maximum(radius**2 - x**2, 0))  # half the chord at each x
    below = np.clip(edges[:, None], -half, half)  # (k + 1, x)
    areas = np.diff(below, axis=0).reshape(2 * reach + 1, 2 * reach + 1, _CHORDS).sum(axis=2)
    round_disc = areas + areas.T  # chords are exact along one axis only
    return round_disc / round_disc.sum()


def _variance(kernel: Float64[np.ndarray, "k k"]) -> float:
    """Along one axis [px^2]."""
    offsets = np.arange(len(kernel)) - len(kernel) // 2
    return float(kernel.sum(axis=0) @ offsets**2)


@no_type_check
@numba.njit(nogil=True, cache=True)
def _place(
    diameter: Float32[np.ndarray, "h w"],
    squares: Float32[np.ndarray, "m"],
    lower: UInt8[np.ndarray, "h w"],
    upper_share: Float32[np.ndarray, "h w"],
) -> None:
    """The disc below each pixel's own, and the share of the next one that makes the variance right."""
    last = len(squares) - 1
    for v in range(diameter.shape[0]):
        for u in range(diameter.shape[1]):
            square = min(diameter[v, u] ** 2, squares[last])
            k = 0
            while k < last - 1 and square > squares[k + 1]:
                k += 1
            lower[v, u] = k
            upper_share[v, u] = (square - squares[k]) / (squares[k + 1] - squares[k])


@no_type_check
@numba.njit(nogil=True, cache=True)
def _mix_levels(
    levels: Float32[np.ndarray, "m h w"],
    lower: UInt8[np.ndarray, "h w"],
    first: np.uint8,
    upper_share: Float32[np.ndarray, "h w"],
    out: Float32[np.ndarray, "h w"],
) -> None:
    for v in range(out.shape[0]):
        for u in range(out.shape[1]):
            level = np.int64(lower[v, u]) - np.int64(first)
            below = levels[level, v, u]
            out[v, u] = below + upper_share[v, u] * (levels[level + 1, v, u] - below)
