"""Lamps: light on the table against a closed form, and the illuminance of the presets."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from materials.input_error import InputError
from materials.lights import Band, imager_radiance_per_luminance, white_led
from materials.material import Matte
from scenes.build import coupon_scene
from scenes.lamps import LIGHTING_NAMES, ceiling_panels, form_integral, lighting, lighting_for
from scenes.scene import Lamp

ORIGIN, UP = np.zeros(3), np.array([0.0, 0.0, 1.0])


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
        lighting_for("own", ceiling_panels(), -5.0, Band.WHITE_LED)


def test_a_scene_carries_the_kind_of_its_lamps():
    """LED panels, a halogen flood; in the dark the materials' numbers under lamps do not matter, so that they are those
    of the projector's light, as in a scene that says nothing."""
    bands = {name: lighting(name).band for name in LIGHTING_NAMES}
    led = dict.fromkeys(("dim", "workshop", "bright"), Band.WHITE_LED)
    assert bands == {"off": Band.PROJECTOR, **led, "halogen": Band.HALOGEN}
    for name, band in bands.items():
        for room in (True, False):
            scene = coupon_scene("plate", Matte("m", 0.5), name, room=room)
            assert scene.lamp_band is band
            assert scene.with_materials(lambda body: body.material).lamp_band is band
    assert lighting_for("none", ceiling_panels(), 0.0, Band.HALOGEN).band is Band.PROJECTOR
