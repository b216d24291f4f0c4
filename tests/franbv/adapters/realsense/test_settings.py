"""What is asked of the camera is what it does, or it says in one line why not; everything is written down."""

import json
import math
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import RigidTransform

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.decimation import settle_decimation
from franbv.adapters.realsense.sdk import sdk
from franbv.adapters.realsense.settings import VISUAL_PRESETS, RealSenseSettings
from render.matcher.d400_preset import D400_PRESETS
from tests.franbv.adapters.realsense.software_camera import Bench, SoftwareCamera, Still, flat, stills

HERE = RigidTransform.identity()


def refused(bench: Bench, **changes) -> str:
    """The one line with which opening ends; nothing streams after it."""
    with pytest.raises(CameraError) as caught:
        bench.camera(**changes)
    assert "\n" not in str(caught.value)
    assert not any(camera.streams for camera in bench.cameras)
    return str(caught.value)


def test_options_are_set_and_written_down():
    """Laser, projector, exposure and gain stand in the camera as asked, and the record has every option's value."""
    device = SoftwareCamera()
    wishes = {"laser_power_mw": 300, "emitter": True, "exposure_us": 12000, "gain": 64, "preset": "hand"}
    with Bench([device]).camera(**wishes) as camera:
        told = camera.record()
    want = {"laser_power": 300, "emitter_enabled": 1, "exposure": 12000, "gain": 64, "enable_auto_exposure": 0}
    assert {name: device.option(name) for name in want} == want
    assert want.items() <= told["options"].items()
    assert told["camera"]["firmware_version"] == "5.17.0.10"
    assert told["temperatures"] == {"asic_deg_c": 41.0}
    assert told["sdk"] == f"librealsense {sdk().__version__}"
    assert RealSenseSettings.model_validate(told["settings"] | {"serial": "1"}) == camera.settings
    assert json.loads(json.dumps(told)) == told  # as a recording will hold it


def test_what_is_not_asked_for_stays_as_the_preset_has_it():
    """A preset by name is always set; nothing else is touched."""
    device = SoftwareCamera()
    device.sensor.set_option(sdk().option.laser_power, 240)
    device.sensor.set_option(sdk().option.visual_preset, 5)
    with Bench([device]).camera():
        assert (device.option("laser_power"), device.option("visual_preset")) == (240, 1)


def test_auto_exposure_can_be_asked_for():
    """Whatever a preset's file or another program left."""
    device = SoftwareCamera()
    device.sensor.set_option(sdk().option.enable_auto_exposure, 0)
    with Bench([device]).camera(exposure_us="auto"):
        assert device.option("enable_auto_exposure") == 1


def test_presets_have_one_set_of_names():
    """The simulator's presets and the camera's are called alike, and librealsense knows them."""
    assert set(VISUAL_PRESETS) == set(D400_PRESETS)
    assert all(hasattr(sdk().rs400_visual_preset, name) for name in VISUAL_PRESETS)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"laser_power_mw": 100}, "laser_power 100: it has 0 to 360 in steps of 30"),
        ({"exposure_us": 200_000}, "exposure 200000: it has 1 to 165000"),
        ({"exposure_us": 5000, "gain": 1}, "gain 1: it has 16 to 248"),
        ({"profile": "1280x720"}, "no depth stream 1280x720 at 30 fps on USB 3.2; use one of 640x360 at 30"),
        ({"fps": 90}, "no depth stream 640x360 at 90 fps"),
        ({"infrared": True}, "no left infrared stream 640x360 at 30 fps on USB 3.2; use one of none"),
        ({"preset": "bright"}, "preset 'bright': not known; use one of default, high_accuracy"),
        ({"preset": "missing.json"}, "missing.json: cannot be read"),
        ({"decimate_in": "camera"}, "has no decimation of its own"),
        ({"crop": (81, 40)}, "crop 81x40: larger than the decimated image, 80x45"),
        ({"model": "d415"}, "D435I 1: not a D415"),
        ({"serial": "9"}, "RealSense 9: not connected, but Intel RealSense D435I 1; plug it in"),
    ],
)
def test_what_the_camera_has_not_is_told(changes, words):
    """One line: the camera, what was asked, what there is."""
    assert words in refused(Bench([SoftwareCamera()]), **changes)


def test_one_of_several_must_be_named():
    """The line lists them; with a serial number, whichever port it is in, the right one is opened."""
    first, second = SoftwareCamera(serial="11"), SoftwareCamera(serial="22")
    bench = Bench([first, second])
    line = refused(bench)
    assert "2 cameras are connected" in line
    assert "D435I 11" in line
    assert "D435I 22" in line
    with bench.camera(serial="22"):
        assert (first.streams, second.streams) == (False, True)


def test_none_at_all():
    """Nothing plugged in is not an index error."""
    assert "no camera is connected; plug one into a USB 3 port" in refused(Bench([]))


@pytest.mark.parametrize("model", ["brown_conrady", "inverse_brown_conrady", "modified_brown_conrady", "none"])
def test_rectified_streams_are_taken(model):
    """Zero coefficients are no distortion, whatever the model is called."""
    with Bench([SoftwareCamera(distortion=model)]).camera() as camera:
        assert camera.intrinsics.fx == 321.0 / 8


@pytest.mark.parametrize(
    ("model", "coefficients"), [("brown_conrady", (0.0, 0.0, 1e-4, 0.0, 0.0)), ("kannala_brandt4", (0.0,) * 5)]
)
def test_distorted_streams_are_refused(model, coefficients):
    """The planner projects through a pinhole: a distorted stream would put points beside the part without a word."""
    assert f"depth with {model} distortion" in refused(
        Bench([SoftwareCamera(distortion=model, coefficients=coefficients)])
    )


def test_a_baseline_is_needed():
    """Min-Z comes from it, and a recovery pose must keep it."""
    assert "does not tell its baseline" in refused(Bench([SoftwareCamera(baseline_mm=None)]))


def test_a_device_without_depth_is_refused():
    """A tracking or colour camera of the same maker is on the same bus."""
    bare = SoftwareCamera()
    bare.device = sdk().software_device()
    bare.device.register_info(sdk().camera_info.serial_number, "5")
    bare.device.add_sensor("Motion Module")
    assert "has no depth sensor" in refused(Bench([bare]))


class AdvancedMode:
    """Stands in for the D400's advanced mode, which software devices have not."""

    def __init__(self, device: Any) -> None:
        self.table = SimpleNamespace(disparityShift=40)

    def get_depth_table(self) -> SimpleNamespace:
        """librealsense's name for it."""
        return self.table


def test_a_disparity_shift_brings_min_z_nearer(monkeypatch):
    """Min-Z = f B / (126 + shift), as in `render.depth.coding.z_range`."""
    monkeypatch.setattr(sdk(), "rs400_advanced_mode", AdvancedMode)
    with Bench([SoftwareCamera(info={"advanced_mode": "YES"})]).camera() as camera:
        assert camera.min_z == pytest.approx(321.0 * 0.05 / 166)
        assert camera.record()["disparity_shift_px"] == 40


def test_a_preset_file_is_handed_to_the_camera(monkeypatch, tmp_path):
    """The viewer's file, as it is; a camera that does not take it is quoted in one line."""
    file, loaded = tmp_path / "mine.json", []
    file.write_text('{"param-disparityshift": 0}')
    monkeypatch.setattr(sdk(), "serializable_device", lambda device: SimpleNamespace(load_json=loaded.append))
    with Bench([SoftwareCamera()]).camera(preset=str(file)):
        assert loaded == [file.read_text()]

    def fail(text):
        raise RuntimeError("bad\nkey")

    monkeypatch.setattr(sdk(), "serializable_device", lambda device: SimpleNamespace(load_json=fail))
    assert "does not take it (bad key); save it anew" in refused(Bench([SoftwareCamera()]), preset=str(file))
    line = refused(Bench([SoftwareCamera(info={"advanced_mode": "NO"})]), preset=str(file))
    assert "advanced mode is off" in line


@dataclass
class OwnDecimation:
    """Stands in for the decimation filter of a D500 camera: two options over Ethernet, one composite over USB."""

    composite: bool
    enabled: bool = False
    magnitude: int = 2
    stuck: bool = False
    set_to: list[bool] = field(default_factory=list)

    def get_type(self) -> Any:
        """librealsense's names from here on."""
        return sdk().embedded_filter_type.decimation

    def supports(self, option: Any) -> bool:
        return not self.composite and option in (sdk().option.embedded_filter_enabled, sdk().option.filter_magnitude)

    def get_option(self, option: Any) -> float:
        return float(self.enabled if option == sdk().option.embedded_filter_enabled else self.magnitude)

    def set_option(self, option: Any, value: float) -> None:
        assert option == sdk().option.embedded_filter_enabled  # the magnitude is read-only
        self._set(bool(value))

    def get_decimation_filter_dpp_config(self, option: Any) -> Any:
        config = sdk().decimation_filter_dpp_config()
        config.enabled, config.magnitude = int(self.enabled), self.magnitude
        return config

    def set_decimation_filter_dpp_config(self, option: Any, config: Any) -> None:
        assert config.magnitude == self.magnitude
        self._set(bool(config.enabled))

    def _set(self, on: bool) -> None:
        self.set_to.append(on)
        self.enabled = self.enabled if self.stuck else on


def sensor_with(*filters: OwnDecimation) -> SimpleNamespace:
    """As much of a sensor as is asked."""
    return SimpleNamespace(query_embedded_filters=lambda: list(filters))


@pytest.mark.parametrize("composite", [False, True])
class TestWhoDecimates:
    """The camera is asked which filter runs; never both."""

    def test_on_this_computer(self, composite):
        """The camera's own is switched off if it runs."""
        own = OwnDecimation(composite, enabled=True)
        settle_decimation(sensor_with(own), RealSenseSettings(), "D555 1")
        assert own.set_to == [False]
        settle_decimation(sensor_with(own), RealSenseSettings(), "D555 1")
        assert own.set_to == [False]  # nothing to do

    def test_in_the_camera(self, composite):
        """Its own is switched on; it halves."""
        own = OwnDecimation(composite)
        settle_decimation(sensor_with(own), RealSenseSettings(decimation=2, decimate_in="camera"), "D555 1")
        assert own.set_to == [True]

    def test_another_factor_is_refused(self, composite):
        """Eight is not to be had from it."""
        with pytest.raises(CameraError, match="its own decimation is by 2 and not by 8; set decimation 2"):
            settle_decimation(sensor_with(OwnDecimation(composite)), RealSenseSettings(decimate_in="camera"), "D555 1")

    def test_one_that_cannot_be_switched_is_refused(self, composite):
        """What it answers counts, and not what it was told."""
        own = OwnDecimation(composite, enabled=True, stuck=True)
        with pytest.raises(CameraError, match="its own decimation stays on"):
            settle_decimation(sensor_with(own), RealSenseSettings(), "D555 1")


def test_an_old_librealsense_knows_of_no_filters():
    """Before 2.58 sensors could not be asked."""
    settle_decimation(SimpleNamespace(), RealSenseSettings(), "D435I 1")


def test_frames_that_were_decimated_elsewhere_are_refused():
    """Some cameras decimate and cannot be asked: the size of what comes tells."""
    bench = Bench([SoftwareCamera(sends=(320, 180))], stills(lambda k: flat(500, (320, 180))))
    with bench.camera() as camera, pytest.raises(CameraError, match="frames of 320x180 instead of 640x360"):
        camera.capture(HERE, 1)


def test_frames_of_the_camera_s_own_decimation_are_only_cropped(monkeypatch):
    """Half of 640x360 arrives, and its middle 60 x 40 is the burst; intrinsics are those of 2 x 2 blocks."""
    image = np.random.default_rng(0).integers(1, 5000, (180, 320)).astype(np.uint16)
    monkeypatch.setattr("franbv.adapters.realsense.decimation.own_decimation", lambda sensor: OwnDecimation(False))
    bench = Bench([SoftwareCamera(sends=(320, 180))], iter([Still(image, 1, 1.0)]))
    with bench.camera(decimate_in="camera", decimation=2) as camera:
        burst = camera.capture(HERE, 1)
        assert camera.record()["decimation"] == {"factor": 2, "runs_in": "camera"}
    np.testing.assert_array_equal(np.rint(burst.depths[0] * 1e3), image[70:110, 130:190])
    assert burst.intrinsics.fx == 321.0 / 2
    assert math.isclose(burst.intrinsics.cx, (319.5 - 0.5) / 2 - 130)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"gain": 16}, "gain without exposure_us"),
        ({"gain": 16, "exposure_us": "auto"}, "gain without exposure_us"),
        ({"decimate_in": "camera", "decimation": 1}, "nothing is decimated"),
        ({"laser_power": 90}, "laser_power"),
        ({"decimation": 9}, "decimation"),
        ({"crop": "60x"}, "crop"),
        ({"profile": "wide"}, "profile"),
    ],
)
def test_settings_that_cannot_be(changes, words):
    """Refused before any camera is asked."""
    with pytest.raises(ValidationError, match=words):
        RealSenseSettings(**changes)


def test_sizes_are_written_as_one_word():
    """As profiles are named everywhere."""
    settings = RealSenseSettings(profile="848x480", crop="none")
    assert (settings.profile, settings.crop) == ((848, 480), None)
