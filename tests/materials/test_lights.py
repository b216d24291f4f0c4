"""Spectra of lamps and how the imager weighs them: photometry against published efficacies."""

import numpy as np
import pytest

from materials.lights import (
    LAMP_BANDS,
    LUMINOUS_EFFICACY,
    SPECTRUM_NM,
    Band,
    black_body,
    electron_weights,
    halogen,
    imager_radiance_per_luminance,
    luminosity,
    quantum_efficiency,
    white_led,
)


def test_eye_sensitivity_has_its_published_values():
    """CIE 1924: V is 1 at 555 nm, 0.503 at 510 and at 610 nm, with an integral of 106.86 nm; the fit keeps 2 %."""
    assert luminosity(np.array([555.0]))[0] == pytest.approx(1.0, abs=0.01)
    assert luminosity(np.array([510.0]))[0] == pytest.approx(0.503, abs=0.02)
    assert luminosity(np.array([610.0]))[0] == pytest.approx(0.503, abs=0.02)
    assert np.trapezoid(luminosity(SPECTRUM_NM), SPECTRUM_NM) == pytest.approx(106.86, rel=0.01)


@pytest.mark.parametrize(("temperature", "lumens_per_watt"), [(4000, 54.7), (5800, 93.0), (7000, 95.0)])
def test_black_body_has_its_published_efficacy(temperature, lumens_per_watt):
    """Ideal black bodies: 54.7 lm/W at 4000 K, 93 at 5800 K, 95 at 7000 K (tables of luminous efficacy), all
    wavelengths counted."""
    wavelength = np.arange(200.0, 100_000.0)
    spectrum = black_body(temperature, wavelength)
    seen = LUMINOUS_EFFICACY * np.trapezoid(spectrum * luminosity(wavelength), wavelength)
    assert seen / np.trapezoid(spectrum, wavelength) == pytest.approx(lumens_per_watt, rel=0.015)


def test_black_body_obeys_stefan_and_boltzmann():
    """Radiance over all wavelengths is sigma T^4 / pi; sigma = 5.670374e-8."""
    wavelength = np.geomspace(50.0, 1e7, 20_000)
    total = np.trapezoid(black_body(3000.0, wavelength), wavelength)
    assert total == pytest.approx(5.670374e-8 * 3000**4 / np.pi, rel=1e-4)


def test_light_at_850_nm_counts_as_itself():
    """A narrow line at 850 nm of radiance 1 is 1 to the imager, and one at 550 nm counts 0.8 / 0.38 x 550 / 850."""
    for line, weight in ((850.0, 1.0), (550.0, 0.8 / 0.38 * 550 / 850)):
        spectrum = np.where(line == SPECTRUM_NM, 1.0, 0.0)  # one sample of 1 nm: radiance 1
        luminance = LUMINOUS_EFFICACY * luminosity(np.array([line]))[0]
        assert imager_radiance_per_luminance(spectrum) * luminance == pytest.approx(weight, rel=1e-9)


def test_lamp_spectra_are_those_of_real_lamps():
    """White LEDs give 250 to 370 lm per radiant watt (Murphy 2012). A halogen lamp of the same luminance is several
    times brighter to silicon. Silicon sees nothing beyond 1.1 um."""
    spectrum = white_led()
    seen = LUMINOUS_EFFICACY * np.trapezoid(spectrum * luminosity(SPECTRUM_NM), SPECTRUM_NM)
    assert 280 < seen / np.trapezoid(spectrum, SPECTRUM_NM) < 340
    assert 3 < imager_radiance_per_luminance(halogen()) / imager_radiance_per_luminance(white_led()) < 5
    assert quantum_efficiency(np.array([850.0, 1100.0])).tolist() == [0.38, 0.0]


@pytest.mark.parametrize("band", Band)
def test_weights_of_electrons_make_the_850_nm_equivalent_radiance(band):
    """A grey surface's mean reflectance is its own: the weights have sum 1. A surface that reflects one wavelength
    alone sends as many electrons as that wavelength's light would, by the definition of the equivalent radiance."""
    weights = electron_weights(band)
    assert np.sum(weights) == pytest.approx(1.0)
    assert np.all(weights >= 0)
    if band is Band.PROJECTOR:
        assert SPECTRUM_NM[np.flatnonzero(weights)].tolist() == [850.0]
        return
    spectrum = white_led() if band is Band.WHITE_LED else halogen()
    only = np.where(SPECTRUM_NM == 600.0, spectrum, 0.0)
    one, whole = (
        imager_radiance_per_luminance(s) * np.trapezoid(s * luminosity(SPECTRUM_NM), SPECTRUM_NM)
        for s in (only, spectrum)
    )
    # Sum and trapezium differ at the ends.
    assert weights[SPECTRUM_NM == 600.0][0] == pytest.approx(one / whole, rel=1e-3)


def test_halogen_light_is_mostly_infrared_to_the_imager_and_led_light_is_not():
    """By hand: of a 3000 K black body's electrons in silicon most come from beyond 700 nm; of a white LED's under 5 %,
    as its phosphor ends there."""
    beyond = {band: float(np.sum(electron_weights(band)[SPECTRUM_NM > 700])) for band in LAMP_BANDS}
    assert beyond[Band.HALOGEN] > 0.5
    assert beyond[Band.WHITE_LED] < 0.05
