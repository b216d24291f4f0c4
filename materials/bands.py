"""Materials under a kind of light: their numbers there, and the wavelengths at which to evaluate measured files.

A single bounce is exact: its electrons are those of the whole spectrum. Of several bounces each counts by its own mean,
so that light which two coloured surfaces have filtered alike comes out too dark (copper twice under white LEDs: 4 %).
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from materials.lights import REFERENCE_NM, SPECTRUM_NM, Band, electron_weights
from materials.material import Material, Matte, Measured, RoughConductor, RoughPlastic

STEP_NM = 10.0
"""Distance of the wavelengths of `band_weights` [nm]; choice: the means of copper's, brass's and gold's spectra, whose
edges are the steepest, are right to 0.0002."""


def in_band(material: Material, band: Band) -> Material:
    """The material with its numbers under that light: same class, name and roughness, n, k and reflectances replaced.

    It is `material` itself at 850 nm, for a lamp of which it knows nothing (`knows_band`), and for measured files: the
    renderer evaluates those with `band_weights`.
    """
    match material:
        case RoughConductor(lamps=lamps):
            for lamp, numbers in lamps:
                if lamp is band:
                    return replace(
                        material, n=numbers.n, k=numbers.k, oxide_reflectance=numbers.oxide_reflectance, lamps=()
                    )
        case RoughPlastic(lamps=lamps) | Matte(lamps=lamps):
            for lamp, reflectance in lamps:
                if lamp is band:
                    return replace(material, reflectance=reflectance, lamps=())
    return material


def knows_band(material: Material, band: Band) -> bool:
    """Whether the material has numbers of its own under that light; otherwise those at 850 nm stand for them."""
    if isinstance(material, Measured) or band is Band.PROJECTOR:
        return True
    return any(lamp is band for lamp, _ in material.lamps)


def band_weights(
    band: Band, covered_nm: tuple[float, float] = (float(SPECTRUM_NM[0]), float(SPECTRUM_NM[-1]))
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Wavelengths [nm], 10 nm apart, and weights of sum 1 for the mean of a spectrum under that light.

    The mean is exact for spectra that are linear between those wavelengths. covered_nm: of a measured file; weights of
    wavelengths outside are left out and the others take their share, so that a file which covers a part of the lamp's
    spectrum stands for all of it. The projector's light, and a file that covers no such wavelength, have 850 nm alone.
    """
    nodes = np.arange(SPECTRUM_NM[0], SPECTRUM_NM[-1] + 1.0, STEP_NM)
    place = (SPECTRUM_NM - nodes[0]) / STEP_NM
    lower = np.minimum(place.astype(int), len(nodes) - 2)
    share, electrons = place - lower, electron_weights(band)
    weights = np.bincount(lower, (1.0 - share) * electrons, len(nodes))
    weights += np.bincount(lower + 1, share * electrons, len(nodes))
    kept = (weights > 0.0) & (covered_nm[0] <= nodes) & (nodes <= covered_nm[1])
    if not np.any(kept):
        return np.array([REFERENCE_NM]), np.ones(1)
    return nodes[kept], weights[kept] / np.sum(weights[kept])
