"""The filter before the lenses: band, angle, and what it does to the projector's and to the lamps' light."""

import numpy as np
import pytest
from pydantic import ValidationError

from materials.lights import HALOGEN_TEMPERATURE, Band, black_body, quantum_efficiency
from render.imager.band_pass import BandPass
from render.imager.exposure import mean_electrons
from render.imager.lens import projector_through
from render.imager.settings import ImagerSettings

FILTER = BandPass()


def test_band():
    """Peak at the centre, half of it at half the width, less than a thousandth two widths away."""
    light = np.array([850.0, 830.0, 870.0, 770.0, 930.0])
    share = FILTER.transmission(light, np.zeros(5))
    np.testing.assert_allclose(share[:3], [0.9, 0.45, 0.45], rtol=1e-12)
    assert share[3:].max() < 1e-3


def test_band_moves_with_the_angle():
    """At 45 deg the centre is 850 (1 - 0.11 sin^2 45) = 803 nm by Knight Optical's rule, to 2 nm, the rule's next
    order: there is the peak."""
    sine = np.sin(np.radians(45))
    wavelengths = np.arange(780.0, 850.0, 0.1)
    peak = wavelengths[np.argmax(FILTER.transmission(wavelengths, np.full(wavelengths.shape, sine)))]
    assert peak == pytest.approx(850 * (1 - 0.11 * sine**2), abs=2.0)


def test_a_narrow_filter_takes_the_projector_from_the_sides():
    """On the axis 90 % of the dots' light is left; at 43 deg, where the field ends, a band 40 nm wide lies 43 nm off
    and less than 1 % passes, of one 160 nm wide all but 3 %."""
    narrow, wide = (projector_through(BandPass(width_nm=w), 361, 643) for w in (40.0, 160.0))
    assert narrow[180, 321] == pytest.approx(0.9, rel=1e-4)
    edge = 321 + round(321 * np.tan(np.radians(43)))
    assert narrow[180, edge] < 0.01
    assert wide[180, edge] > 0.97 * 0.9


def test_projector_and_lamps_pass_by_their_own_shares():
    """On the axis the dots' electrons are 0.9 of those without a filter, the lamps' what the caller says."""
    plain = ImagerSettings(vignetting_exponent=0.0, veiling_glare=0.0)
    filtered = plain.model_copy(update={"band_pass": BandPass(width_nm=400.0)})
    light = np.full((9, 13), 0.05, np.float32)
    before, after = mean_electrons(light, light, plain), mean_electrons(light, light, filtered, lamp_share=0.07)
    assert after[0][4, 6] / before[0][4, 6] == pytest.approx(0.9, rel=1e-3)
    assert after[1][4, 6] / before[1][4, 6] == pytest.approx(0.07, rel=1e-5)


def test_bad_filters_are_refused():
    """A peak above 1, a band without width and unknown words do not exist."""
    for wrong in ({"peak_transmission": 1.1}, {"width_nm": 0.0}, {"fwhm_nm": 10.0}):
        with pytest.raises(ValidationError):
            ImagerSettings(band_pass=wrong)


def test_the_share_of_halogen_light_is_its_integral():
    """Electrons of Planck's law, QE and wavelength through the filter, on a grid a hundred times finer."""
    nm = np.arange(360.0, 1100.0, 0.01)
    electrons = black_body(HALOGEN_TEMPERATURE, nm) * quantum_efficiency(nm) * nm
    expected = np.sum(electrons * 0.9 / (1 + np.abs(2 * (nm - 850) / 50) ** 6)) / np.sum(electrons)
    assert BandPass(width_nm=50.0).passed_share(Band.HALOGEN) == pytest.approx(expected, rel=2e-3)


def test_led_light_is_stopped_and_the_projectors_is_not():
    """The phosphor's Gaussian (580 nm, sigma 70 nm) has fallen below 0.1 % of its peak at 850 nm; a filter beside the
    projector's line stops that instead."""
    assert 0 < BandPass(width_nm=50.0).passed_share(Band.WHITE_LED) < 1e-3
    assert BandPass().passed_share(Band.PROJECTOR) == 0.9
    assert BandPass(centre_nm=940.0).passed_share(Band.PROJECTOR) < 1e-3
