"""A live run with librealsense's software device: what the camera says of itself, its images and times are recorded."""

from collections.abc import Iterator

import numpy as np
import pytest

from franbv.adapters.camera_error import CameraError
from franbv.adapters.live.pulse import Pulse
from franbv.adapters.live.realsense_cell import open_realsense, opened_realsense
from franbv.adapters.live.run import LiveRun, last_recording
from franbv.adapters.live.stated_sensor import stated_sensor
from franbv.adapters.realsense.burst import DEPTH_STREAM, LEFT_INFRARED, RIGHT_INFRARED
from franbv.adapters.recording.contents import RunFacts
from franbv.adapters.recording.replay import replay
from franbv.parameters import Parameters
from franbv.planners import fra
from tests.franbv.adapters.live.cells import CELL, ScriptedArm, guarded
from tests.franbv.adapters.realsense.software_camera import PERIOD_MS, Bench, SoftwareCamera, Still
from tests.franbv.adapters.realsense.test_reconstruction import FULL, Scene

pytest.importorskip("pyrealsense2", exc_type=ImportError)
PARAMETERS = Parameters(n_frames=2, max_iterations=1)
FACTS = RunFacts("CornerBox", "fra", PARAMETERS.model_dump(mode="json"), 3)


def film(driver: ScriptedArm, begins_ms: float) -> Iterator[Still]:
    """Depth and both infrared images from where the arm stands; the left one has its frame's number as its grey."""
    scene, number = Scene(), 0
    grey = np.zeros((FULL.height, FULL.width), np.uint8)
    while True:
        for depth in scene.z16(CELL.camera_at(driver.flange), PARAMETERS.n_frames):
            number += 1
            for stream, image in [(DEPTH_STREAM, depth), (LEFT_INFRARED, grey + number % 250), (RIGHT_INFRARED, grey)]:
                yield Still(image, number, begins_ms + number * PERIOD_MS, "global_time", stream)


def test_a_run_through_librealsense(tmp_path):
    """Serial number, firmware, options, images and times stand in the recording, whose replay decides alike."""
    driver = ScriptedArm()
    begins_ms = 4e12  # of this computer's clock, in years to come: no frame counts as older than the call
    bench = Bench([SoftwareCamera(infrared=True)], film(driver, begins_ms))
    with bench.camera(infrared=True) as camera:
        cell = opened_realsense(camera)
        run = LiveRun(
            cell.camera, guarded(driver), fra(), PARAMETERS, FACTS, cell.facts, tmp_path, cell.infrared, cell.times_ns
        )
        ended = run.go()
    recording = last_recording(tmp_path)
    assert recording is not None
    assert (recording.camera.serial, recording.camera.firmware) == ("1", "5.17.0.10")
    assert recording.camera.depth_unit == pytest.approx(0.001)
    assert recording.camera.min_z == pytest.approx(321 * 0.05 / 126)
    assert len(recording.bursts) == len(ended.acquisitions)
    for burst in recording.bursts:
        infrared = burst.read_infrared()
        assert infrared is not None
        number = round((burst.times_ns[0] / 1e6 - begins_ms) / PERIOD_MS)
        assert np.all(infrared == number % 250)
        assert burst.times_ns[1] - burst.times_ns[0] == pytest.approx(PERIOD_MS * 1e6, abs=1e3)
    assert replay(recording, fra(), PARAMETERS, FACTS.seed).decisions_equal


def test_an_image_without_dots():
    """The projector is off while the image is taken, and as before afterwards; intrinsics are of the whole image."""
    camera_of = SoftwareCamera(infrared=True)
    emitters = []

    def watched() -> Iterator[Still]:
        for still in film(ScriptedArm(), 4e12):
            emitters.append(camera_of.option("emitter_enabled"))
            yield still

    with Bench([camera_of], watched()).camera(infrared=True) as camera:
        image, intrinsics = camera.unlit_view()
        assert (image.shape, image.dtype) == ((FULL.height, FULL.width), np.uint8)
        assert (intrinsics.width, intrinsics.fx) == (FULL.width, pytest.approx(FULL.fx))
        assert set(emitters) == {0.0}
        assert camera_of.option("emitter_enabled") == 1.0
    plain = Bench([SoftwareCamera()], film(ScriptedArm(), 4e12)).camera()
    with plain as camera, pytest.raises(CameraError, match="sends no infrared images; set infrared"):
        camera.unlit_view()


def test_settings_that_are_none():
    """Named in one line before a camera is looked for."""
    with pytest.raises(CameraError, match="camera settings: lazer: Extra inputs are not permitted"):
        open_realsense({"lazer": 1})


def test_what_thresholds_hold_for_is_what_the_camera_does():
    """Preset, laser and a held exposure of a study's file stand in the camera; the rest is left over."""
    section = {
        "preset": "high_accuracy",
        "auto_exposure": False,
        "roll_deg": 90.0,
        "imager": {"exposure_us": 3000.0, "gain": 32.0, "laser_power_mw": 360.0, "set_point": 80.0},
        "depth": {"unit": 1e-4},
    }
    stated = stated_sensor(section, "realsense")
    assert stated.others == {"imager.set_point": 80.0, "depth.unit": 1e-4}
    device = SoftwareCamera()
    with Bench([device]).camera(**stated.settings):
        want = {"visual_preset": 3, "laser_power": 360, "enable_auto_exposure": 0, "exposure": 3000, "gain": 32}
        assert {name: device.option(name) for name in want} == want
    auto = stated_sensor(section | {"auto_exposure": True}, "realsense")
    assert auto.settings == {"preset": "high_accuracy", "laser_power_mw": 360.0, "exposure_us": "auto"}
    content = stated_sensor({"preset": '{"param-secondpeakdelta": 500.0}'}, "realsense")
    assert (content.settings, list(content.others)) == ({}, ["preset"])
    assert stated_sensor(section, "my.camera:opened").settings == {}


def test_the_pulse_of_a_camera():
    """It lives as long as frames come at least once a second."""
    now, frames = 0.0, iter([1, 0, 0, 2, 0, 0, 0])
    pulse = Pulse(lambda: next(frames), clock=lambda: now)
    lives = []
    for _ in range(7):
        now += 0.4
        lives.append(pulse())
    assert lives == [True, True, True, True, True, True, False]
    pulse.begin()
    frames = iter([0])
    assert pulse()
