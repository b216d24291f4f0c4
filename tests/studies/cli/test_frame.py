"""A rendered frame of a matte plate seen from above, and a CAD file reconstructed: files, units, truth, repetition."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import trimesh

from franbv.adapters.recording.depth_codes import STEPS_16, coding_of
from franbv.adapters.recording.mcap_recording import read_recording
from render.sensor import SensorSettings
from studies.cli.main import main
from studies.store.images import millimetres, read_exr

DISTANCE, THICKNESS, TOP = 0.4, 0.004, 0.08
"""The camera stands 0.4 m above the middle of the level plate, whose front face is 80 mm above the table [m]."""
Z = DISTANCE - THICKNESS / 2
"""Z-depth of the front face."""
ARGS = ["frame", "--part", "plate", "--material", "matte_paint", "--pose", f"0,90,{DISTANCE}"]


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The output folder of one frame."""
    folder = tmp_path_factory.mktemp("frame")
    assert main([*ARGS, "--out", str(folder)]) == 0
    return folder


def _part(out: Path) -> np.ndarray:
    meta = json.loads((out / "meta.json").read_text())
    ids = cv2.imread(str(out / "part.png"), cv2.IMREAD_UNCHANGED)
    assert ids is not None
    plate = 1 + [body["is_part"] for body in meta["bodies"]].index(True)
    return ids == plate


def test_every_layer_is_there_with_its_type_and_size(out: Path):
    """The contract's files; infrared 8-bit, depth 16-bit, all at 640 x 360 but the planner's 60 x 40."""
    shapes = {"infra1.png": np.uint8, "infra2.png": np.uint8, "depth.png": np.uint16, "part.png": np.uint8}
    for name, dtype in shapes.items():
        image = cv2.imread(str(out / name), cv2.IMREAD_UNCHANGED)
        assert image is not None
        assert (image.shape, image.dtype) == ((360, 640), dtype)
    small = cv2.imread(str(out / "depth_60x40.png"), cv2.IMREAD_UNCHANGED)
    assert small is not None
    assert (small.shape, small.dtype) == ((40, 60), np.uint16)
    assert read_exr(out / "truth_depth.exr", "Y").shape == (360, 640)


def test_truth_of_a_plate_across_the_axis(out: Path):
    """Z is the same all over a plate across the optical axis; the incidence angle is that of the pixel's ray."""
    part = _part(out)
    assert np.allclose(read_exr(out / "truth_depth.exr", "Y")[part], Z, atol=1e-5)
    v, u = np.nonzero(part)
    full = json.loads((out / "meta.json").read_text())["intrinsics"]["full"]
    expected = np.arctan(np.hypot((u - full["cx"]) / full["fx"], (v - full["cy"]) / full["fy"]))
    assert np.allclose(read_exr(out / "incidence.exr", "Y")[part], expected, atol=1e-4)


def test_plate_has_its_projected_size(out: Path):
    """100 mm at 0.398 m and 321 px are 80.65 px: that many columns and rows, to one pixel at either edge."""
    rows, columns = np.nonzero(_part(out))
    for pixels in (np.ptp(rows) + 1, np.ptp(columns) + 1):
        assert abs(pixels - 321 * 0.1 / Z) <= 2


def test_depth_is_in_millimetres_and_near_the_truth(out: Path):
    """A matte plate at 0.4 m: filled, and within 1 % in the median, in the full image and in the decimated one."""
    depth = cv2.imread(str(out / "depth.png"), cv2.IMREAD_UNCHANGED)
    small = cv2.imread(str(out / "depth_60x40.png"), cv2.IMREAD_UNCHANGED)
    assert depth is not None
    assert small is not None
    inside = cv2.erode(_part(out).astype(np.uint8), np.ones((17, 17))) > 0
    assert np.mean(depth[inside] > 0) > 0.97
    assert np.median(depth[inside]) == pytest.approx(1000 * Z, rel=0.01)
    assert np.median(small[18:22, 28:32]) == pytest.approx(1000 * Z, rel=0.01)


def test_meta_holds_pose_intrinsics_and_units(out: Path):
    """The pose is the one asked for: 0.4 m above the plate's middle, looking straight down; the crop keeps fx / 8."""
    meta = json.loads((out / "meta.json").read_text())
    pose = np.array(meta["T_world_cam"])
    assert np.allclose(pose[:3, 3], [0, 0, TOP - THICKNESS / 2 + DISTANCE], atol=1e-9)
    assert np.allclose(pose[:3, 2], [0, 0, -1], atol=1e-9)
    right = np.array(meta["T_world_right_cam"])
    assert np.linalg.norm(right[:3, 3] - pose[:3, 3]) == pytest.approx(0.05)
    assert meta["intrinsics"]["reduced"]["fx"] == pytest.approx(321 / 8)
    assert all("[" in meaning or "number" in meaning for meaning in meta["layers"].values())
    assert sum(body["is_part"] for body in meta["bodies"]) == 1
    assert meta["bodies"][0]["material"]


def test_every_invalid_pixel_has_a_cause_with_a_colour(out: Path):
    """Where depth is 0 the map of causes names one of missing depth, elsewhere none; the picture shows the legend's
    colours; a matte plate loses nothing to reflection. The same at the planner's resolution."""
    by_code = {entry["code"]: entry for entry in json.loads((out / "legend.json").read_text())}
    missing = [code for code in by_code if 0 < code < 20]
    for depth_file, cause_file in (("depth.png", "cause_id.png"), ("depth_60x40.png", "cause_id_60x40.png")):
        depth, causes = (cv2.imread(str(out / file), cv2.IMREAD_UNCHANGED) for file in (depth_file, cause_file))
        assert depth is not None
        assert causes is not None
        assert np.array_equal(np.isin(causes, missing), depth == 0)
    causes, colours = cv2.imread(str(out / "cause_id.png"), cv2.IMREAD_UNCHANGED), cv2.imread(str(out / "cause.png"))
    assert causes is not None
    assert colours is not None
    for code in np.unique(causes).tolist():
        assert np.all(colours[causes == code] == by_code[code]["colour"][::-1])
        assert by_code[code]["pixels"] == np.count_nonzero(causes == code)
        assert by_code[code]["cause"] != "reflection"
    assert (out / "legend.png").is_file()


def test_same_command_finds_the_frame(out: Path, capsys: pytest.CaptureFixture[str]):
    """No second rendering: the same folder, and the summary as one JSON object on the last line."""
    assert main([*ARGS, "--out", str(out), "--json"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("Found: ") for line in lines)
    summary = json.loads(lines[-1])
    assert Path(summary["folder"]).is_dir()
    assert summary["part_fill"] > 0.9
    assert sum(path.is_dir() and not path.is_symlink() for path in out.iterdir()) == 1


def test_depth_that_does_not_fit_is_invalid():
    """16 bits hold 65.535 m; beyond, a pixel has no depth rather than a wrapped one."""
    assert millimetres(np.array([[0.0, 0.4004, 65.535, 65.6]])).tolist() == [[0, 400, 65535, 0]]


def test_cad_file_is_reconstructed_from_end_to_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A box of 60 x 40 x 30 mm in STL: exit status 0, all files, the promised keys, and found when asked again."""
    trimesh.creation.box((60, 40, 30)).export(tmp_path / "box.stl")
    args = ["reconstruct", "--mesh", str(tmp_path / "box.stl"), "--units", "mm", "--material", "iron:blasted"]
    args += ["--parameters.n-frames", "2", "--parameters.max-iterations", "1", "--out", str(tmp_path / "out"), "--json"]
    record = tmp_path / "run.mcap"
    assert main([*args, "--record", str(record)]) == 0
    lines = capsys.readouterr().out.splitlines()
    summary = json.loads(lines[-1])
    promised = (
        "coverage_map_5mm coverage_5mm filtered_coverage_5mm accuracy_mm f_score acquisitions nbv_iterations "
        "recovery_activations recovery_contribution recovery_share stop planning_s_median sensing_s_median wall_s "
        "processor_s"
    )
    assert set(promised.split()) <= summary.keys()
    assert summary["nbv_iterations"] == 1
    assert summary["coverage_5mm"] > 0.2
    assert "box.stl, iron:blasted: FRA-NBV took" in lines[0]
    for name in ("run.json", "acquisitions.parquet", "cloud.ply", "cloud_filtered.ply", "report.html"):
        assert (tmp_path / "out" / name).stat().st_size > 0
    config = json.loads((tmp_path / "out" / "run.json").read_text())["config"]
    assert config["mesh"] == "box.stl"
    assert len(config["digests"]["mesh"]) == 16
    assert main(args) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1]) == summary
    assert main(["report", str(tmp_path / "out"), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out.splitlines()[-1])["reports"]) == 1
    assert main([*args, "--record", str(tmp_path / "another.mcap")]) == 2
    assert "holds this very run already" in capsys.readouterr().err
    replayed_without_rendering(record, tmp_path / "replayed", summary, capsys)


def replayed_without_rendering(
    record: Path, out: Path, summary: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """The recording of the run above gives every decision again; it is as long as the run and has its sensor."""
    assert main(["replay", str(record), "--out", str(out), "--json"]) == 0
    found = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert (found["mode"], found["decisions_equal"]) == ("closed_loop", True)
    assert (found["acquisitions"], found["stop"]) == (summary["acquisitions"], summary["stop"])
    recording = read_recording(record)
    assert SensorSettings.model_validate(recording.run.sensor) == SensorSettings(roll_deg=0.0).resolved()
    assert recording.bursts[0].read_infrared() is not None
    assert coding_of(recording.bursts[0].read().depths, recording.camera.depth_unit) == STEPS_16


def test_a_filter_comes_from_a_file(tmp_path: Path):
    """A part of the settings that may be none has no flags and makes no subcommands; from a file it reaches the camera,
    with the lamps off and on. So do polarisers."""
    file = tmp_path / "filtered.yaml"
    file.write_text("sensor: {imager: {band_pass: {width_nm: 160}, polarisers: {imagers_deg: 90, projector_deg: 0}}}\n")
    command = [*ARGS, "--config", str(file), "--out", str(tmp_path / "out")]
    for lamps in (["--lamps", "off"], []):
        assert main([*command, *lamps]) == 0
        meta = json.loads((tmp_path / "out" / "latest" / "meta.json").read_text())
        assert meta["config"]["sensor"]["imager"]["band_pass"]["width_nm"] == 160
        assert meta["config"]["sensor"]["imager"]["polarisers"]["imagers_deg"] == 90
