"""Materials under lamps: which numbers change, which stay, and the weights for measured files."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from materials.bands import STEP_NM, band_weights, in_band, knows_band
from materials.catalog import finish_names, material, material_names, matte_twin, metal_names
from materials.fresnel import normal_reflectance
from materials.input_error import InputError
from materials.lights import LAMP_BANDS, SPECTRUM_NM, Band, electron_weights
from materials.material import ConductorNumbers, Material, Matte, Measured, RoughConductor, RoughPlastic

EVERYTHING = (
    *(f"{metal}:{finish}" for metal in metal_names() for finish in finish_names(metal)),
    *material_names()[len(metal_names()) :],
)


def reflectance(surface: Material) -> float:
    """What decides how bright it is: of the metal, of the base or of the paint."""
    if isinstance(surface, RoughConductor):
        return normal_reflectance(surface.n, surface.k)
    assert isinstance(surface, RoughPlastic | Matte)
    return surface.reflectance


@pytest.mark.parametrize("spec", EVERYTHING)
def test_the_projectors_light_leaves_a_material_as_it_is(spec):
    """At 850 nm a material is itself, the same object: what is keyed by it is found again."""
    surface = material(spec)
    assert in_band(surface, Band.PROJECTOR) is surface


@pytest.mark.parametrize("spec", EVERYTHING)
@pytest.mark.parametrize("band", LAMP_BANDS)
def test_every_built_in_material_has_numbers_under_every_lamp(spec, band):
    """Of what the imager gets back of a lamp's light nothing is left to 850 nm; a surface reflects between nothing and
    all of it; shape, name and the way the oxide lies on the metal do not depend on the light."""
    surface = material(spec)
    assert knows_band(surface, band)
    lit = in_band(surface, band)
    assert 0 < reflectance(lit) < 1
    assert type(lit) is type(surface)
    for field in ("name", "alpha_u", "alpha_v", "alpha", "oxide_share"):
        assert getattr(lit, field, None) == getattr(surface, field, None)
    assert hash(lit) == hash(in_band(surface, band))
    assert in_band(lit, band) is lit


@pytest.mark.parametrize("metal", ["copper", "brass", "gold", "nickel", "stainless_austenitic", "iron"])
def test_halogen_lies_between_led_and_850_nm_for_metals_that_get_brighter_towards_the_infrared(metal):
    """Their reflectance rises from the blue to 850 nm in every table; halogen light is the redder one."""
    surface = material(f"{metal}:polished")
    led, halogen = (reflectance(in_band(surface, band)) for band in LAMP_BANDS)
    assert led < halogen < reflectance(surface)


def test_what_is_not_known_under_a_lamp_counts_as_at_850_nm():
    """A surface made by hand has one number; one that names the LED alone has 850 nm under halogen."""
    plain, partly = Matte("m", 0.4), Matte("m", 0.4, ((Band.WHITE_LED, 0.3),))
    assert in_band(plain, Band.WHITE_LED) is plain
    assert not knows_band(plain, Band.WHITE_LED)
    assert in_band(partly, Band.WHITE_LED) == Matte("m", 0.3)
    assert in_band(partly, Band.HALOGEN) is partly
    assert knows_band(partly, Band.PROJECTOR)


def test_a_metal_changes_its_constants_and_its_oxide():
    """All three that depend on the light, nothing else."""
    metal = RoughConductor("m", 3.0, 4.0, 0.1, 0.2, 0.5, 0.1, ((Band.HALOGEN, ConductorNumbers(2.0, 3.0, 0.05)),))
    assert in_band(metal, Band.HALOGEN) == RoughConductor("m", 2.0, 3.0, 0.1, 0.2, 0.5, 0.05)


def test_the_matte_twin_is_one_grey_under_every_light():
    """One twin serves all materials and lamps of a study."""
    twin = matte_twin(material("copper:polished"))
    assert all(in_band(twin, band) is twin for band in Band)


@pytest.mark.parametrize(
    ("make", "fault"),
    [
        (lambda: Matte("x", 0.5, ((Band.WHITE_LED, 1.2),)), "x: reflectance under white_led is 1.2; give a number"),
        (lambda: RoughPlastic("x", 1.5, 0.1, 0.5, ((Band.HALOGEN, -1.0),)), "x: reflectance under halogen is -1"),
        (
            lambda: RoughConductor("x", 2.0, 3.0, 0.1, 0.1, lamps=((Band.HALOGEN, ConductorNumbers(0.0, 3.0)),)),
            "x: n under halogen is 0; give a number from 0.01",
        ),
        (lambda: Matte("x", 0.5, ((Band.PROJECTOR, 0.2),)), "x: has numbers for projector; give each kind of lamp"),
        (lambda: Matte("x", 0.5, ((Band.HALOGEN, 0.2),) * 2), "x: has numbers for halogen, halogen; give each kind"),
    ],
)
def test_no_material_can_be_impossible_under_a_lamp(make, fault):
    """The check sits in the material, for lamps as for 850 nm."""
    with pytest.raises(InputError) as raised:
        make()
    assert str(raised.value).startswith(fault)


@pytest.mark.parametrize("band", LAMP_BANDS)
@given(levels=st.lists(st.floats(0.0, 1.0), min_size=75, max_size=75))
def test_weights_for_measured_files_are_exact_for_spectra_linear_between_them(band, levels):
    """A file's spectrum is linear between its wavelengths; its mean nanometre by nanometre is the definition."""
    wavelengths, weights = band_weights(band)
    spectrum = np.interp(SPECTRUM_NM, wavelengths, levels[: len(wavelengths)])
    assert np.all(np.diff(wavelengths) == STEP_NM)
    expected = float(np.sum(electron_weights(band) * spectrum))
    assert np.sum(weights * levels[: len(wavelengths)]) == pytest.approx(expected, abs=1e-12)


def test_weights_where_a_file_covers_a_part_of_the_light():
    """A grey surface keeps its reflectance whatever is covered (sum 1); nothing outside is asked for; the projector's
    light, and a file without any of those wavelengths, are asked at 850 nm."""
    wavelengths, weights = band_weights(Band.HALOGEN, (400.0, 1000.0))
    whole, all_weights = band_weights(Band.HALOGEN)
    assert (wavelengths[0], wavelengths[-1]) == (400.0, 1000.0)
    assert np.sum(weights) == pytest.approx(1.0)
    kept = all_weights[np.isin(whole, wavelengths)]
    assert weights == pytest.approx(kept / np.sum(kept))
    for band, covered in ((Band.PROJECTOR, (360.0, 1000.0)), (Band.WHITE_LED, (845.0, 848.0))):
        wavelengths, weights = band_weights(band, covered)
        assert (wavelengths.tolist(), weights.tolist()) == ([850.0], [1.0])
    measured = Measured("chrome", Path("chrome.bsdf"))
    assert in_band(measured, Band.WHITE_LED) is measured
    assert knows_band(measured, Band.WHITE_LED)
