"""Settings of the sensor: a preset's content goes where it belongs, and only its content counts."""

import json

import pytest
from pydantic import ValidationError

from materials.input_error import InputError
from render.matcher.d400_preset import preset_by_name
from render.matcher.sgbm import SgbmMatcher
from render.sensor import SensorSettings

EXPORTED = {
    "param-secondpeakdelta": "647",
    "param-depthunits": "100",
    "param-disparityshift": "20",
    "param-depthclampmin": "500",
    "param-depthclampmax": "65536",
    "param-autoexposure-setpoint": "1600",
    "controls-laserpower": "240",
    "controls-laserstate": "on",
    "controls-autoexposure-auto": "False",
    "controls-autoexposure-manual": "5000",
    "controls-depth-gain": "32",
    "param-lambdacensus": "26",
}
"""As the viewer writes numbers and words."""


def test_named_presets_are_one_whatever_their_spelling():
    """`High Accuracy` of the viewer's menu is `high_accuracy`; an unknown name is refused where it is given."""
    assert SensorSettings(preset="High Accuracy") == SensorSettings(preset="high_accuracy")
    with pytest.raises(ValidationError, match="did you mean high_density"):
        SensorSettings(preset="high_densty")


def test_a_file_sets_what_it_names(tmp_path):
    """Units of 100 um, clamps in them, 1600 of 4096 as 100 of 256 DN, laser, exposure and gain as they are."""
    path = tmp_path / "own.json"
    path.write_text(json.dumps({"parameters": EXPORTED}))
    resolved = SensorSettings(preset=str(path)).resolved()
    assert (resolved.depth.unit, resolved.depth.clamp_min, resolved.depth.clamp_max) == (1e-4, 500, 65535)
    imager = resolved.imager
    assert (imager.set_point, imager.laser_power_mw, imager.exposure_us, imager.gain) == (100, 240, 5000, 32)
    assert not resolved.auto_exposure
    assert json.loads(resolved.preset) == {"param-disparityshift": 20, "param-secondpeakdelta": 647}
    assert resolved.resolved() == resolved


def test_a_laser_that_is_off_has_no_power():
    """`controls-laserstate` beats the power that it would have."""
    text = json.dumps({"controls-laserstate": "off", "controls-laserpower": "150"})
    assert SensorSettings(preset=text).resolved().imager.laser_power_mw == 0


def test_what_was_changed_after_it_stays():
    """As in the viewer, a setting that is changed beside a preset is the later word."""
    settings = SensorSettings(preset=json.dumps(EXPORTED), imager={"laser_power_mw": 60}, depth={"unit": 5e-4})
    resolved = settings.resolved()
    assert (resolved.imager.laser_power_mw, resolved.depth.unit) == (60, 5e-4)


def test_content_decides_not_the_path(tmp_path):
    """The same values under another name, in another order, inside another object are the same settings."""
    for name, content in (("a", EXPORTED), ("b", {"viewer": {}, "parameters": dict(reversed(EXPORTED.items()))})):
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    one, other = (SensorSettings(preset=str(tmp_path / f"{name}.json")).resolved() for name in "ab")
    assert one == other
    (tmp_path / "b.json").write_text(json.dumps(EXPORTED | {"param-secondpeakdelta": "646"}))
    assert SensorSettings(preset=str(tmp_path / "b.json")).resolved() != one


def test_the_matcher_is_the_preset_s(tmp_path):
    """By name, and by a file; OpenCV's has of it where the search begins, which the rig tells."""
    assert SensorSettings(preset="hand").stereo_matcher.settings == preset_by_name("hand").settings
    shifted = SensorSettings(preset=json.dumps(EXPORTED))
    for matcher in ("d4", "sgbm"):
        settings = shifted.model_copy(update={"matcher": matcher})
        assert (settings.rig.disparity_shift, settings.stereo_matcher == SgbmMatcher()) == (20, matcher == "sgbm")
    with pytest.raises(InputError, match="no such preset file"):
        SensorSettings(preset=str(tmp_path / "none.json")).resolved()


def test_light_hangs_on_what_stands_before_the_chip_alone():
    """Laser, exposure, matcher and coding leave the rendered light as it is; profile, model, dots and films do not."""
    camera = SensorSettings().resolved()
    dim = {"auto_exposure": False, "imager": {"laser_power_mw": 30.0}}
    same = SensorSettings.model_validate({"preset": "hand", "decimation": 2, "crop": None, **dim})
    assert same.resolved().light == camera.light
    films = {"polarisers": {"imagers_deg": 0.0}}
    for other in ({"profile": "848x480"}, {"model": "d415"}, {"dot_fwhm_px": 4.0}, {"imager": films}):
        assert SensorSettings.model_validate(other).resolved().light != camera.light
