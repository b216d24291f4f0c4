"""Reflectance of non-metals from 360 to 1100 nm as others measured it, and its mean under a kind of light.

The spectra are read off published libraries at the wavelengths below, to three places, so that their means are right to
0.002. Sources: USGS Spectral Library 7 (R. F. Kokaly et al., Data Series 1035, 2017; public domain), samples GDSnnn;
SLUM (S. Kotthaus et al., ISPRS J. Photogramm. Remote Sens. 94, 194, 2014), samples Znnn. They are the samples that the
values at 850 nm come from. What was not found is a choice, made where it is used.
"""

from dataclasses import dataclass

import numpy as np

from materials.lights import LAMP_BANDS, REFERENCE_NM, SPECTRUM_NM, Band, electron_weights

# fmt: off
_FINE_NM = (360, 380, 400, 420, 440, 460, 480, 500, 520, 540, 560, 580, 600, 620, 640, 660, 680, 700, 720, 740, 760,
            780, 800, 850, 900, 950, 1000, 1050, 1100)
_COARSE_NM = (360, 380, 400, 420, 450, 500, 550, 600, 650, 700, 750, 800, 850, 900, 950, 1000, 1050, 1100)
# fmt: on


@dataclass(frozen=True)
class Spectrum:
    """Reflectance by wavelength, linear between its points and constant beyond them.

    Measured near the normal, the mirror reflection of a glossy surface included or not as its user says.
    """

    wavelength_nm: tuple[float, ...]
    """Rising [nm]."""
    reflectance: tuple[float, ...]
    """At those wavelengths [0, 1]."""

    def mean(self, band: Band) -> float:
        """As the imager sees it under that light: weighted by the electrons of each nanometre; at 850 nm, the value."""
        values = np.interp(SPECTRUM_NM, self.wavelength_nm, self.reflectance)
        return float(np.sum(electron_weights(band) * values))

    def under_lamps(self) -> tuple[tuple[Band, float], ...]:
        """Its mean under each kind of lamp, to three places."""
        return tuple((band, round(self.mean(band), 3)) for band in LAMP_BANDS)

    def less(self, mirror: float) -> "Spectrum":
        """Without the mirror reflection of a coat that the measurement includes."""
        return Spectrum(self.wavelength_nm, tuple(max(value - mirror, 0.0) for value in self.reflectance))

    def scaled_to(self, reflectance: float) -> "Spectrum":
        """The same colour, brighter or darker, with that reflectance at 850 nm."""
        factor = reflectance / float(np.interp(REFERENCE_NM, self.wavelength_nm, self.reflectance))
        return Spectrum(self.wavelength_nm, tuple(factor * value for value in self.reflectance))


def grey(reflectance: float) -> Spectrum:
    """The same at all wavelengths."""
    return Spectrum((REFERENCE_NM,), (reflectance,))


# fmt: off
NEW_PINE = Spectrum(_FINE_NM, (
    0.069, 0.086, 0.128, 0.181, 0.213, 0.235, 0.253, 0.272, 0.292, 0.316, 0.342, 0.368, 0.394, 0.422, 0.449, 0.475,
    0.498, 0.520, 0.541, 0.559, 0.574, 0.587, 0.600, 0.634, 0.658, 0.669, 0.658, 0.670, 0.682))
"""GDS363, a new pine beam."""
GREEN_PAINT = Spectrum(_FINE_NM, (
    0.037, 0.073, 0.251, 0.443, 0.458, 0.472, 0.475, 0.480, 0.498, 0.519, 0.526, 0.527, 0.526, 0.523, 0.519, 0.513,
    0.505, 0.502, 0.497, 0.491, 0.485, 0.479, 0.473, 0.458, 0.444, 0.430, 0.415, 0.402, 0.388))
"""GDS333, light grey-green paint on aluminium."""
GREY_CONCRETE = Spectrum(_FINE_NM, (
    0.155, 0.168, 0.184, 0.199, 0.216, 0.229, 0.239, 0.251, 0.266, 0.280, 0.292, 0.302, 0.308, 0.311, 0.313, 0.315,
    0.316, 0.317, 0.318, 0.318, 0.318, 0.318, 0.317, 0.313, 0.311, 0.310, 0.310, 0.310, 0.311))
"""GDS375, light grey road concrete."""
WHITE_PVC = Spectrum(_FINE_NM, (
    0.088, 0.132, 0.349, 0.575, 0.606, 0.624, 0.639, 0.651, 0.658, 0.661, 0.662, 0.665, 0.666, 0.673, 0.684, 0.695,
    0.703, 0.707, 0.708, 0.707, 0.708, 0.708, 0.707, 0.705, 0.680, 0.694, 0.689, 0.670, 0.678))
"""GDS338, white PVC; titania, which absorbs below 420 nm."""
BLACK_PET = Spectrum(_FINE_NM, (
    0.080, 0.077, 0.074, 0.072, 0.071, 0.070, 0.069, 0.068, 0.067, 0.067, 0.067, 0.066, 0.066, 0.066, 0.065, 0.065,
    0.065, 0.065, 0.065, 0.065, 0.065, 0.065, 0.064, 0.064, 0.063, 0.063, 0.063, 0.062, 0.062))
"""GDS382, black PET, its mirror reflection included; carbon black."""
GREY_PAINT = Spectrum(_COARSE_NM, (
    0.043, 0.065, 0.124, 0.139, 0.139, 0.135, 0.122, 0.110, 0.106, 0.103, 0.098, 0.097, 0.102, 0.117, 0.144, 0.165,
    0.161, 0.143))
"""Z005, metal sheet painted grey."""
BLACK_IRON = Spectrum(_COARSE_NM, (
    0.043, 0.043, 0.044, 0.045, 0.047, 0.048, 0.050, 0.052, 0.052, 0.053, 0.054, 0.055, 0.056, 0.056, 0.058, 0.059,
    0.059, 0.059))
"""Z008, weathered iron: black oxide."""
# fmt: on
