"""A band-pass filter before the lenses: what it lets through by wavelength and by the angle at which light meets it."""

import numpy as np
from jaxtyping import Float
from pydantic import BaseModel, ConfigDict, Field

from materials.lights import REFERENCE_NM, SPECTRUM_NM, Band, electron_weights

EFFECTIVE_INDEX = 2.13
"""Of the coating, n* in centre(angle) = centre sqrt(1 - (sin angle / n*)^2). Knight Optical's technical notes on
interference filters give the shift as 0.11 sin^2 of the centre, which is n* = 1 / sqrt(2 x 0.11)."""
STEEPNESS = 6
"""Exponent of the band's flanks (choice: 6, a filter of three cavities, the usual make of hard-coated ones)."""


class BandPass(BaseModel):
    """An interference filter over both imagers.

    With it the lamps' light is what they emit around 850 nm: next to nothing of white LEDs, some percent of halogen
    lamps, since most of their light is infrared; and surfaces look under lamps as they do at 850 nm.

    Transmission = peak / (1 + |2 (wavelength - centre) / width|^6). The centre moves to shorter wavelengths with the
    angle of the light: by 6 % at 45 deg, so that a narrow filter loses the projector towards the sides of a wide field.
    Left out: what leaks outside the band (optical density above 5 for the filter below), and that the band widens in
    convergent light. Unknown keys and numbers out of range raise pydantic's ValidationError. The defaults are a
    Thorlabs FBH850-40 (hard-coated, over 90 % at the centre).
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    centre_nm: float = Field(default=850.0, ge=400.0, le=1100.0)
    """Centre of the band for light along the optical axis [nm]."""
    width_nm: float = Field(default=40.0, gt=0.0, le=400.0)
    """Full width at half maximum [nm]."""
    peak_transmission: float = Field(default=0.9, gt=0.0, le=1.0)
    """At the centre [-]."""

    def transmission(
        self, wavelength_nm: Float[np.ndarray, "*n"], sine: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """Share of the light that passes [0, 1]. sine: of the angle between the light and the optical axis."""
        centre = self.centre_nm * np.sqrt(1 - (sine / EFFECTIVE_INDEX) ** 2)
        away = 2 * np.abs(wavelength_nm - centre) / self.width_nm
        return self.peak_transmission / (1 + away**STEEPNESS)

    def passed_share(self, band: Band) -> float:
        """Share of a light's electrons that it leaves on the optical axis [0, 1]; of lamps, summed by nanometres."""
        if band is Band.PROJECTOR:  # a line, not a nanometre of light
            return float(self.transmission(np.array([REFERENCE_NM]), np.zeros(1))[0])
        return float(np.sum(electron_weights(band) * self.transmission(SPECTRUM_NM, np.zeros_like(SPECTRUM_NM))))
