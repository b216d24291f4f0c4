"""The finish table and the relation between slopes and GGX roughness."""

import numpy as np
import pytest

from materials.energy_compensation import albedo_table
from materials.finishes import (
    FINISHES,
    OXIDE_REFLECTANCE,
    alpha_from_profile_slope,
    oxide_reflectance,
    profile_slope_from_alpha,
)
from materials.fresnel import hemispherical_reflectance
from materials.input_error import InputError
from materials.optical_constants import METALS

RAYTEK_EMISSIVITY = {
    "iron": (0.4, 0.9),  # iron 0.4-0.8, cast iron 0.7-0.9, steel 0.8-0.9
    "stainless_ferritic": (0.4, 0.9),
    "stainless_austenitic": (0.4, 0.9),  # as Inconel
    "nickel": (0.4, 0.9),  # 0.8-0.9 at 1.0 um, 0.4-0.7 at 1.6 um
    "copper": (0.2, 0.8),
    "brass": (0.5, 0.7),  # 0.6
    "aluminium": (0.3, 0.5),  # 0.4
    "titanium": (0.6, 0.8),  # at 1.6 um
}
"""Emissivity at 1.0 um of oxidised metals: Raytek, Emissivity table for metals; +-0.1 around single values."""


@pytest.mark.parametrize("name", FINISHES)
def test_nominal_values_lie_inside_their_ranges_and_say_where_they_come_from(name):
    """A study that sweeps the range must pass the nominal value."""
    row = FINISHES[name]
    assert row.range_u[0] <= row.alpha_u <= row.range_u[1]
    assert row.range_v[0] <= row.alpha_v <= row.range_v[1]
    assert "Ward" in row.source or row.source.startswith("choice: ")


def test_marks_make_a_surface_rougher_across_than_along():
    """Grinding, brushing and milling leave grooves along u: slopes across them are steeper."""
    assert {name for name, row in FINISHES.items() if not row.isotropic} == {"ground", "brushed", "milled"}
    assert all(row.alpha_v > row.alpha_u for row in FINISHES.values() if not row.isotropic)


def test_the_measured_sheets_fall_into_the_ranges():
    """Ward 1992, table 1: rolled brass 0.05 x 0.16 (ground), rolled aluminium 0.04 x 0.09 (bright, which has no lay:
    its mean), lightly brushed aluminium 0.088 x 0.13 (brushed)."""
    ground, brushed, bright = FINISHES["ground"], FINISHES["brushed"], FINISHES["bright"]
    assert ground.range_u[0] <= 0.05 <= ground.range_u[1]
    assert ground.range_v[0] <= 0.16 <= ground.range_v[1]
    assert brushed.range_u[0] <= 0.088 <= brushed.range_u[1]
    assert brushed.range_v[0] <= 0.13 <= brushed.range_v[1]
    assert bright.range_u[0] <= (0.04 + 0.09) / 2 <= bright.range_u[1]


def test_profile_slope_of_gaussian_heights_is_alpha_over_root_two():
    """Gaussian heights have normally distributed slopes in x and in y; Beckmann's density of the slopes,
    exp(-(sx^2 + sy^2) / alpha^2) / (pi alpha^2), is that normal density if and only if alpha = sqrt(2) * RMS slope."""
    rms, slopes = 0.2, np.linspace(-1, 1, 41)
    alpha = alpha_from_profile_slope(rms)
    normal = np.exp(-(slopes**2) / (2 * rms**2)) / (2 * np.pi * rms**2)
    beckmann = np.exp(-(slopes**2) / alpha**2) / (np.pi * alpha**2)
    assert normal == pytest.approx(beckmann, rel=1e-12)
    assert profile_slope_from_alpha(alpha) == pytest.approx(rms)


def test_the_median_slope_of_ggx_is_alpha():
    """GGX draws slopes alpha * sqrt(u / (1 - u)) (Walter et al. 2007, eq. 35): at u = 1/2 that is alpha. Checked by the
    integral of its density 1 / (pi alpha^2 (1 + s^2 / alpha^2)^2) up to alpha, which must be one half."""
    alpha, s = 0.3, np.linspace(0.0, 0.3, 100_001)
    density = 1.0 / (np.pi * alpha**2 * (1 + s**2 / alpha**2) ** 2)
    assert np.trapezoid(density * 2 * np.pi * s, s) == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize("metal", RAYTEK_EMISSIVITY)
def test_oxidised_metals_absorb_what_pyrometer_tables_say(metal):
    """An opaque surface absorbs what it does not reflect: 1 - R of half oxide and half rough metal, its multiple
    scattering included (R = E F per bounce, summed), must meet the emissivity measured at 1.0 um."""
    row, finish = METALS[metal], FINISHES["oxidised"]
    fresnel, kept = hemispherical_reflectance(row.n, row.k), albedo_table(finish.alpha_u, finish.alpha_v).mean
    bare = fresnel * kept / (1 - fresnel * (1 - kept))
    reflectance = finish.oxide_share * OXIDE_REFLECTANCE[metal] + (1 - finish.oxide_share) * bare
    low, high = RAYTEK_EMISSIVITY[metal]
    assert low <= 1 - reflectance <= high


def test_gold_does_not_oxidise():
    """Outside what it can be, a material raises."""
    with pytest.raises(InputError, match=r"^gold:oxidised: gold has no known oxide layer; take another finish"):
        oxide_reflectance("gold")
    assert set(OXIDE_REFLECTANCE) == set(METALS) - {"gold"}
