"""`franbv replay`: a recorded run again, its decisions compared, its report without a word of coverage."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from franbv.adapters.recording.contents import CameraFacts, Recording, RunFacts
from materials.input_error import InputError
from render.sensor import SensorSettings
from studies.cli.main import main
from studies.cli.reconstruct import ReconstructCommand, check_record, check_starts
from studies.run.bursts import KeptCaptures
from studies.run.reconstruct import ReconstructSettings
from studies.run.recorded_sensor import sensor_fields, unlike_sensor
from studies.run.recording import recording_of
from studies.run.replayed import ReplaySettings, resolved_replay
from studies.run.run_case import RunSettings, write_run
from studies.run.stored_run import StoredRun
from studies.store.tables import read_rows
from tests.franbv.adapters.recording.bags.bag_writers import (
    DEPTH_TOPIC,
    ROS2,
    SECOND,
    Said,
    camera_info,
    image_of,
    write_rosbag2,
)
from tests.franbv.adapters.recording.recorded_run import PARAMETERS, RUN, SEED, record
from tests.franbv.adapters.recording.recorded_run import UNIT as STEP
from tests.franbv.analytic_camera import SENSOR
from tests.studies.browser import CHROMIUM, visit
from tests.studies.run.analytic_ball import CAMERA, SETTINGS, Ball, FreeArm, ball_reference

UNIT = 0.001
SHORT = SETTINGS.model_copy(update={"parameters": SETTINGS.parameters.model_copy(update={"max_iterations": 2})})


def record_ball(folder: Path, file: Path, settings: RunSettings = SHORT) -> None:
    """A reconstruction of the ball, recorded."""
    captures = KeptCaptures(Ball().take, CAMERA, 0.128, folder)
    with recording_of(file, settings, "Ball", CameraFacts(CAMERA, 0.128, UNIT), folder, {}) as watch:
        write_run(folder, settings, "Ball", captures, FreeArm(), ball_reference(), watched=False, watch=watch)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The case and its recording."""
    folder = tmp_path_factory.mktemp("ball")
    record_ball(folder, folder.parent / "ball.mcap")
    return folder, folder.parent / "ball.mcap"


@pytest.fixture(scope="module")
def replayed(recorded: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The output folder of a replay."""
    out = tmp_path_factory.mktemp("replayed")
    assert main(["replay", str(recorded[1]), "--out", str(out), "--json"]) == 0
    return out


def test_the_replay_is_the_run(recorded: tuple[Path, Path], replayed: Path):
    """Every decision is equal, and so is all that is stored of a run but what needs the true surface."""
    made, again = StoredRun(recorded[0]), StoredRun(replayed / "latest")
    found = again.run["replay"]
    assert (found["mode"], found["decisions_equal"], found["first_difference"]) == ("closed_loop", True, None)
    assert found["decisions"] == found["acquisitions"] == len(made.rows)
    for one, other in zip(made.rows, again.rows, strict=True):
        assert {k: v for k, v in one.items() if "coverage" not in k and "increment" not in k} == {
            k: v for k, v in other.items() if "coverage" not in k and "increment" not in k
        }
    for name in ("cloud.ply", "cloud_filtered.ply"):
        assert (replayed / name).read_bytes() == (recorded[0] / name).read_bytes()
    for k in range(len(made.rows)):
        one, other = made.infrared(k), again.infrared(k)
        assert one is not None
        assert other is not None
        assert (one == other).all()


def test_no_coverage_is_invented(replayed: Path):
    """Without the true surface no column, figure or sentence has a number for it; the page says that it is unknown."""
    rows = read_rows(replayed / "acquisitions.parquet")
    assert all(row[name] is None for row in rows for name in row if "coverage" in name or "increment" in name)
    summary = StoredRun(replayed / "latest").run["summary"]
    assert summary["coverage_map_5mm"] is None
    assert not {"accuracy_mm", "f_score", "recovery_contribution", "wrongly_free_share"} & set(summary)
    page = (replayed / "report.html").read_text()
    words = re.sub(r"<(script|style).*?</\1>", "", page, flags=re.DOTALL)
    assert "how much of the surface that covers is unknown" in words
    assert "nan" not in words.lower().split()
    assert "n/a" not in words
    assert '<h2 id="coverage"' not in words


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_the_page_is_silent_and_alive(replayed: Path, tmp_path: Path):
    """No console message, no request; the script ran, and its caption has no coverage."""
    seen = visit(replayed / "report.html", tmp_path)
    assert (seen.console, seen.requests) == ([], [])
    caption = re.search(r'class="scene-caption">([^<]*)<', seen.dom)
    assert caption is not None
    assert caption[1].startswith("Acquisition ")
    assert "overage" not in caption[1]


def test_the_report_is_drawn_again(replayed: Path, capsys: pytest.CaptureFixture[str]):
    """`franbv report` knows the case, and makes the same page."""
    before = (replayed / "report.html").read_text()
    assert main(["report", str(replayed), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out.splitlines()[-1])["reports"]) == 1
    assert (replayed / "report.html").read_text() == before


def test_a_changed_parameter_is_another_case_with_its_difference(
    recorded: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """Flags go over the recorded settings; what differs first is printed."""
    args = ["replay", str(recorded[1]), "--out", str(tmp_path), "--json", "--parameters.max-iterations", "1"]
    assert main(args) == 0
    said = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert said["decisions_equal"] is False
    assert said["first_difference"]["what"] == "acquisitions"
    config = StoredRun(tmp_path / "latest").run["config"]
    assert config["parameters"]["n_frames"] == SHORT.parameters.n_frames  # as recorded, not the default
    assert main(args) == 0
    assert "Found: " in capsys.readouterr().out


def test_the_recording_that_gives_the_poses_gives_the_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Depth of a robot's own recording, poses of ours: planner, seed and parameters are ours, and flags go over them.

    With the defaults' 15 frames and seed 0 nothing could be replayed.
    """
    bag, ours = record_twice(tmp_path)
    args = ["replay", str(bag), "--poses", str(ours), "--out", str(tmp_path / "out"), "--json"]
    assert main(args) == 0
    said = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert (said["mode"], said["decisions_equal"]) == ("closed_loop", True)
    config = StoredRun(tmp_path / "out" / "latest").run["config"]
    assert (config["planner"], config["seed"]) == (RUN.planner, SEED)
    assert config["parameters"] == PARAMETERS.model_dump(mode="json")
    assert main([*args, "--parameters.max-iterations", "1"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["first_difference"]["what"] == "acquisitions"


def record_twice(folder: Path) -> tuple[Path, Path]:
    """A run recorded as rosbag2, which has its depth images alone, and by us, with the times of the same frames."""
    n = PARAMETERS.n_frames

    def times_of(number: int) -> list[int]:
        return [(number * n + k + 1) * SECOND for k in range(n)]

    run = record(folder / "ours.mcap", times_of=times_of)
    info = camera_info(ROS2, SENSOR.width, height=SENSOR.height, matrix=SENSOR.matrix.ravel().tolist())
    said: list[Said] = [("/camera/depth/camera_info", info, 0)]
    for number, acquisition in enumerate(run.acquisitions):
        for depth, time_ns in zip(acquisition.burst.depths, times_of(number), strict=True):
            rows = np.rint(depth / np.float32(STEP)).astype(np.uint16)
            said.append((DEPTH_TOPIC, image_of(ROS2, rows, time_ns), time_ns))
    return write_rosbag2(folder / "bag", said), folder / "ours.mcap"


def test_folders_of_other_content_are_other_cases(tmp_path: Path):
    """A rosbag2 is a folder: its name does not matter, the names and bytes of all files in it and below do."""

    def digest(name: str, files: dict[str, bytes]) -> str:
        for file, data in files.items():
            path = tmp_path / name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        return resolved_replay(ReplaySettings(), tmp_path / name).digests["recording"]

    one = digest("one", {"metadata.yaml": b"a", "one.db3": b"depth"})
    assert digest("same", {"one.db3": b"depth", "metadata.yaml": b"a"}) == one
    others = [
        digest("bytes", {"metadata.yaml": b"a", "one.db3": b"other"}),
        digest("name", {"metadata.yaml": b"a", "two.db3": b"depth"}),
        digest("more", {"metadata.yaml": b"a", "one.db3": b"depth", "two.db3": b""}),
        digest("below", {"metadata.yaml": b"a", "sub/one.db3": b"depth"}),
        digest("swapped", {"metadata.yaml": b"depth", "one.db3": b"a"}),
    ]
    assert len({one, *others}) == 6


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        (["--min-z", "-0.1"], "`min_z` = -0.1: input should be greater than 0"),
        (["--min-z", "0"], "`min_z` = 0.0: input should be greater than 0"),
        (["--min-z", "nan"], "`min_z` = nan: input should be"),
        (["--min-z", "inf"], "`min_z` = inf: input should be a finite number"),
        (["--decimation", "0"], "`decimation` = 0: input should be greater than or equal to 1"),
        (["--parameters.n-frames", "0"], "n-frames 0: input should be greater than or equal to 1"),
    ],
)
def test_numbers_that_mean_nothing_are_refused(
    recorded: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str], flags: list[str], words: str
):
    """One line with the flag, exit status 2."""
    assert main(["replay", str(recorded[1]), "--out", str(tmp_path / "out"), *flags]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


def test_a_damaged_recording_is_bad_input(
    recorded: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """One line, exit status 2, and no case."""
    data = bytearray(recorded[1].read_bytes())
    data[len(data) // 2] ^= 1
    path = tmp_path / "bad.mcap"
    path.write_bytes(data)
    for args in ([str(path)], [str(tmp_path / "none.mcap")]):
        assert main(["replay", *args, "--out", str(tmp_path / "out")]) == 2
        error = capsys.readouterr().err
        assert error.startswith(f"franbv replay: {args[0]}: ")
        assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_recording_that_cannot_be_made_is_refused_at_once(tmp_path: Path):
    """Before anything is rendered: another kind of file, a file that is there, many starts."""
    settings, there = ReconstructSettings(part="A"), tmp_path / "there.mcap"
    there.touch()
    for file, words in [(tmp_path / "a.bag", "recordings are MCAP"), (there, "is there already")]:
        with pytest.raises(InputError, match=words):
            check_record(ReconstructCommand(settings, tmp_path, record=file), settings)
    with pytest.raises(InputError, match="--record is for one run"):
        check_starts(ReconstructCommand(settings, tmp_path, starts=2, record=tmp_path / "a.mcap"))


def test_the_sensor_of_a_recording():
    """Options by librealsense's names become the settings that they are about; what is not said has its default."""
    options: dict[str, Any] = {"exposure": 7000.0, "gain": 32.0, "laser_power": 210.0, "visual_preset": 3.0}
    options |= {"enable_auto_exposure": 0.0, "emitter_enabled": 1.0}
    found = SensorSettings.model_validate(sensor_fields(_recording(options, "Intel RealSense D415")))
    assert (found.model, found.preset, found.auto_exposure, found.depth.unit) == ("d415", "high_accuracy", False, UNIT)
    assert (found.imager.exposure_us, found.imager.gain, found.imager.laser_power_mw) == (7000.0, 32.0, 210.0)
    off = _recording({"laser_power": 210.0, "emitter_enabled": 0.0, "visual_preset": "Hand"}, None)
    dark = SensorSettings.model_validate(sensor_fields(off))
    assert (dark.imager.laser_power_mw, dark.preset, dark.model) == (0.0, "hand", "d435i")


def test_a_recording_by_another_sensor(recorded: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Thresholds that hold for a sensor are replayed, and it is said what the recording has otherwise or does not tell;
    a preset is told by its number, the mount's turn is the planner's."""
    file = tmp_path / "thresholds.yaml"
    stated = {"preset": "high_accuracy", "roll_deg": 90.0, "imager": {"laser_power_mw": 360}}
    file.write_text(yaml.safe_dump({"sensor": stated}))
    options: dict[str, Any] = {"laser_power": 360.0, "visual_preset": 3.0}
    assert unlike_sensor(file, _recording(options, None)) is None
    words = unlike_sensor(file, _recording({"laser_power": 150.0}, None))
    assert words == (
        f"{file}: its parameters hold for imager.laser_power_mw 360.0, preset high_accuracy; "
        "the recording has imager.laser_power_mw 150.0 and does not tell preset"
    )
    ours = SensorSettings(preset="high_accuracy").resolved().model_dump(mode="json")
    simulated = replace(_recording({}, None), run=RunFacts(sensor=ours))
    told = unlike_sensor(file, simulated)
    assert told is not None
    assert told.endswith("hold for imager.laser_power_mw 360.0; the recording has imager.laser_power_mw 150.0")
    live = {"options": options | {"exposure": None}, "settings": {"preset": "high_accuracy"}}
    assert unlike_sensor(file, replace(simulated, run=RunFacts(sensor=live))) is None
    assert main(["replay", str(recorded[1]), "--config", str(file), "--out", str(tmp_path / "out")]) == 0
    assert "the recording does not tell imager.laser_power_mw, preset" in capsys.readouterr().err
    file.write_text("sensor: {prest: hand}")
    with pytest.raises(InputError, match=r"thresholds.yaml, sensor: unknown key `prest`; did you mean preset"):
        unlike_sensor(file, simulated)
    file.write_text("sensor: 3")
    with pytest.raises(InputError, match="`sensor` holds no keys with values"):
        unlike_sensor(file, simulated)


def _recording(options: dict[str, Any], model: str | None) -> Recording:
    return Recording(Path("a.db3"), RunFacts(), CameraFacts(CAMERA, 0.1, UNIT, model), (), options=options)
