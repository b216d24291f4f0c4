"""From radiance to electrons and grey values, and the exposure that gives an image its set-point mean."""

import math
from collections.abc import Callable
from typing import cast

import numpy as np
from jaxtyping import Bool, Float32
from scipy.optimize import brentq

from render.imager.chip import OV9282, Chip
from render.imager.defocus import disc_map
from render.imager.lens import projector_through, through_lens
from render.imager.seen_surfaces import SeenSurfaces
from render.imager.settings import (
    LEAST_GAIN,
    MOST_GAIN,
    REFERENCE_LASER_POWER_MW,
    WAVELENGTH,
    WHITE_LEVEL,
    ImagerSettings,
)

PHOTON_ENERGY = 6.62607015e-34 * 299_792_458.0 / WAVELENGTH
"""h c / lambda [J]."""
AUTO_EXPOSURE_LIMIT_US = 33_000.0
"""Longest exposure that auto-exposure chooses [us] (librealsense: default auto-exposure limit, one frame time)."""
AUTO_EXPOSURE_SHARE = 0.8
"""Share of either image side that auto-exposure averages, about the middle (librealsense maintainers: centred region;
its size is a choice, see `ImagerSettings.set_point`)."""
_STRIDE = 2


def electrons_per_radiance(exposure_us: float, settings: ImagerSettings, chip: Chip = OV9282) -> float:
    """Electrons on one native pixel on the optical axis, per radiance [e- / (W m^-2 sr^-1)].

    Irradiance E = pi L T / (4 N^2), times pixel area, time and quantum efficiency, over the photon energy.
    """
    irradiance = np.pi * settings.transmission / (4 * settings.f_number**2)
    joules = irradiance * chip.pixel_pitch**2 * exposure_us * 1e-6
    return joules * settings.quantum_efficiency / PHOTON_ENERGY


def mean_electrons(
    projector: Float32[np.ndarray, "h w"],
    ambient: Float32[np.ndarray, "h w"],
    settings: ImagerSettings,
    chip: Chip = OV9282,
    seen: SeenSurfaces | None = None,
    lamp_share: float = 1.0,
) -> tuple[Float32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
    """Expected electrons of each native pixel from the projector and from all other light, before saturation.

    projector, ambient: radiance towards one imager [W m^-2 sr^-1], full stream image; the projector's at 150 mW.
    seen: what the pixels see; None: rough surfaces in focus. lamp_share: share of the lamps' electrons that
    `settings.band_pass` lets through, which depends on their spectra.
    """
    laser = settings.laser_power_mw / REFERENCE_LASER_POWER_MW
    from_projector = laser * electrons_per_radiance(settings.laser_on_us, settings, chip)
    from_ambient = lamp_share * electrons_per_radiance(settings.exposure_us, settings, chip)
    if settings.band_pass is not None:
        height, width = projector.shape
        projector = projector * projector_through(settings.band_pass, height, width, chip)
    discs = None if seen is None else disc_map(seen.inverse_depth, settings, chip)
    return (
        np.float32(from_projector) * through_lens(projector, settings, chip, discs),
        np.float32(from_ambient) * through_lens(ambient, settings, chip, discs),
    )


def mean_grey(electrons: Float32[np.ndarray, "h w"], settings: ImagerSettings) -> Float32[np.ndarray, "h w"]:
    """Expected grey value before clipping at white [DN]."""
    return np.float32(settings.pedestal) + np.float32(settings.dn_per_electron) * electrons


def grey_noise(
    electrons: Float32[np.ndarray, "h w"], settings: ImagerSettings, chip: Chip = OV9282
) -> Float32[np.ndarray, "h w"]:
    """Standard deviation of a stream pixel before rectification [DN]: shot and read noise, averaged over native pixels.

    Saturated pixels are clipped afterwards, so that their noise vanishes there.
    """
    variance = (electrons + np.float32(settings.read_noise**2)) / np.float32(chip.native_pixels(electrons.shape[1]))
    return np.float32(settings.dn_per_electron) * np.sqrt(variance)


def auto_exposure(
    projector: Float32[np.ndarray, "h w"],
    ambient: Float32[np.ndarray, "h w"],
    settings: ImagerSettings,
    pixels: Bool[np.ndarray, "h w"] | None = None,
    chip: Chip = OV9282,
    seen: SeenSurfaces | None = None,
    lamp_share: float = 1.0,
) -> tuple[float, float]:
    """Exposure time [us] and gain, both whole numbers, at which the mean grey value of `pixels` meets the set-point.

    Gain stays at 16 until the exposure has reached its limit of 33 ms; what is too bright or too dark for both ends at
    their limits. All but pixels as in `mean_electrons`, of the left imager. pixels: None = the image's middle.
    """
    sample = _middle(*projector.shape) if pixels is None else pixels
    unit = settings.model_copy(update={"exposure_us": 1.0, "laser_pulse_us": None})
    laser_rate, ambient_rate = (
        np.atleast_2d(layer[sample]) for layer in mean_electrons(projector, ambient, unit, chip, seen, lamp_share)
    )

    def excess(exposure_us: float, gain: float) -> float:
        exposed = settings.model_copy(update={"exposure_us": exposure_us, "gain": gain})
        electrons = np.float32(exposed.laser_on_us) * laser_rate + np.float32(exposure_us) * ambient_rate
        return float(np.minimum(mean_grey(electrons, exposed), WHITE_LEVEL).mean(dtype=float)) - settings.set_point

    gain = math.ceil(_root(lambda g: excess(AUTO_EXPOSURE_LIMIT_US, g), LEAST_GAIN, MOST_GAIN))
    return round(_root(lambda t: excess(t, gain), 1.0, AUTO_EXPOSURE_LIMIT_US)), gain


def _root(excess: Callable[[float], float], low: float, high: float) -> float:
    """Where the rising function meets 0, or the end that it comes nearest to.

    Searched on a log scale, since exposures span four decades.
    """
    if excess(low) >= 0:
        return low
    if excess(high) <= 0:
        return high
    return math.exp(cast(float, brentq(lambda x: excess(math.exp(x)), math.log(low), math.log(high), xtol=1e-6)))


def _middle(height: int, width: int) -> tuple[slice, slice]:
    """A sample of the image's region that auto-exposure averages."""
    left, top = round(width * (1 - AUTO_EXPOSURE_SHARE) / 2), round(height * (1 - AUTO_EXPOSURE_SHARE) / 2)
    return slice(top, height - top, _STRIDE), slice(left, width - left, _STRIDE)
