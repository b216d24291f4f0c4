"""The camera among the settings: what may be chosen, in which order, on the same draws; without it all is as it was."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from franbv.adapters.live.command import _parameters
from materials.input_error import InputError
from render.d435i import SensorSettings
from studies.base.config import overlaid, validated
from studies.base.flags import parse_wider_command
from studies.cli.main import main
from studies.cli.reconstruct import ReconstructCommand
from studies.run.reconstruct import ReconstructSettings
from studies.run.recorded_sensor import SENSOR_SECTION
from studies.run.replayed import ReplaySettings
from studies.store.views import read_arrays
from studies.thresholds.bank import bank_settings, read_banked_view
from studies.thresholds.command import resolved_preset
from studies.thresholds.config import ThresholdsPreset
from studies.thresholds.score import do_score
from studies.thresholds.sensors import NO_EFFECT, SENSOR_CHOICES, sensor_alternatives
from studies.thresholds.study import Study
from tests.conftest import ROOT
from tests.studies.thresholds.made_up_bank import write_banks
from tests.studies.thresholds.made_up_study import STATED

N_VIEWS = 40
DECLARED = SensorSettings().resolved()
MANUAL = {"sensor.auto_exposure": [True, False], "sensor.imager.exposure_us": [2000, 8500]}
TWO_PRESETS = STATED | {
    "risks": {"false_recoveries": {"most": 0, "level": 0.3}, "false_depth_believed": {"most": 0.1, "level": 0.3}},
    "settings": {"sensor.preset": ["default", "high_accuracy"], "n_frames": [1, 3]},
    "budget": STATED["budget"] | {"views": N_VIEWS},
}
"""Of the made-up cameras `high_accuracy` alone believes no false depth; of the plates, half of the draws, a fifth of
the other's is."""


def study_of(stated: dict[str, Any], out: Path = Path("nowhere")) -> Study:
    """As the command makes it."""
    return Study.of(out, resolved_preset(validated(ThresholdsPreset, stated, "study.yaml")))


def with_settings(settings: dict[str, Any], **sensor: Any) -> dict[str, Any]:
    """The small study with these settings, of a domain with this sensor."""
    return STATED | {"settings": settings, "domain": STATED["domain"] | {"sensor": sensor}}


@pytest.mark.parametrize("stated", [STATED, "quick"])
def test_without_a_camera_to_choose(stated: dict[str, Any] | str):
    """One bank, the declared domain's own, with the folders that it always had."""
    preset = ThresholdsPreset.named(stated) if isinstance(stated, str) else ThresholdsPreset.model_validate(stated)
    study = Study.of(Path("out"), preset := resolved_preset(preset))
    most = max(parameters.n_frames for parameters in study.grid.settings)
    own = bank_settings(preset.domain, preset.seed, most)
    assert [bank.name for bank in study.banks] == [own.name]
    first = study.view_tasks[0][0]
    assert first.view.file == Path("out/bank") / own.name / "views/000000.npz"
    assert first.file == Path("out/bank") / own.name / "scores" / study.grid.name / "000000.npz"
    assert [camera.values for camera in study.cameras] == [{}]


def test_every_combination_in_order():
    """The camera's values, the last one changing first, and under each camera the planner's."""
    study = study_of(
        with_settings({"n_frames": [1, 3], "sensor.preset": ["high_accuracy", "default"],
                       "sensor.imager.laser_power_mw": [150, 360]})
    )  # fmt: skip
    cameras = [(camera.sensor.preset, camera.sensor.imager.laser_power_mw) for camera in study.cameras]
    assert cameras == [("high_accuracy", 150), ("high_accuracy", 360), ("default", 150), ("default", 360)]
    settings = study.settings({})
    assert [(s.values["sensor.preset"], s.values["n_frames"], s.camera, s.view_setting) for s in settings] == [
        ("high_accuracy", 1, 0, 0), ("high_accuracy", 3, 0, 1), ("high_accuracy", 1, 1, 2), ("high_accuracy", 3, 1, 3),
        ("default", 1, 2, 4), ("default", 3, 2, 5), ("default", 1, 3, 6), ("default", 3, 3, 7),
    ]  # fmt: skip
    assert [s.bank.domain.sensor.imager.laser_power_mw for s in settings] == [150, 150, 360, 360] * 2
    assert [s.parameters.n_frames for s in settings] == [1, 3] * 4


def test_what_has_no_effect_is_no_alternative():
    """Under auto-exposure no exposure is one of many; a set-point is only what auto-exposure aims at."""
    found = sensor_alternatives(MANUAL, DECLARED)
    assert [camera.values for camera in found] == [
        {"sensor.auto_exposure": True, "sensor.imager.exposure_us": NO_EFFECT},
        {"sensor.auto_exposure": False, "sensor.imager.exposure_us": 2000},
        {"sensor.auto_exposure": False, "sensor.imager.exposure_us": 8500},
    ]
    assert [camera.sensor.auto_exposure for camera in found] == [True, False, False]
    assert found[0].sensor == DECLARED
    assert [camera.words for camera in found[:2]] == [
        "auto_exposure True",
        "auto_exposure False, imager.exposure_us 2000",
    ]
    same = sensor_alternatives({"sensor.preset": ["Default", "default"]}, DECLARED)
    assert [camera.sensor.preset for camera in same] == ["default"]


def test_the_draws_are_the_same():
    """Views of one row differ by the camera alone, and so do reconstructions; a bank of that very camera is taken."""
    risks = TWO_PRESETS["risks"] | {"acquisitions": {"most": 9, "level": 0.3}}
    budget = TWO_PRESETS["budget"] | {"reconstructions": 60, "stress_views": 3}
    study = study_of(TWO_PRESETS | {"risks": risks, "budget": budget})
    row = study.view_tasks[7]
    assert {task.view.number for task in row} == {7}
    domains = [task.view.settings.domain for task in row]
    assert [domain.sensor.preset for domain in domains] == ["default", "high_accuracy"]
    assert len({domain.model_copy(update={"sensor": DECLARED}).model_dump_json() for domain in domains}) == 1
    assert len({(task.view.settings.seed, task.view.settings.n_frames) for task in row}) == 1
    for camera, preset in zip(study.banks, ("default", "high_accuracy"), strict=True):
        declared = with_settings({"n_frames": [1, 3]}, preset=preset)
        assert study_of(declared).banks[0].name == camera.name
    runs = [study.run_tasks([study.setting(camera.values, 2 * k)])[3] for k, camera in enumerate(study.cameras)]
    assert [run.settings.sensor.preset for run in runs] == ["default", "high_accuracy"]
    one, other = (run.settings.model_dump(exclude={"sensor"}) for run in runs)
    assert one == other
    stressed = study.stress_tasks(study.setting(study.cameras[1].values, 2))
    assert stressed
    assert all(task.view.settings == study.banks[1] for tasks in stressed.values() for task in tasks)


PRESET_FILE = {"param-secondpeakdelta": "500", "controls-laserpower": "300"}


def test_a_preset_file(tmp_path: Path):
    """What it says of the laser holds, but for what is stated; the study needs the file no more once it is begun."""
    file = tmp_path / "mine.json"
    file.write_text(json.dumps(PRESET_FILE))
    stated = with_settings({"sensor.preset": ["default", str(file)]})
    preset = resolved_preset(validated(ThresholdsPreset, stated, "study.yaml"))
    declared = study_of(with_settings({}, preset=str(file))).banks[0]
    file.unlink()
    again = validated(ThresholdsPreset, preset.model_dump(mode="json"), "thresholds.json")
    cameras = Study.of(tmp_path, again).cameras
    assert [camera.sensor.imager.laser_power_mw for camera in cameras] == [150, 300]
    assert cameras[1].sensor == declared.domain.sensor
    lasers = {"sensor.preset": [again.settings["sensor.preset"][1]], "sensor.imager.laser_power_mw": [150, 360]}
    assert [c.sensor.imager.laser_power_mw for c in sensor_alternatives(lasers, DECLARED)] == [150, 360]


BAD: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "the camera has no sensor.laser_power; did you mean sensor.imager.laser_p": ({"sensor.laser_power": [1]}, {}),
    "the camera has no sensor.imager": ({"sensor.imager": [{}]}, {}),
    "the planner has no sensr.preset; did you mean sensor.preset": ({"sensr.preset": ["hand"]}, {}),
    "sensor.roll_deg: poses and pixels of all draws hang on it": ({"sensor.roll_deg": [0, 90]}, {}),
    "sensor.profile: poses and pixels": ({"sensor.profile": ["848x480"]}, {}),
    "sensor.imager.full_well: is what the camera is": ({"sensor.imager.full_well": [6000]}, {}),
    "sensor.matcher: is what the camera is": ({"sensor.matcher": ["sgbm"]}, {}),
    "sensor.preset: the matcher sgbm knows no presets": ({"sensor.preset": ["hand"]}, {"matcher": "sgbm"}),
    "domain.sensor.preset: a file": ({"sensor.preset": ["hand"]}, {"preset": "mine.json"}),
    "settings, sensor: `imager.laser_power_mw` = 400": ({"sensor.imager.laser_power_mw": [150, 400]}, {}),
    "preset 'hnd': unknown": ({"sensor.preset": ["hnd"]}, {}),
    "none.json: no such preset file": ({"sensor.preset": ["none.json"]}, {}),
    "sensor.imager.gain has no effect under auto-exposure": ({"sensor.imager.gain": [16, 64]}, {}),
    "sensor.imager.set_point has no effect without auto-exposure": (
        {"sensor.imager.set_point": [60, 96]}, {"auto_exposure": False}
    ),
}  # fmt: skip


@pytest.mark.parametrize("words", BAD)
def test_what_cannot_be_chosen(words: str):
    """One line with the key and the mend."""
    settings, sensor = BAD[words]
    with pytest.raises(InputError) as raised:
        study_of(with_settings(settings, **sensor))
    assert words in str(raised.value)
    assert "\n" not in str(raised.value)


def test_the_page_of_the_documentation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Three presets, two lasers, and auto-exposure or one of two exposures; it names all that can be chosen."""
    text = (ROOT / "docs" / "thresholds.md").read_text()
    section = text[text.index("## The camera among the settings") : text.index("## What the page shows besides")]
    monkeypatch.chdir(tmp_path)
    Path("mine.json").write_text(json.dumps(PRESET_FILE))
    settings = yaml.safe_load(section.split("```yaml")[1].split("```")[0])["settings"]
    assert len(study_of(with_settings(settings)).cameras) == 3 * 2 * (1 + 2)
    assert all(f"`{name}`" in section or f"`{name.rpartition('.')[2]}`" in section for name in SENSOR_CHOICES)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A finished study of two presets and its configuration."""
    folder = tmp_path_factory.mktemp("sensors")
    config, out = folder / "config.yaml", folder / "out"
    config.write_text(yaml.safe_dump(TWO_PRESETS))
    write_banks(out, resolved_preset(ThresholdsPreset.model_validate(TWO_PRESETS)))
    assert main(["study", "thresholds", str(config), "--out", str(out), "--workers", "1"]) == 0
    return config, out


def test_a_preset_is_certified(made: tuple[Path, Path], capsys: pytest.CaptureFixture[str]):
    """The one whose depth is right, and it is named wherever the settings are; the number of views is said first."""
    config, out = made
    assert main(["study", "thresholds", str(config), "--out", str(out)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(f"2 cameras to choose among, {N_VIEWS} views by each: {2 * N_VIEWS} views")
    assert any(line.startswith("Certified: sensor.preset high_accuracy, n_frames ") for line in said)
    certificate = json.loads((out / "certificate.json").read_text())
    assert certificate["settings"]["sensor.preset"] == "high_accuracy"
    assert {values["sensor.preset"] for values in certificate["certified_settings"]} == {"high_accuracy"}
    assert certificate["domain"]["sensor"]["preset"] == "high_accuracy"
    assert json.loads((out / "thresholds_summary.json").read_text())["settings"] == certificate["settings"]
    page = (out / "certificate.html").read_text()
    assert '<code>sensor.preset</code></td><td class="n">high_accuracy' in page
    assert "sensor.preset default, n_frames 1: finds" in page
    assert len(list((out / "bank").iterdir())) == 2


def test_its_settings_are_taken_as_they_are(made: tuple[Path, Path], tmp_path: Path):
    """`reconstruct --config` has planner and camera; `replay --config` and `run --parameters` take the planner's."""
    path = made[1] / "thresholds.yaml"
    stated = yaml.safe_load(path.read_text())
    assert set(stated) == {"parameters", "sensor"}
    assert "sensor.preset" not in stated["parameters"]
    args = ["--config", str(path), "--part", "A", "--out", str(tmp_path)]
    command = parse_wider_command(ReconstructCommand, ReconstructSettings, args, "franbv reconstruct", "")
    assert command.settings.sensor == study_of(TWO_PRESETS).cameras[1].sensor
    replayed = overlaid(ReplaySettings(), path, SENSOR_SECTION)
    for parameters in (command.settings.parameters, replayed.parameters, _parameters(path)):
        assert parameters.n_frames == stated["parameters"]["n_frames"]


def test_a_draw_counts_where_every_camera_has_it(made: tuple[Path, Path], tmp_path: Path):
    """Columns of the second camera follow those of the first, row by row of the same draws; one that a camera lacks is
    left out for all, and the others keep their numbers."""
    study = study_of(TWO_PRESETS, made[1])
    scores = study.view_scores()["false_depth_believed"]
    assert scores.shape == (N_VIEWS, 4)
    parts = np.array([read_banked_view(default.view)[0].part for default, _ in study.finished_views])
    np.testing.assert_array_equal(scores[:, 0] > 0, parts == "plate")
    assert (scores[:, 2:] == 0).all()
    lost = tmp_path / "000004.npz"
    study.view_tasks[4][1].file.rename(lost)
    views = study.view_scores()
    evidence = study.evidence(views, study.settings(views))
    assert len(views["false_recoveries"]) == N_VIEWS - 1
    assert list(evidence.numbers["false_recoveries"]) == [*range(4), *range(5, N_VIEWS)]
    lost.rename(study.view_tasks[4][1].file)


def test_an_exposure_stands_in_the_file_where_it_holds():
    """A person who sets the camera needs it, be it the default or not."""
    auto, short, usual = (camera.section for camera in sensor_alternatives(MANUAL, DECLARED))
    assert auto == {"preset": "default", "roll_deg": 0.0, "auto_exposure": True, "imager": {"laser_power_mw": 150.0}}
    held = {"exposure_us": 2000.0, "gain": 16.0, "laser_power_mw": 150.0}
    assert short == auto | {"auto_exposure": False, "imager": held}
    assert usual["imager"] == held | {"exposure_us": 8500.0}
    for section, camera in zip((auto, short, usual), sensor_alternatives(MANUAL, DECLARED), strict=True):
        assert SensorSettings.model_validate(section).resolved() == camera.sensor


@pytest.mark.slow
def test_two_presets_for_real(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A matte plate in the dark, rendered: both presets see the same thirty draws, and what they make of them differs;
    the stricter preset leaves no less of the plate without depth."""
    stated = {
        "title": "Two presets on a matte plate",
        "domain": {"parts": {"plate": 1}, "materials": {"matte_paint": 1}, "lamps": {"off": 1}, "polar_deg": [0, 30]},
        "risks": TWO_PRESETS["risks"],
        "prefer": "false_depth_believed",
        "settings": {"sensor.preset": ["high_accuracy", "default"], "n_frames": [1, 2]},
        "budget": {"views": 30, "reconstructions": 0, "stress_views": 1, "repetitions": 10},
    }
    config, out = tmp_path / "config.yaml", tmp_path / "out"
    config.write_text(yaml.safe_dump(stated))
    assert main(["study", "thresholds", str(config), "--out", str(out), "--workers", "2"]) == 0
    assert "30 views by each: 60 views are rendered" in capsys.readouterr().out
    study = study_of(stated, out)
    assert len(study.finished_views) == 30
    depths = []
    for strict, default in study.finished_views:
        (draw, one), (same, other) = read_banked_view(strict.view), read_banked_view(default.view)
        assert draw == same
        np.testing.assert_array_equal(one.T_world_cam, other.T_world_cam)
        np.testing.assert_array_equal(one.part, other.part)
        depths.append([(view.depths[:, view.part] > 0).mean() for view in (one, other)])
    strict, default = np.mean(depths, axis=0)
    assert strict <= default
    assert any(not np.array_equal(*(read_arrays(task.view.file)["depths"] for task in row)) for row in study.view_tasks)
    certificate = json.loads((out / "certificate.json").read_text())
    assert certificate["certified"] is True
    assert certificate["settings"]["sensor.preset"] in ("high_accuracy", "default")
    before = {path: path.stat().st_mtime_ns for path in (out / "bank").rglob("*.npz")}
    for task in (*study.view_tasks[0], *study.view_tasks[29]):
        do_score(task)
    assert {path: path.stat().st_mtime_ns for path in (out / "bank").rglob("*.npz")} == before
