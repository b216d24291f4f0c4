"""Runs in the viewer: live as the loop makes them, and from their folders, with the same things at the same steps."""

import contextlib
import io
import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from franbv.acquisition import Acquisition
from franbv.adapters.recording.contents import CameraFacts
from franbv.adapters.view import opening
from franbv.adapters.view.opening import rrd_file
from franbv.adapters.view.sight import ViewError
from materials.input_error import InputError
from studies.base.case_folder import case_digest
from studies.cli.main import main
from studies.cli.reconstruct import ReconstructCommand, check_starts, check_watchable
from studies.run.acquisition_table import ACQUISITION_COLUMNS
from studies.run.bursts import KeptCaptures
from studies.run.reconstruct import ReconstructSettings
from studies.run.recording import recording_of
from studies.run.run_case import RUN_COMMAND, RunSettings, write_run
from studies.run.stored_run import StoredRun
from studies.run.stored_sights import stored_sights
from studies.store.tables import write_rows
from tests.studies.run.analytic_ball import CAMERA, SETTINGS, Ball, FreeArm, ball_reference

pytest.importorskip("rerun")
from tests.franbv.adapters.view.rrd_reading import Drawn, counts, drawn, verified

SHARE = SETTINGS.parameters.invalid_share
PATHS = {
    "points": "/world/cloud:Points3D:positions",
    "occupied": "/world/voxels/occupied:Boxes3D:centers",
    "frontier": "/world/voxels/frontier:Boxes3D:centers",
    "occupied ellipsoids": "/world/ellipsoids/occupied:Ellipsoids3D:centers",
    "frontier ellipsoids": "/world/ellipsoids/frontier:Ellipsoids3D:centers",
    "regions": "/world/reflective_regions:Boxes3D:centers",
    "cameras": "/world/camera:Transform3D:translation",
}


@dataclass
class Both:
    """A view that keeps what it is shown."""

    view: Any
    seen: list[Acquisition] = field(default_factory=list)

    def observe(self, acquisition, coverage=None, infrared=None):
        self.seen.append(acquisition)
        self.view.observe(acquisition, coverage, infrared)

    def show(self, sight):
        self.view.show(sight)

    def infrared(self, index, image):
        self.view.infrared(index, image)


@dataclass
class Shown:
    """A run of the ball: its acquisitions, its case, its recording, and what was drawn while it lasted."""

    seen: list[Acquisition]
    case: Path
    recording: Path
    live: Drawn


def run_ball(folder: Path, settings: RunSettings = SETTINGS) -> Shown:
    """The ball reconstructed, recorded and shown."""
    case = folder / "case"
    case.mkdir()
    captures = KeptCaptures(Ball().take, CAMERA, 0.128, case)
    facts = CameraFacts(CAMERA, 0.128, 0.001)
    with (
        rrd_file(folder / "live.rrd", "Ball", SHARE) as view,
        recording_of(folder / "ball.mcap", settings, "Ball", facts, case, {}) as watch,
    ):
        both = Both(view)
        write_run(case, settings, "Ball", captures, FreeArm(), ball_reference(), False, watch, both)
    return Shown(both.seen, case, folder / "ball.mcap", drawn(folder / "live.rrd"))


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Shown:
    """A run with a recovery."""
    return run_ball(tmp_path_factory.mktemp("ball"))


def numbers(seen: list[Acquisition]) -> dict[str, list[int]]:
    """What must stand at each step."""
    return {
        "points": [len(a.points) for a in seen],
        "occupied": [len(a.model.object.occupied) for a in seen],
        "frontier": [len(a.model.object.frontier) for a in seen],
        "occupied ellipsoids": [len(a.model.ellipsoids.of_occupied()) for a in seen],
        "frontier ellipsoids": [len(a.model.ellipsoids.of_frontier()) for a in seen],
        "regions": [len(a.detection.boxes) if a.detection else 0 for a in seen],
        "cameras": [1] * len(seen),
    }


def numbers_in(found: Drawn) -> dict[str, list[int]]:
    """What stands at each step of a file."""
    return {name: counts(found, path) for name, path in PATHS.items()}


def test_a_run_is_shown_while_it_lasts(shown: Shown):
    """All of every acquisition, its infrared image and the coverage that the table has."""
    assert numbers_in(shown.live) == numbers(shown.seen)
    stored = StoredRun(shown.case)
    coverage = shown.live["/curves/coverage:Scalars:scalars"]
    assert [coverage[k] for k in range(len(coverage))] == [[row["coverage_map_5mm"]] for row in stored.rows]
    for k in range(len(shown.seen)):
        picture = stored.infrared(k)
        assert picture is not None
        assert bytes(shown.live["/infrared:Image:buffer"][k][0]) == picture.tobytes()


def test_a_stored_run_is_what_was_shown(shown: Shown, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Its folder says as much, step by step: voxels are made again of the stored depth. Of the poses planned for a
    recovery those that were taken are known, and that the others are not is said."""
    file = tmp_path / "ball.rrd"
    assert main(["report", str(shown.case), "--rrd", str(file), "--json"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out.splitlines()[-1])["rrds"] == [str(file)]
    assert verified(file).startswith("0: ")
    found = drawn(file)
    assert numbers_in(found) == numbers(shown.seen)
    for name in sorted(PATHS.values()):
        for step, things in shown.live[name].items():
            np.testing.assert_allclose(found[name][step], things, atol=1e-6, err_msg=name)
    same = ["/world/camera/lens/depth:DepthImage:buffer", "/infrared:Image:buffer"]
    same += [f"/curves/{name}:Scalars:scalars" for name in ("coverage", "occupied_voxels", "gamma", "utility")]
    for name in same:
        assert found[name] == shown.live[name], name
    planned = [len(a.recovery_poses.poses) if a.recovery_poses else 0 for a in shown.seen]
    taken = sum(a.kind == "recovery" for a in shown.seen)
    assert sum(counts(found, "/world/recovery_poses:Arrows3D:origins")) == taken > 0
    untaken = sum(planned) - taken
    assert (f"{untaken} recovery pose" in err) == (untaken > 0)
    for k, poses in found["/world/recovery_poses:Arrows3D:origins"].items():
        ours = shown.live["/world/recovery_poses:Arrows3D:origins"][k]
        assert {tuple(np.round(pose, 6)) for pose in poses} <= {tuple(np.round(pose, 6)) for pose in ours}


def test_each_case_has_a_file_of_its_own(shown: Shown, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Without a name; a name for several runs is refused, and so is what is there, before anything is written."""
    for name in ("a", "b"):
        shutil.copytree(shown.case, tmp_path / name)
    assert main(["report", str(tmp_path), "--rrd", str(tmp_path / "all.rrd")]) == 2
    assert f"{tmp_path} holds 2 runs; leave the name out" in capsys.readouterr().err
    assert main(["report", "--rrd", str(tmp_path / "a")]) == 0
    before = (tmp_path / "a" / "run.rrd").read_bytes()
    capsys.readouterr()
    assert main(["report", str(tmp_path), "--rrd"]) == 2
    err = capsys.readouterr().err
    assert err == (
        f"franbv report: {tmp_path / 'a' / 'run.rrd'}: is there already, and is never written over; name another file\n"
    )
    assert (tmp_path / "a" / "run.rrd").read_bytes() == before
    assert not (tmp_path / "b" / "run.rrd").exists()
    (tmp_path / "a" / "run.rrd").unlink()
    assert main(["report", str(tmp_path), "--rrd"]) == 0
    assert numbers_in(drawn(tmp_path / "b" / "run.rrd")) == numbers(shown.seen)


def test_a_study_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Its cases are runs, it is none."""
    (tmp_path / "comparison.json").write_text("{}")
    assert main(["report", str(tmp_path), "--rrd"]) == 2
    assert "holds a study; --rrd is for runs" in capsys.readouterr().err


def test_voxels_that_are_not_the_runs_are_left_out(shown: Shown, tmp_path: Path):
    """Where the table counts other voxels than the map made again has, and where the depth is not there."""
    case = shutil.copytree(shown.case, tmp_path / "case")
    stored = StoredRun(case)
    rows = [{**row, "occupied_voxels": row["occupied_voxels"] + (k == 2)} for k, row in enumerate(stored.rows)]
    write_rows(case / "acquisitions.parquet", ACQUISITION_COLUMNS, rows)
    sights, left_out = stored_sights(StoredRun(case), SETTINGS.parameters)
    assert all(sight.voxels is None for sight in sights)
    counted = rows[2]["occupied_voxels"]
    assert f"{counted - 1} occupied and" in left_out[0]
    assert f"after acquisition 3, and the run's had {counted} and" in left_out[0]
    each = SETTINGS.parameters.model_copy(update={"frames_into_map": "each"})
    shutil.rmtree(case / "captures")
    sights, left_out = stored_sights(StoredRun(case), each)
    assert all(sight.voxels is None and sight.infrared is None for sight in sights)
    assert "its depth frames were not kept" in left_out[0]


def test_frames_that_enter_one_by_one_do_so_again(tmp_path: Path):
    """`frames_into_map` "each": the map is made again of all frames, not of their median."""
    parameters = SETTINGS.parameters.model_copy(update={"frames_into_map": "each", "max_iterations": 1})
    shown = run_ball(tmp_path, SETTINGS.model_copy(update={"parameters": parameters}))
    sights, left_out = stored_sights(StoredRun(shown.case), parameters)
    assert not any("voxels" in words for words in left_out)
    for sight, acquisition in zip(sights, shown.seen, strict=True):
        assert sight.voxels is not None
        np.testing.assert_array_equal(sight.voxels.occupied, acquisition.model.object.occupied)
        np.testing.assert_array_equal(sight.voxels.frontier, acquisition.model.object.frontier)


@pytest.fixture
def live_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file that takes the place of a page."""
    path = tmp_path / "page.rrd"

    @contextlib.contextmanager
    def page(title, invalid_share, say) -> Iterator[Any]:
        say("http://127.0.0.1:1/")
        with rrd_file(path, title, invalid_share) as view:
            yield view

    monkeypatch.setattr(opening, "live_page", page)
    return path


@pytest.mark.parametrize("terminal", [True, False])
def test_a_replay_is_shown(
    shown: Shown,
    live_in: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    terminal: bool,
):
    """With the recorded images, and no coverage; it stays until Enter where somebody can press it. Its folder gives the
    same file, and once it is there, there is nothing left to watch."""
    stdin = io.StringIO("\nleft")
    monkeypatch.setattr(stdin, "isatty", lambda: terminal)
    monkeypatch.setattr("sys.stdin", stdin)
    args = ["replay", str(shown.recording), "--out", str(tmp_path / "out")]
    assert main([*args, "--view"]) == 0
    err = capsys.readouterr().err
    assert "Watch it at http://127.0.0.1:1/\n" in err
    assert ("until Enter is pressed" in err) == terminal
    assert stdin.read() == ("left" if terminal else "\nleft")
    found = drawn(live_in)
    assert numbers_in(found) == numbers_in(shown.live)
    assert found["/infrared:Image:buffer"] == shown.live["/infrared:Image:buffer"]
    assert "/curves/coverage:Scalars:scalars" not in found
    assert main(["report", str(tmp_path / "out"), "--rrd", str(tmp_path / "again.rrd")]) == 0
    assert numbers_in(drawn(tmp_path / "again.rrd")) == numbers_in(found)
    assert main([*args, "--view"]) == 2
    assert "holds this very replay already" in capsys.readouterr().err


def test_what_cannot_be_watched_is_refused_at_once(tmp_path: Path):
    """Many starts, and a run that is there already."""
    settings = ReconstructSettings(part="A")
    with pytest.raises(InputError, match="--view is for one run"):
        check_starts(ReconstructCommand(settings, tmp_path, starts=2, view=True))
    check_watchable(ReconstructCommand(settings, tmp_path, view=True), settings)
    (tmp_path / case_digest(RUN_COMMAND, settings)).mkdir()
    with pytest.raises(InputError, match="holds this very run already"):
        check_watchable(ReconstructCommand(settings, tmp_path, view=True), settings)
    check_watchable(ReconstructCommand(settings, tmp_path), settings)


def test_a_missing_package_is_one_line(
    shown: Shown, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    """Of the command line, before anything is made."""

    def missing(*_: object) -> None:
        raise ViewError("views need the package rerun-sdk; pip install 'franbv[view]'")

    monkeypatch.setattr(opening, "live_page", missing)
    assert main(["replay", str(shown.recording), "--out", str(tmp_path / "out"), "--view"]) == 2
    assert capsys.readouterr().err == ("franbv replay: views need the package rerun-sdk; pip install 'franbv[view]'\n")
    assert not (tmp_path / "out").exists()
