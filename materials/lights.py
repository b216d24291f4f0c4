"""The kinds of light that there are, and how an infrared imager without a band-pass filter weighs their wavelengths.

The imager's model counts photons as if all were at 850 nm. A lamp's spectral radiance L(lambda) frees
integral L QE lambda dlambda / (h c) electrons per area, time and solid angle, so it counts as much as the radiance

    L_850 = integral L(lambda) QE(lambda) lambda dlambda / (QE(850) 850 nm)

at 850 nm. Its luminance is 683 lm/W integral L V dlambda (CIE 1924). Their ratio depends on the spectrum alone. What a
surface reflects of that light counts by its mean reflectance with the weight L QE lambda (`electron_weights`).
"""

from enum import Enum

import numpy as np
from jaxtyping import Float

SPECTRUM_NM = np.arange(360.0, 1101.0, 1.0)
"""From the edge of V(lambda) to the band edge of silicon [nm]."""
LUMINOUS_EFFICACY = 683.0
"""K_cd, defines the candela [lm/W], SI brochure 2019."""
REFERENCE_NM = 850.0
"""Nominal wavelength of the D400 infrared projector (Intel RealSense D400 series datasheet) [nm]."""


class Band(Enum):
    """The wavelengths of a kind of light, as the imager weighs them; materials have their numbers under each."""

    PROJECTOR = "projector"
    """The dot projector's laser, 850 nm; also light of which nothing else is known."""
    WHITE_LED = "white_led"
    """White phosphor LEDs (`white_led`)."""
    HALOGEN = "halogen"
    """A black body at the temperature of a halogen lamp's filament (`halogen`)."""


LAMP_BANDS = (Band.WHITE_LED, Band.HALOGEN)
"""Those of lamps: all but the projector's."""

_QE_NM = (360, 400, 450, 500, 550, 600, 650, 700, 750, 800, 850, 900, 940, 1000, 1050, 1100)
_QE = (0.30, 0.45, 0.65, 0.76, 0.80, 0.79, 0.74, 0.67, 0.58, 0.48, 0.38, 0.27, 0.19, 0.08, 0.02, 0.0)
"""Quantum efficiency of an OV9282-like pixel: 0.38 at 850 nm and about 0.8 at 550 nm are known; between them the
usual fall of silicon by 0.1 per 50 nm (choice, +-15 %)."""

HALOGEN_TEMPERATURE = 3000.0
"""Filament temperature of a halogen flood [K] (lamps are sold as 2900 to 3100 K)."""


def imager_radiance_per_luminance(spectrum: Float[np.ndarray, "w"]) -> float:
    """850 nm-equivalent radiance per luminance [W m^-2 sr^-1 per cd m^-2] of a lamp with this spectral shape."""
    electrons = np.trapezoid(spectrum * quantum_efficiency(SPECTRUM_NM) * SPECTRUM_NM, SPECTRUM_NM)
    radiance = electrons / (quantum_efficiency(np.array([REFERENCE_NM]))[0] * REFERENCE_NM)
    luminance = LUMINOUS_EFFICACY * np.trapezoid(spectrum * luminosity(SPECTRUM_NM), SPECTRUM_NM)
    return float(radiance / luminance)


def quantum_efficiency(wavelength_nm: Float[np.ndarray, "w"]) -> Float[np.ndarray, "w"]:
    """Electrons per photon of the imager [-]."""
    return np.interp(wavelength_nm, _QE_NM, _QE)


def luminosity(wavelength_nm: Float[np.ndarray, "w"]) -> Float[np.ndarray, "w"]:
    """Sensitivity of the eye V(lambda) [-], two-lobe fit of Wyman, Sloan and Shirley (JCGT 2, 2013, table 1)."""

    def lobe(height: float, centre: float, below: float, above: float) -> Float[np.ndarray, "w"]:
        width = np.where(wavelength_nm < centre, below, above)
        return height * np.exp(-0.5 * ((wavelength_nm - centre) * width) ** 2)

    return lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322)


def white_led() -> Float[np.ndarray, "w"]:
    """Relative spectral radiance of a neutral white phosphor LED: blue die at 450 nm, phosphor around 580 nm.

    Two Gaussians (choice) with the widths of common parts; the result, 317 lm per radiant watt, lies where
    measured white LEDs do (250 to 370 lm/W, Murphy, J. Appl. Phys. 111, 104909, 2012). Almost none of it is at 850 nm.
    """
    blue = 0.9 * np.exp(-0.5 * ((SPECTRUM_NM - 450) / 11) ** 2)
    width = np.where(SPECTRUM_NM < 580, 55.0, 70.0)
    return blue + np.exp(-0.5 * ((SPECTRUM_NM - 580) / width) ** 2)


def black_body(temperature: float, wavelength_nm: Float[np.ndarray, "w"] = SPECTRUM_NM) -> Float[np.ndarray, "w"]:
    """Planck's spectral radiance at `temperature` [K], W m^-2 sr^-1 nm^-1."""
    h, c, k_b = 6.62607015e-34, 299792458.0, 1.380649e-23  # exact, SI 2019
    metres = wavelength_nm * 1e-9
    return 2e-9 * h * c**2 / (metres**5 * np.expm1(h * c / (metres * k_b * temperature)))


def halogen() -> Float[np.ndarray, "w"]:
    """Spectral radiance of a halogen lamp: a black body at filament temperature."""
    return black_body(HALOGEN_TEMPERATURE)


def lamp_spectrum(band: Band) -> Float[np.ndarray, "w"]:
    """Relative spectral radiance at `SPECTRUM_NM` of a kind of lamp; the projector's is one line of 1 nm."""
    match band:
        case Band.WHITE_LED:
            return white_led()
        case Band.HALOGEN:
            return halogen()
        case Band.PROJECTOR:
            return np.where(SPECTRUM_NM == REFERENCE_NM, 1.0, 0.0)


def electron_weights(band: Band) -> Float[np.ndarray, "w"]:
    """Share of the electrons that each nanometre of `SPECTRUM_NM` frees in the imager: L QE lambda, with sum 1."""
    electrons = lamp_spectrum(band) * quantum_efficiency(SPECTRUM_NM) * SPECTRUM_NM
    return electrons / np.sum(electrons)
