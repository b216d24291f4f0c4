"""A near-infrared band-pass filter before the imager: what share of a light's electrons it lets pass.

With it the lamps' light is what they emit around 850 nm, so that materials have their numbers at 850 nm under lamps too
(`Band.PROJECTOR`), and the lamps' radiance shrinks by `passed_share`. Under white LEDs next to nothing is left; halogen
lamps keep some percent, because most of their light is infrared.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from materials.input_error import InputError
from materials.lights import REFERENCE_NM, SPECTRUM_NM, Band, electron_weights


@dataclass(frozen=True)
class BandPass:
    """A flat-top filter: `peak` within `width_nm` around `centre_nm`, nothing outside.

    Hard-coated interference filters are that flat (Edmund Optics, application note Optical Filters). It holds for rays
    along the normal: oblique ones see the band at lambda sqrt(1 - (sin(theta) / n)^2), n about 2, 1.5 % lower at 20 deg
    and 6 % at 43 deg, the edge of the field, so that the filter belongs behind the lens. Leaks far from the band are
    left out. Raises InputError for a peak outside [0, 1], or a band that does not lie within 360 to 1100 nm.
    """

    centre_nm: float = REFERENCE_NM
    """Middle of the band [nm]."""
    width_nm: float = 50.0
    """Full width at half of the peak [nm]. Choice: common filters for 850 nm LEDs and lasers are 10 to 70 nm wide."""
    peak: float = 0.9
    """Transmission within the band [0, 1]. Choice: vendors promise 0.8 to above 0.9."""

    def __post_init__(self) -> None:
        low, high = self.centre_nm - self.width_nm / 2, self.centre_nm + self.width_nm / 2
        if not (self.width_nm > 0 and SPECTRUM_NM[0] <= low < high <= SPECTRUM_NM[-1]):
            raise InputError(
                f"band-pass filter: {self.width_nm:g} nm wide around {self.centre_nm:g} nm; "
                "give a band within 360 to 1100 nm"
            )
        if not 0.0 <= self.peak <= 1.0:
            raise InputError(f"band-pass filter: its transmission is {self.peak:g}; give a number from 0 to 1")

    def transmission(self, wavelength_nm: Float[np.ndarray, "w"]) -> Float[np.ndarray, "w"]:
        """Share of the light that passes at each wavelength [nm]."""
        return np.where(np.abs(wavelength_nm - self.centre_nm) <= self.width_nm / 2, self.peak, 0.0)


def passed_share(band: Band, band_pass: BandPass) -> float:
    """Share of the electrons of a light that it frees through the filter, against those without one [0, 1].

    The electrons of each nanometre are spread evenly over it, so that a band of any width is met.
    """
    if band is Band.PROJECTOR:  # a line, not a nanometre of light
        return float(band_pass.transmission(np.array([REFERENCE_NM]))[0])
    low = np.maximum(SPECTRUM_NM - 0.5, band_pass.centre_nm - band_pass.width_nm / 2)
    high = np.minimum(SPECTRUM_NM + 0.5, band_pass.centre_nm + band_pass.width_nm / 2)
    covered = np.clip(high - low, 0.0, 1.0)  # of the nanometre around each wavelength
    return float(np.sum(electron_weights(band) * covered)) * band_pass.peak
