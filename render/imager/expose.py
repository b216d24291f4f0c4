"""8-bit infrared images from rendered radiance: speckle, shot and read noise, gain, pedestal, saturation.

Photon counts are drawn as Gaussians: the expected counts exceed 100 wherever shot noise is not far below one grey
value. Not modelled: fixed-pattern noise, dark current, crosstalk, dead pixels, motion.
"""

from functools import cache
from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Float32, UInt8, UInt16
from scipy.special import ndtri

from render.imager.chip import OV9282, Chip
from render.imager.exposure import grey_noise, mean_electrons, mean_grey
from render.imager.lens import MIX_FAR, MIX_NEAR
from render.imager.row_shift import rows_shifted
from render.imager.seen_surfaces import SeenSurfaces
from render.imager.settings import ImagerSettings
from render.imager.speckle import speckle

_SPECKLE_STREAM, _NOISE_STREAM = 0, 1
_WORDS = 4
"""16-bit words in one random 64-bit number."""


def expose(
    projector: Float32[np.ndarray, "h w"],
    ambient: Float32[np.ndarray, "h w"],
    settings: ImagerSettings,
    rng: np.random.Generator,
    chip: Chip = OV9282,
) -> UInt8[np.ndarray, "h w"]:
    """One infrared image [DN]; see `expose_burst` for the layers."""
    mean, noise = _expectation(mean_electrons(projector, ambient, settings, chip), None, settings, rng, chip)
    return _read_frames(mean, noise, 1, rng)[0]


def expose_burst(
    projector: Float32[np.ndarray, "h w"],
    ambient: Float32[np.ndarray, "h w"],
    settings: ImagerSettings,
    n: int,
    seed: int | np.random.SeedSequence,
    chip: Chip = OV9282,
    seen: SeenSurfaces | None = None,
    lamp_share: float = 1.0,
    rows_down: float = 0.0,
) -> UInt8[np.ndarray, "n h w"]:
    """`n` infrared images of a still scene from a still camera [DN].

    projector, ambient: radiance towards one imager [W m^-2 sr^-1] over the whole stream image; the projector's layer at
    a laser power of 150 mW, which `settings.laser_power_mw` scales.
    seed: of this pose *and imager*. Its speckle is the same in all frames; the noise is drawn anew for each. The first
    frames of a longer burst are those of a shorter one, and nothing depends on threads or workers.
    seen, lamp_share: as in `mean_electrons`. rows_down: how much lower than it ought to be the image lies [px].
    """
    electrons = mean_electrons(projector, ambient, settings, chip, seen, lamp_share)
    if rows_down:
        electrons = tuple(rows_shifted(layer, rows_down) for layer in electrons)
    specular = None if seen is None else seen.specular_share
    mean, noise = _expectation(electrons, specular, settings, _generator(seed, _SPECKLE_STREAM), chip)
    return _read_frames(mean, noise, n, _generator(seed, _NOISE_STREAM))


def _expectation(
    electrons: tuple[Float32[np.ndarray, "h w"], ...],
    specular_share: Float32[np.ndarray, "h w"] | None,
    settings: ImagerSettings,
    rng: np.random.Generator,
    chip: Chip,
) -> tuple[Float32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
    """Mean and, before rectification, standard deviation of the grey values with one draw of the speckle [DN].

    electrons: from the projector and from all other light.
    """
    from_projector, from_ambient = electrons
    height, width = from_projector.shape
    total = from_projector * speckle(height, width, settings, rng, chip, specular_share) + from_ambient
    return mean_grey(total, settings), grey_noise(total, settings, chip)


def _generator(seed: int | np.random.SeedSequence, stream: int) -> np.random.Generator:
    """A generator of its own for each use of a seed, which itself stays untouched."""
    root = seed if isinstance(seed, np.random.SeedSequence) else np.random.SeedSequence(seed)
    child = np.random.SeedSequence(root.entropy, spawn_key=(*root.spawn_key, stream))
    return np.random.Generator(np.random.SFC64(child))


def _read_frames(
    mean: Float32[np.ndarray, "h w"], noise: Float32[np.ndarray, "h w"], n: int, rng: np.random.Generator
) -> UInt8[np.ndarray, "n h w"]:
    """Noisy 8-bit frames."""
    height, width = mean.shape
    row_words = -(-(width + 1) // _WORDS) * _WORDS
    frames = np.zeros((n, height, width), np.uint8)
    for frame in frames:
        bits = rng.integers(0, 2**64, (height + 1) * row_words // _WORDS, np.uint64)
        words = bits.view(np.uint16).reshape(height + 1, row_words)
        _read_out(mean, noise, words, normal_quantiles(), np.float32(MIX_NEAR), np.float32(MIX_FAR), frame)
    return frames


@cache
def normal_quantiles() -> Float32[np.ndarray, "65536"]:
    """Standard normal value of each 16-bit random number: mid-quantiles, scaled to variance 1.

    Drawing from it is ten times faster than the ziggurat; no value exceeds 4.3, which rounding to 8 bits hides.
    """
    quantiles = ndtri((np.arange(2**16) + 0.5) / 2**16)
    return (quantiles / quantiles.std()).astype(np.float32)


@no_type_check
@numba.njit(nogil=True, cache=True)
def _read_out(
    mean: Float32[np.ndarray, "h w"],
    noise: Float32[np.ndarray, "h w"],
    words: UInt16[np.ndarray, "h1 w1"],
    quantiles: Float32[np.ndarray, "65536"],
    near: np.float32,
    far: np.float32,
    frame: UInt8[np.ndarray, "h w"],
) -> None:
    """Fill `frame` with round(mean + noise x), x standard normal, mixed as in `render.imager.lens.mix_neighbours`."""
    height, width = mean.shape
    above, row = np.zeros(width, np.float32), np.zeros(width, np.float32)
    for v in range(height + 1):
        left = quantiles[words[v, 0]]
        for u in range(width):
            right = quantiles[words[v, u + 1]]
            row[u] = near * left + far * right
            left = right
        if v > 0:
            for u in range(width):
                grey = mean[v - 1, u] + noise[v - 1, u] * (near * above[u] + far * row[u])
                grey = min(max(grey, np.float32(0.0)), np.float32(255.0))
                frame[v - 1, u] = np.uint8(np.int32(grey + np.float32(0.5)))
        above, row = row, above
