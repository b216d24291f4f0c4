"""What a near-infrared filter leaves of the lamps' light."""

import numpy as np
import pytest
from scipy.integrate import quad

from materials.band_pass import BandPass, passed_share
from materials.input_error import InputError
from materials.lights import HALOGEN_TEMPERATURE, Band, black_body, quantum_efficiency


def electrons(low: float, high: float) -> float:
    """Of a halogen lamp between two wavelengths, by adaptive quadrature of Planck's law, QE and wavelength."""

    def density(nm: float) -> float:
        at = np.array([nm])
        return float(black_body(HALOGEN_TEMPERATURE, at)[0] * quantum_efficiency(at)[0] * nm)

    return quad(density, low, high, limit=200, points=[x for x in (700.0, 850.0, 900.0) if low < x < high])[0]


@pytest.mark.parametrize(("centre", "width", "peak"), [(850.0, 50.0, 0.9), (850.0, 10.0, 0.85), (860.3, 33.7, 1.0)])
def test_the_share_of_halogen_light_is_its_integral(centre, width, peak):
    """Flat top: peak times the electrons inside, over all of them; integrated here without the grid of 1 nm."""
    expected = peak * electrons(centre - width / 2, centre + width / 2) / electrons(360.0, 1100.0)
    assert passed_share(Band.HALOGEN, BandPass(centre, width, peak)) == pytest.approx(expected, rel=2e-3)


def test_the_share_of_led_light_is_next_to_nothing():
    """The phosphor's Gaussian (580 nm, sigma 70 nm, QE falling 0.46 to 0.325, wavelengths 825 to 875) by hand: below
    0.1 % of what it has at its peak, so that a filter takes the lamps away but not the dots."""
    share = passed_share(Band.WHITE_LED, BandPass())
    assert 0 < share < 1e-3
    assert passed_share(Band.PROJECTOR, BandPass()) == 0.9


def test_a_filter_that_passes_all_passes_all():
    """From 360 to 1100 nm the imager sees everything; half a nanometre at either end lies outside."""
    for band in Band:
        assert passed_share(band, BandPass(730.0, 740.0, 1.0)) == pytest.approx(1.0, abs=1e-3)


def test_two_filters_side_by_side_pass_what_one_of_double_width_does():
    """Shares of electrons add up, wherever the edge falls within a nanometre."""
    halves = [passed_share(Band.HALOGEN, BandPass(centre, 20.6)) for centre in (839.7, 860.3)]
    assert sum(halves) == pytest.approx(passed_share(Band.HALOGEN, BandPass(850.0, 41.2)), rel=1e-9)


def test_a_filter_beside_the_projectors_line_stops_it():
    """A line passes or does not."""
    assert passed_share(Band.PROJECTOR, BandPass(940.0, 50.0)) == 0.0


@pytest.mark.parametrize(
    ("filter_of", "fault"),
    [
        (lambda: BandPass(width_nm=0.0), "0 nm wide around 850 nm; give a band within 360 to 1100 nm"),
        (lambda: BandPass(centre_nm=1200.0), "50 nm wide around 1200 nm; give a band"),
        (lambda: BandPass(centre_nm=float("nan")), "around nan nm; give a band"),
        (lambda: BandPass(peak=1.2), "its transmission is 1.2; give a number from 0 to 1"),
    ],
)
def test_impossible_filters_are_named(filter_of, fault):
    """One line with thing and mend."""
    with pytest.raises(InputError, match=r"^band-pass filter: ") as raised:
        filter_of()
    assert fault in str(raised.value)
