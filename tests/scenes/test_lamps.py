"""Lamps: photometry against published efficacies, light on the table against a closed form."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from materials.input_error import InputError
from scenes.lamp_spectra import (
    LUMINOUS_EFFICACY,
    SPECTRUM_NM,
    black_body,
    halogen,
    imager_radiance_per_luminance,
    luminosity,
    quantum_efficiency,
    white_led,
)
from scenes.lamps import LIGHTING_NAMES, ceiling_panels, form_integral, lighting, lighting_for
from scenes.scene import Lamp

ORIGIN, UP = np.zeros(3), np.array([0.0, 0.0, 1.0])


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


def test_light_of_a_panel_overhead_follows_its_closed_form():
    """Rectangle a x b parallel to the receiver at height h, receiver under its centre: form factor of four quarter
    rectangles (Howell, catalogue B-3), times pi for irradiance per radiance."""
    width, height, distance = 0.6, 0.4, 0.9
    x, y = width / 2 / distance, height / 2 / distance
    quarter = (
        x / np.sqrt(1 + x**2) * np.arctan(y / np.sqrt(1 + x**2))
        + y / np.sqrt(1 + y**2) * np.arctan(x / np.sqrt(1 + y**2))
    ) / (2 * np.pi)
    down = Rotation.from_euler("x", 180, degrees=True)
    lamp = Lamp("panel", RigidTransform.from_components([0, 0, distance], down), width, height, 1.0)
    assert form_integral(lamp, ORIGIN, UP) == pytest.approx(4 * quarter * np.pi, rel=1e-3)
    away = Lamp("panel", RigidTransform.from_translation([0, 0, distance]), width, height, 1.0)
    assert form_integral(away, ORIGIN, UP) == 0


def test_preset_gives_its_illuminance():
    """500 lx on the table: dividing the direct irradiance by the radiance-per-luminance gives the lux back. The panels
    are then as bright as real ones, a few thousand cd/m^2."""
    light = lighting("workshop")
    per_luminance = imager_radiance_per_luminance(white_led())
    direct = sum(lamp.radiance * form_integral(lamp, ORIGIN, UP) for lamp in light.lamps)
    assert direct / per_luminance == pytest.approx(500.0)
    assert 1000 < light.lamps[0].radiance / per_luminance < 5000
    assert lighting("bright").lamps[0].radiance == pytest.approx(2 * light.lamps[0].radiance)


@pytest.mark.parametrize("name", LIGHTING_NAMES)
def test_lamps_hang_above_the_table_and_look_down(name):
    """Every lamp shines down from over 1 m; `off` has none and no ambient light."""
    light = lighting(name)
    assert bool(light.lamps) == (name != "off")
    assert (light.ambient_radiance > 0) == (name != "off")
    for lamp in light.lamps:
        assert lamp.T_world_lamp.translation[2] > 1
        assert lamp.T_world_lamp.rotation.apply([0, 0, 1])[2] < -0.5


def test_bad_lamps_are_named():
    """One line with thing and mend."""
    with pytest.raises(InputError, match=r"^lamps workshp: there is no such preset; did you mean workshop\?$"):
        lighting("workshp")
    with pytest.raises(InputError, match=r"^lamps own: illuminance is -5 lx; give a number from 0 up$"):
        lighting_for("own", ceiling_panels(), -5.0, white_led())
