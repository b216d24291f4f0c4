"""A stored reconstruction: repeatable to the byte, resumable at every acquisition, and right against closed forms."""

import json
import shutil
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from studies.base.case_folder import finished_case, writing
from studies.base.config import Config
from studies.base.single_case import made_once
from studies.run.acquisition_table import ACQUISITION_COLUMNS
from studies.run.bursts import stored_depths
from studies.run.recorder import timing_figures
from studies.run.stored_run import StoredRun
from studies.store.ply import read_ply, write_ply
from studies.store.tables import write_rows
from tests.studies.run.analytic_ball import CENTRE, RADIUS, Ball, ball_depth, ball_reference, reconstruct_ball

TIMED = {"timings.json", "report.html"}
"""Files that hold times, which no two runs share."""


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An uninterrupted run."""
    folder = tmp_path_factory.mktemp("ball")
    reconstruct_ball(folder)
    return folder


def _files(folder: Path) -> dict[str, bytes]:
    found = (path for path in folder.rglob("*") if path.is_file() and path.name not in TIMED)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


def test_two_runs_of_one_seed_leave_the_same_bytes(case: Path, tmp_path: Path):
    """Everything but the times: table, clouds, surface, run.json, the arrays of every view, every capture."""
    reconstruct_ball(tmp_path)
    first, second = _files(case), _files(tmp_path)
    assert first.keys() == second.keys()
    assert [name for name in first if first[name] != second[name]] == []


@pytest.mark.parametrize("stop_at", [0, 1, 5])
def test_interrupted_run_goes_on_without_repeating(case: Path, tmp_path: Path, stop_at: int):
    """Cut off before a capture and taken up again: the same bytes, and no burst is taken twice."""
    wanted = len(StoredRun(case).rows)
    with pytest.raises(KeyboardInterrupt):
        _write(tmp_path, Ball(fail_at=stop_at))
    assert finished_case(tmp_path, "ball") is None
    second = Ball()
    _write(tmp_path, second)
    assert len(second.taken) == wanted - stop_at
    assert _files(tmp_path / "ball") == _files(case)
    assert [path.name for path in tmp_path.iterdir()] == ["ball"]


def _write(out: Path, ball: Ball) -> None:
    with writing(out, "ball") as folder:
        reconstruct_ball(folder, ball)


def test_capture_of_another_pose_is_not_reused(case: Path, tmp_path: Path):
    """Captures that do not belong to the poses that are asked for are taken anew."""
    with pytest.raises(KeyboardInterrupt):
        _write(tmp_path, Ball(fail_at=3))
    captures = tmp_path / ".partial-ball" / "captures"
    shutil.copy(captures / "002.npz", captures / "001.npz")
    ball = Ball()
    _write(tmp_path, ball)
    assert len(ball.taken) == len(StoredRun(case).rows) - 2
    assert _files(tmp_path / "ball") == _files(case)


def test_stored_bursts_are_what_the_camera_gave(case: Path):
    """Depth of pixels that meet the ball outside its highlight, against the closed form; noise is 0.5 mm, 3 frames."""
    row = StoredRun(case).rows[0]
    pose = RigidTransform.from_components(row["position"], Rotation.from_quat(row["quaternion_xyzw"]))
    depth, incidence = ball_depth(pose)
    seen = (incidence > 0.6) & (incidence < 1.2)
    assert np.abs(stored_depths(case, 0)[:, seen] - depth[seen]).max() < 5 * 0.0005
    assert np.all(stored_depths(case, 0)[:, np.nan_to_num(incidence, nan=9) < 0.4] == 0)


def test_table_has_the_schema_and_its_meanings(case: Path):
    """Names, order, types and meanings are those of the one list; every row is filled where its kind demands."""
    table = pq.read_table(case / "acquisitions.parquet")
    assert table.schema.names == [column.name for column in ACQUISITION_COLUMNS]
    assert all(
        (table.schema.field(c.name).metadata or {})[b"meaning"].decode() == c.meaning for c in ACQUISITION_COLUMNS
    )
    rows = table.to_pylist()
    assert [row["acquisition"] for row in rows] == list(range(len(rows)))
    assert [row["kind"] == "recovery" for row in rows] == [row["gamma"] is not None for row in rows]
    assert [row["kind"] == "recovery" for row in rows] == [row["activation"] is not None for row in rows]
    assert rows[0]["utility"] is None
    assert all(row["utility"] is not None for row in rows[1:])
    sets_off = 0
    for row in rows:
        assert row["activation"] in (None, sets_off)
        sets_off += row["recovery_poses"] is not None


def test_unknown_column_is_an_error(tmp_path: Path):
    """A misspelt name must not vanish."""
    with pytest.raises(ValueError, match="coverge"):
        write_rows(tmp_path / "t.parquet", ACQUISITION_COLUMNS, [{"acquisition": 0, "coverge": 1.0}])


def test_coverage_is_that_of_brute_force(case: Path):
    """Share of reference points with a point of the cloud so far within 5 mm, by all pairs of distances."""
    stored = StoredRun(case)
    cloud, seen_by = stored.cloud
    points, covered_at = stored.surface[0], stored.first_covered
    distance = np.linalg.norm(points[:, None].astype(np.float32) - cloud[None].astype(np.float32), axis=-1)
    for k, row in enumerate(stored.rows):
        covered = (distance[:, seen_by <= k] <= 0.005).any(axis=1)
        assert row["coverage_5mm"] == pytest.approx(covered.mean(), abs=2 / len(points))  # float32 at the edge
        assert np.mean((covered_at >= 0) & (covered_at <= k)) == pytest.approx(row["coverage_5mm"], abs=1e-12)


def test_coverage_of_the_map_is_that_of_the_mapped_cloud(case: Path):
    """After the last acquisition: the stored map-filtered cloud against the stored surface, by all pairs."""
    stored = StoredRun(case)
    mapped, _ = read_ply(case / "cloud_filtered.ply")
    distance = np.linalg.norm(stored.surface[0][:, None] - mapped[None].astype(np.float32), axis=-1).min(axis=1)
    edge = 2 / len(distance)  # float32
    assert np.mean(stored.surface[1], axis=1) == pytest.approx([row["coverage_map_5mm"] for row in stored.rows])
    assert stored.rows[-1]["coverage_map_5mm"] == pytest.approx(np.mean(distance <= 0.005), abs=edge)
    assert stored.rows[-1]["filtered_coverage_7_5mm"] == pytest.approx(np.mean(distance <= 0.0075), abs=edge)


def test_cloud_lies_on_the_ball(case: Path):
    """Every stored point that is clearly above the table is on the sphere, to the camera's 0.5 mm noise."""
    cloud, _ = StoredRun(case).cloud
    high = cloud[cloud[:, 2] > 0.02]
    assert len(high) > 300
    assert np.abs(np.linalg.norm(high - CENTRE, axis=1) - RADIUS).max() < 0.004


def test_summary_agrees_with_table_and_closed_form(case: Path):
    """Last row = summary; accuracy = mean distance to the sphere; recovery share from the table's increments."""
    stored = StoredRun(case)
    summary, rows = stored.run["summary"], stored.rows
    cloud, _ = stored.cloud
    assert summary["coverage_5mm"] == rows[-1]["coverage_5mm"]
    assert summary["filtered_coverage_5mm"] == pytest.approx(rows[-1]["filtered_coverage_5mm"], abs=1e-12)
    assert summary["accuracy_mm"] == pytest.approx(1000 * ball_reference().distance(cloud).mean(), rel=1e-4)
    coverage = np.array([0.0] + [row["coverage_5mm"] for row in rows])
    recovered = sum(step for step, row in zip(np.diff(coverage), rows, strict=True) if row["kind"] == "recovery")
    assert summary["recovery_share"] == pytest.approx(recovered / coverage[-1])
    mapped = np.array([0.0] + [row["coverage_map_5mm"] for row in rows])
    assert summary["coverage_map_5mm"] == mapped[-1]
    assert np.allclose([row["increment_map_5mm"] for row in rows], np.diff(mapped), atol=1e-12)
    brought = sum(row["increment_map_5mm"] for row in rows if row["kind"] == "recovery")
    assert summary["recovery_contribution"] == pytest.approx(brought)
    assert summary["recovery_activations"] == sum(row["recovery_poses"] is not None for row in rows) > 0
    assert summary["acquisitions"] == len(rows)
    assert summary["nbv_iterations"] == sum(row["kind"] == "nbv" for row in rows)


def test_run_json_lets_the_run_be_repeated(case: Path):
    """The resolved configuration, the seed and the versions are there; NaN never, which is no JSON."""
    run = json.loads((case / "run.json").read_text(), parse_constant=pytest.fail)
    assert run["config"]["seed"] == 0
    assert run["config"]["parameters"]["voxel_size"] == 0.0075
    assert {"franbv", "mitsuba", "numpy", "python"} <= run["versions"].keys()


def test_medians_of_times():
    """Planning is the sum of all stages but sensing; medians by hand."""
    times = [{"sensing": 3.0, "map": 0.1, "score": 0.2}, {"sensing": 1.0, "map": 0.1}, {"sensing": 2.0, "map": 0.5}]
    figures = timing_figures(times, 9.0, 7.0)
    medians = {"planning_s_median": pytest.approx(0.3), "sensing_s_median": 2.0}
    assert figures == {**medians, "wall_s": 9.0, "processor_s": 7.0}


def test_same_command_finds_the_finished_case(tmp_path: Path):
    """Made once, found the second time, and shown at the top of the output folder by links."""

    class Settings(Config):
        seed: int = 0

    made: list[Path] = []

    def make(folder: Path) -> None:
        made.append(folder)
        (folder / "report.html").write_text(f"made {len(made)}")

    first = made_once("test", Settings(), tmp_path, ["report.html", "absent.txt"], make)
    again = made_once("test", Settings(), tmp_path, ["report.html", "absent.txt"], make)
    assert (first[1], again[1], len(made)) == (False, True, 1)
    assert first[0] == again[0]
    made_once("test", Settings(seed=1), tmp_path, ["report.html"], make)
    assert (tmp_path / "report.html").read_text() == "made 2"
    made_once("test", Settings(), tmp_path, ["report.html"], make)
    assert (tmp_path / "report.html").read_text() == "made 1"
    assert not (tmp_path / "absent.txt").is_symlink()


def test_links_never_replace_a_file_of_the_user(tmp_path: Path):
    """A real file with the name of a result stays as it is."""
    (tmp_path / "report.html").write_text("mine")

    def make(folder: Path) -> None:
        (folder / "report.html").write_text("made")

    made_once("test", Config(), tmp_path, ["report.html"], make)
    assert (tmp_path / "report.html").read_text() == "mine"


def test_ply_comes_back_and_is_read_by_others(tmp_path: Path):
    """Round trip to float32, and the same points through trimesh's independent reader."""
    import trimesh

    points, owner = np.random.default_rng(0).normal(size=(50, 3)), np.arange(50)
    write_ply(tmp_path / "c.ply", points, owner)
    again, owner_again = read_ply(tmp_path / "c.ply")
    assert np.array_equal(again, points.astype(np.float32))
    assert np.array_equal(owner_again, owner)
    cloud = trimesh.load(tmp_path / "c.ply")
    assert np.allclose(cloud.vertices, points, atol=1e-6)  # type: ignore[union-attr]
    (tmp_path / "c.ply").write_bytes((tmp_path / "c.ply").read_bytes()[:-7])
    with pytest.raises(ValueError, match="cut short"):
        read_ply(tmp_path / "c.ply")
