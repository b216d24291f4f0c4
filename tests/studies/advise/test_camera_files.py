"""The advised camera as files: what is read back from them is the camera that was meant."""

import json

import yaml

from render.d435i import SensorSettings
from render.matcher.d400_preset import D400_PRESETS
from studies.advise.camera_files import sensor_file, viewer_preset
from studies.advise.factors import set_up_with
from tests.studies.advise.made_up import base, remedy


def test_the_viewers_preset_brings_matcher_laser_and_exposure_back():
    """Loaded over a camera as it comes."""
    chosen = (remedy("preset", "high_accuracy"), remedy("laser", "60 mW"), remedy("exposure", "2000 us at gain 64"))
    text = viewer_preset(set_up_with(base(), chosen))
    assert json.loads(text)["param-secondpeakdelta"] == D400_PRESETS["high_accuracy"]["param-secondpeakdelta"]
    camera = SensorSettings(preset=text).resolved()
    imager = camera.imager
    assert (imager.laser_power_mw, imager.exposure_us, imager.gain) == (60.0, 2000.0, 64.0)
    assert not camera.auto_exposure
    wanted = SensorSettings(preset="high_accuracy").stereo_matcher
    assert camera.stereo_matcher == wanted


def test_the_sensors_file_holds_the_whole_camera_and_names_what_it_cannot_set():
    """Turned by 90 deg beyond a mount's 90 is 180, which is written as -180; a second look is a comment."""
    on_end = base().with_sensor(roll_deg=90.0)
    chosen = (
        remedy("roll", "90 deg"),
        remedy("band-pass filter", "850 nm"),
        remedy("second look", "from 30 deg aside"),
    )
    setup = set_up_with(on_end, (*chosen, remedy("lamps", "off")))
    text = sensor_file(setup, "Part", "do so")
    stored = yaml.safe_load(text)
    camera = SensorSettings.model_validate(stored["sensor"])
    assert camera == setup.sensor.model_copy(update={"roll_deg": -180.0})
    assert stored["lamps"] == "off"
    assert "# Not the sensor's: second:" in text
