"""Recorded beside simulated depth: counted pixel by pixel, and alike where the scene itself was recorded."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from franbv.adapters.recording.contents import CameraFacts, Recording, RunFacts
from franbv.adapters.recording.writer import RecordingWriter
from franbv.frames import Intrinsics, look_at
from materials.input_error import InputError
from render.d435i import SimulatedD435i
from render.sensor import SensorSettings
from studies.cli.main import main
from studies.run.real_and_simulated import Twin, TwinPixels, check_comparable, twin_figures
from studies.run.scene_settings import SubjectSettings, build_subject
from studies.run.stored_run import StoredRun

FOCAL_BASELINE = 16.0
"""f B [px m]; sigma at 0.4 m is then 1 mm, so that 5 mm decide what is false."""


def test_figures_are_counted_pixel_by_pixel():
    """Six pixels, each another case: both holes, one or the other, false in one, right in both."""
    true = np.full(6, 0.4, np.float32)
    real = true + np.array([0, 0, 0.001, 0.02, 0.003, 0.001], np.float32)
    simulated = true + np.array([0, 0, 0, 0.002, 0.002, 0.004], np.float32)
    real[[0, 1]], simulated[[0, 2]] = 0.0, 0.0
    incidence = np.array([5, 5, 5, 50, 50, 50], np.float32)
    whole, steep, flat = twin_figures(TwinPixels(real, simulated, true, incidence), FOCAL_BASELINE)
    assert [row["incidence"] for row in (whole, steep, flat)] == ["all", "0 to 15 deg", "45 to 60 deg"]
    assert (whole["pixels"], steep["pixels"], flat["pixels"]) == (6, 3, 3)
    assert (whole["hole_precision"], whole["hole_recall"], whole["hole_iou"]) == (1 / 2, 1 / 2, 1 / 3)
    assert (whole["real_hole_share"], whole["simulated_hole_share"]) == (2 / 6, 2 / 6)
    assert (whole["real_false_share"], whole["simulated_false_share"]) == (1 / 6, 0)
    assert flat["real_bias_mm"] == pytest.approx(2.0, abs=1e-3)  # of 3 and 1 mm
    assert flat["simulated_bias_mm"] == pytest.approx(2.0, abs=1e-3)  # of 2, 2 and 4 mm
    assert np.isnan(flat["hole_iou"])


def test_a_simulated_recording_is_its_own_twin(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """The same scene, sensor, seed and pose: every hole is found, and the biases are one number."""
    settings = SubjectSettings(part="plate", material=("iron:polished",), seed=3)
    camera = SimulatedD435i(build_subject(settings).scene, SensorSettings(roll_deg=0.0), settings.seed)
    pose = look_at(np.array([0.1, 0.0, 0.45]), np.array([0.0, 0.0, 0.08]))
    facts = CameraFacts(camera.intrinsics, camera.min_z, camera.settings.depth.unit)
    sensor = camera.settings.model_dump(mode="json")
    with RecordingWriter(tmp_path / "a.mcap", RunFacts("Plate", sensor=sensor), facts) as writer:
        writer.burst(camera.capture(pose, 2), pose)
    scene = tmp_path / "scene.yaml"
    scene.write_text("part: plate\nmaterial: [iron:polished]\nseed: 3\n")
    args = ["replay", str(tmp_path / "a.mcap"), "--out", str(tmp_path / "out"), "--simulate", str(scene), "--json"]
    assert main([*args, "--parameters.n-frames", "2"]) == 0
    whole = json.loads(capsys.readouterr().out.splitlines()[-1])["simulated"][0]
    assert whole["pixels"] > 50
    assert whole["real_hole_share"] == whole["simulated_hole_share"] > 0
    assert (whole["hole_precision"], whole["hole_recall"], whole["hole_iou"]) == (1.0, 1.0, 1.0)
    assert whole["real_bias_mm"] == whole["simulated_bias_mm"]
    assert whole["real_false_share"] == whole["simulated_false_share"]
    assert StoredRun(tmp_path / "out" / "latest").run["simulated"]["scene"]["part"] == "plate"
    assert "Recorded and simulated depth" in (tmp_path / "out" / "report.html").read_text()
    scene.write_text("part: plate\nmaterial: [iron:polished]\nsensor: {crop: [40, 40]}\n")
    assert main([*args, "--parameters.n-frames", "2"]) == 2
    assert "has 40 x 40 pixels and the recorded one 60 x 40" in capsys.readouterr().err


RECORDED = Intrinsics(60, 40, 40.0, 42.0, 29.5, 19.5)


@pytest.mark.parametrize(
    ("fx", "fy", "alike"), [(1.029, 1.0, True), (1.0, 0.971, True), (1.031, 1.0, False), (1.0, 0.969, False)]
)
def test_cameras_of_other_focal_lengths_are_not_compared(fx: float, fy: float, alike: bool):
    """Up to 3 % of the recorded one's, along each axis for itself: images of one size can still show other things."""
    simulated = replace(RECORDED, fx=fx * RECORDED.fx, fy=fy * RECORDED.fy)
    if alike:
        check_comparable(Path("scene.yaml"), simulated, RECORDED)
        return
    with pytest.raises(InputError, match=r"scene\.yaml: the simulated camera has focal lengths.*3% apart; set sensor"):
        check_comparable(Path("scene.yaml"), simulated, RECORDED)


@pytest.mark.parametrize(
    ("sensor", "options", "words"),
    [
        ({"fps": 30}, {}, "run.mcap, settings of its sensor: unknown key `fps`"),
        ({"decimation": 9}, {}, "run.mcap, settings of its sensor: `decimation` = 9"),
        ({"profile": "30x20"}, {}, "run.mcap, settings of its sensor: "),
        ({}, {"laser_power": 1000.0}, r"run.mcap, options of the camera: `imager.laser_power_mw` = 1000"),
    ],
)
def test_a_sensor_that_cannot_be_simulated_is_the_recordings_fault(
    tmp_path: Path, sensor: dict[str, Any], options: dict[str, Any], words: str
):
    """What the recording states is wrong, and the scene file says nothing of a sensor: the line begins with the
    recording."""
    scene = tmp_path / "scene.yaml"
    scene.write_text("part: plate\nmaterial: [iron:polished]\n")
    facts = CameraFacts(RECORDED, 0.1, 0.001)
    recording = Recording(Path("run.mcap"), RunFacts(sensor=sensor), facts, (), options=options)
    with pytest.raises(InputError) as error:
        Twin.of(scene, recording, 1, None)
    assert str(error.value).startswith(words)
    assert "\n" not in str(error.value)
