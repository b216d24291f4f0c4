"""Fresnel reflectance against textbook limits and an independent solution with complex angles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from materials.fresnel import (
    conductor_reflectance,
    conductor_reflectance_sp,
    degree_of_polarisation,
    dielectric_reflectance,
    fresnel_amplitudes,
    hemispherical_reflectance,
    normal_reflectance,
)
from materials.optical_constants import METALS

EXACT = 1e-12
ANGLES = np.linspace(0.0, np.pi / 2, 91)


def snell_reflectance(theta, n, k):
    """s and p reflectance by Snell's law with a complex angle of refraction and the textbooks' amplitude ratios."""
    index = n + 1j * k
    cos_i = np.cos(theta)
    cos_t = np.sqrt(1.0 - (np.sin(theta) / index) ** 2 + 0j)
    r_s = (cos_i - index * cos_t) / (cos_i + index * cos_t)
    r_p = (index * cos_i - cos_t) / (index * cos_i + cos_t)
    return np.abs(r_s) ** 2, np.abs(r_p) ** 2


@pytest.mark.parametrize("metal", METALS)
def test_normal_incidence_is_the_textbook_r0(metal):
    """R0 = ((n-1)^2 + k^2) / ((n+1)^2 + k^2), written out here as |(N-1)/(N+1)|^2 with complex N."""
    n, k = METALS[metal].n, METALS[metal].k
    expected = abs((n + 1j * k - 1) / (n + 1j * k + 1)) ** 2
    assert normal_reflectance(n, k) == pytest.approx(expected, abs=EXACT)
    assert conductor_reflectance(np.zeros(1), n, k)[0] == pytest.approx(expected, abs=EXACT)


def test_normal_reflectance_of_published_metals():
    """Handbook reflectances near 850 nm: copper 0.96 and gold 0.98 (Johnson and Christy's own films), aluminium 0.87 at
    its interband dip (Rakic 1995)."""
    published = {"copper": 0.96, "gold": 0.98, "aluminium": 0.87}
    for metal, expected in published.items():
        assert normal_reflectance(METALS[metal].n, METALS[metal].k) == pytest.approx(expected, abs=0.006)


@given(n=st.floats(0.03, 6.0), k=st.floats(0.05, 12.0), theta=st.floats(0.0, np.pi / 2))
def test_metal_agrees_with_complex_snell(n, k, theta):
    """The real-valued formula and complex refraction are the same physics, for each polarisation."""
    expected_s, expected_p = snell_reflectance(np.array([theta]), n, k)
    reflectance_s, reflectance_p = conductor_reflectance_sp(np.array([theta]), n, k)
    assert reflectance_s == pytest.approx(expected_s, abs=1e-9)
    assert reflectance_p == pytest.approx(expected_p, abs=1e-9)


@given(n=st.floats(0.03, 6.0), k=st.floats(0.0, 12.0), theta=st.floats(0.0, 1.57))
def test_amplitudes_are_those_of_complex_snell(n, k, theta):
    """Their squares are the reflectances, the degree of polarisation is what these differ by, and at 45 deg r_p = r_s^2
    for every medium (R. M. A. Azzam, J. Opt. Soc. Am. 69, 1007 (1979)), with p as it is counted here."""
    angle = np.array([theta])
    expected_s, expected_p = snell_reflectance(angle, n, k)
    r_s, r_p = fresnel_amplitudes(angle, n, k)
    assert np.abs(r_s) ** 2 == pytest.approx(expected_s, abs=1e-9)
    assert np.abs(r_p) ** 2 == pytest.approx(expected_p, abs=1e-9)
    if expected_s[0] > 1e-3:
        degree = (expected_s - expected_p) / (expected_s + expected_p)
        assert degree_of_polarisation(angle, n, k) == pytest.approx(degree, abs=1e-6)
    at_45_s, at_45_p = fresnel_amplitudes(np.array([np.pi / 4]), n, k)
    assert at_45_p == pytest.approx(at_45_s**2, abs=1e-9)


def test_s_and_p_are_alike_along_the_normal():
    """There is no plane of incidence: the field turns round in both, and p's axis turns with the light's way."""
    r_s, r_p = fresnel_amplitudes(np.zeros(1), 2.0, 3.0)
    assert r_p == pytest.approx(-r_s, abs=EXACT)
    assert degree_of_polarisation(np.zeros(1), 2.0, 3.0) == pytest.approx(0.0, abs=EXACT)


@given(n=st.floats(1.01, 3.0), theta=st.floats(0.0, np.pi / 2))
def test_dielectric_agrees_with_complex_snell_and_with_the_metal_without_absorption(n, theta):
    """k = 0 leaves Snell's law real; both formulas must meet there."""
    angle = np.array([theta])
    expected = 0.5 * sum(snell_reflectance(angle, n, 0.0))
    assert dielectric_reflectance(angle, n) == pytest.approx(expected, abs=1e-9)
    assert conductor_reflectance(angle, n, 0.0) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("metal", METALS)
def test_grazing_light_is_reflected_wholly(metal):
    """R -> 1 at 90 deg for every medium."""
    row = METALS[metal]
    assert conductor_reflectance(np.array([np.pi / 2]), row.n, row.k)[0] == pytest.approx(1.0, abs=EXACT)
    assert dielectric_reflectance(np.array([np.pi / 2]), 1.5)[0] == pytest.approx(1.0, abs=EXACT)


def test_p_light_vanishes_at_brewsters_angle():
    """tan(theta_B) = n; there only s light is left, R_s = ((n^2-1)/(n^2+1))^2, and the mean is half of it."""
    n = 1.5
    brewster = np.array([np.arctan(n)])
    expected_s = ((n**2 - 1) / (n**2 + 1)) ** 2
    assert conductor_reflectance_sp(brewster, n, 0.0)[1][0] == pytest.approx(0.0, abs=EXACT)
    assert dielectric_reflectance(brewster, n)[0] == pytest.approx(expected_s / 2, abs=EXACT)


@pytest.mark.parametrize("metal", METALS)
def test_s_light_is_reflected_more_than_p_light_and_nothing_is_created(metal):
    """0 <= R_p <= R_s <= 1 at every angle, and R_s rises monotonically (Born and Wolf, section 14.2)."""
    reflectance_s, reflectance_p = conductor_reflectance_sp(ANGLES, METALS[metal].n, METALS[metal].k)
    assert np.all(reflectance_p <= reflectance_s + EXACT)
    assert np.all((reflectance_p >= 0) & (reflectance_s <= 1 + EXACT))
    assert np.all(np.diff(reflectance_s) > 0)


def test_hemispherical_reflectance_of_glass_is_the_published_one():
    """Diffuse light on n = 1.5 from outside: 0.092 in every colour text, and J. W. T. Walsh's closed form of the
    integral (given by S. Q. Duntley, J. Opt. Soc. Am. 32, 61 (1942))."""
    n = 1.5
    walsh = (
        0.5
        + (n - 1) * (3 * n + 1) / (6 * (n + 1) ** 2)
        + n**2 * (n**2 - 1) ** 2 / (n**2 + 1) ** 3 * np.log((n - 1) / (n + 1))
        - 2 * n**3 * (n**2 + 2 * n - 1) / ((n**2 + 1) * (n**4 - 1))
        + 8 * n**4 * (n**4 + 1) / ((n**2 + 1) * (n**4 - 1) ** 2) * np.log(n)
    )
    assert walsh == pytest.approx(0.092, abs=5e-4)
    assert hemispherical_reflectance(n) == pytest.approx(walsh, abs=1e-5)


def test_hemispherical_reflectance_of_a_metal_is_a_plain_integral():
    """2 * integral of R(theta) sin(theta) cos(theta) over the quarter turn, here by the trapezoidal rule in theta."""
    row = METALS["iron"]
    theta = np.linspace(0.0, np.pi / 2, 20001)
    expected = np.trapezoid(2 * sum(snell_reflectance(theta, row.n, row.k)) / 2 * np.sin(theta) * np.cos(theta), theta)
    assert hemispherical_reflectance(row.n, row.k) == pytest.approx(expected, abs=1e-6)
