"""Many starts of one reconstruction: which they are, what is made anew, what is told of them, what is refused."""

import contextlib
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from franbv.parameters import Parameters
from studies.cli.main import main
from studies.comparison.cases import run_settings
from studies.comparison.preset import ComparisonPreset
from studies.run.ablation import Ablation
from studies.run.reconstruct import ReconstructSettings, resolved_run
from studies.run.run_case import RunSettings
from studies.run.starts import runs
from studies.run.starts.runs import spread_starts, stored_starts
from studies.run.starts.summary import WHY_MANY, spread_of
from studies.run.stored_run import StoredRun
from studies.work.workers import Failure
from tests.studies.run.analytic_ball import reconstruct_ball

SHORT = Parameters(n_frames=3, max_iterations=1)
COMMAND = ["reconstruct", "--part", "A", "--starts", "3", "--json"]


class Inline:
    """Does the jobs in this process, so that the sensor can be exchanged; gives up what raises."""

    def run(self, stages, already_done=0, tell=lambda _: None):
        """All of them, one after the other."""
        failures = []
        for job in stages[0]:
            try:
                job.work(job.argument)
            except OSError as error:
                failures.append(Failure(job.name, str(error)))
        return failures

    def check_folder(self, folder):
        """It is this process's."""

    def makers(self):
        """Nobody else."""
        return {}


class Balls:
    """Stands in for the simulated camera: every start is a run on the analytic ball, with its own azimuth and seed."""

    def __init__(self, models: Path) -> None:
        self.models = models
        self.made: list[float] = []
        self.failing: dict[float, BaseException] = {}

    def simulate(self, folder: Path, config: ReconstructSettings, subject: object, watched: bool) -> None:
        """Leave what a run leaves."""
        if config.azimuth_deg in self.failing:
            raise self.failing[config.azimuth_deg]
        self.made.append(config.azimuth_deg)
        model = self.models / f"{config.azimuth_deg:g}"
        if not model.exists():
            model.mkdir()
            settings = RunSettings(parameters=SHORT, azimuth_deg=config.azimuth_deg, seed=config.seed)
            reconstruct_ball(model, settings=settings)
        shutil.copytree(model, folder, dirs_exist_ok=True)


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of each azimuth, made once for all tests."""
    return tmp_path_factory.mktemp("models")


@pytest.fixture
def balls(models: Path, monkeypatch: pytest.MonkeyPatch) -> Balls:
    """What is made, and what fails."""
    stand_in = Balls(models)
    monkeypatch.setattr(runs, "simulate", stand_in.simulate)
    monkeypatch.setattr(runs, "executor_of", lambda flags: contextlib.nullcontext(Inline()))
    return stand_in


def test_starts_are_spread_around_the_part():
    """From the azimuth that is given, in even steps; seeds are those of the azimuths, so three are among nine."""
    config = resolved_run(ReconstructSettings(part="A", azimuth_deg=300.0))
    starts = spread_starts(config, 3)
    assert [start.config.azimuth_deg for start in starts] == [300.0, 60.0, 180.0]
    assert len({start.config.seed for start in starts}) == 3
    assert {start.digest for start in starts} < {start.digest for start in spread_starts(config, 9)}


def test_starts_are_the_runs_of_the_comparison():
    """The same part, planner and root seed: a study of five runs finds each of them by its name."""
    preset = ComparisonPreset(title="", starts=5, runs=5, parts=("A",))
    starts = spread_starts(resolved_run(ReconstructSettings(part="A", bench="paper", planner="pb")), 5)
    assert [start.config for start in starts] == [run_settings(preset, "A", "pb", k, Ablation()) for k in range(5)]


def test_mean_interval_and_spread_of_known_values():
    """1, 2, 3: mean 2, standard deviation 1, an interval around the mean; of one value there is no deviation."""
    found = spread_of([1.0, 2.0, 3.0])
    assert (found.mean, found.sd, found.min, found.max, found.runs) == (2.0, 1.0, 1.0, 3.0, 3)
    assert 1.0 <= found.low < 2.0 < found.high <= 3.0
    assert spread_of([4.0]).sd is None


def test_starts_are_made_told_and_shown(balls: Balls, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A case for each start; JSON, words and page hold the mean and the spread of what their tables hold."""
    assert main([*COMMAND, "--out", str(tmp_path)]) == 0
    assert balls.made == [0.0, 120.0, 240.0]
    words, _, summary = capsys.readouterr().out.splitlines()
    told = json.loads(summary)
    _, starts = stored_starts(tmp_path)
    final = [StoredRun(tmp_path / start.digest).rows[-1]["coverage_map_5mm"] for start in starts]
    assert len(set(final)) == 3
    assert told["coverage_map_5mm"] == pytest.approx(np.mean(final))
    figure = told["figures"]["coverage_map_5mm"]
    assert figure["sd"] == pytest.approx(np.std(final, ddof=1))
    assert (figure["min"], figure["max"], figure["runs"]) == (min(final), max(final), 3)
    assert told["coverage_map_ci95"] == [figure["low"], figure["high"]]
    assert [case["coverage_map_5mm"] for case in told["cases"]] == final
    assert (told["starts"], told["runs"], told["failed"]) == (3, 3, 0)
    assert f"{100 * np.mean(final):.1f} % of the visible surface" in words
    assert WHY_MANY in words
    page = (tmp_path / "starts.html").read_text()
    assert page.count("<circle") == sum(len(StoredRun(tmp_path / start.digest).rows) for start in starts)
    links = re.findall(r'href="([^"#:]*)"', page)
    assert len(links) == 3
    assert all((tmp_path / link).is_file() for link in links)


def test_finished_starts_are_not_made_again(balls: Balls, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Stopped in the second of three, the same command makes two; with more starts only those that are new."""
    balls.failing = {120.0: KeyboardInterrupt()}
    with pytest.raises(KeyboardInterrupt):
        main([*COMMAND, "--out", str(tmp_path)])
    assert balls.made == [0.0]
    balls.failing = {}
    assert main([*COMMAND, "--out", str(tmp_path)]) == 0
    assert balls.made == [0.0, 120.0, 240.0]
    told = capsys.readouterr().out
    assert main([*COMMAND, "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().out == told
    assert main([*COMMAND, "--starts", "6", "--out", str(tmp_path)]) == 0
    assert sorted(balls.made) == [60.0 * k for k in range(6)]


def test_a_start_that_fails_is_counted_and_the_rest_told(balls: Balls, tmp_path: Path, capsys):
    """Exit status 1; of three starts two are there."""
    balls.failing = {120.0: OSError("broken")}
    assert main([*COMMAND, "--out", str(tmp_path)]) == 1
    words, _, summary = capsys.readouterr().out.splitlines()
    assert "Over 2 starts of 3 of FRA-NBV" in words
    assert (json.loads(summary)["runs"], json.loads(summary)["failed"]) == (2, 1)
    balls.failing = dict.fromkeys((0.0, 120.0, 240.0), OSError("broken"))
    assert main([*COMMAND, "--out", str(tmp_path / "none")]) == 1
    words, _, summary = capsys.readouterr().out.splitlines()
    assert "None of 3 starts came to its end" in words
    assert json.loads(summary)["coverage_map_5mm"] is None


def test_report_rebuilds_the_pages_of_all_starts(balls: Balls, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Those of the runs and the one over them, from what the folder holds."""
    assert main([*COMMAND, "--out", str(tmp_path)]) == 0
    pages = [*tmp_path.glob("*/report.html"), tmp_path / "starts.html"]
    before = {page: page.read_bytes() for page in pages}
    for page in pages:
        page.unlink()
    assert main(["report", str(tmp_path)]) == 0
    assert {page: page.read_bytes() for page in pages} == before


def _complaint(capsys: pytest.CaptureFixture[str], *args: str) -> str:
    assert main(["reconstruct", "--part", "A", *args]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    return err


def test_bad_input_is_one_line(balls: Balls, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """No runs at all, workers without starts, a folder that is a study's or another reconstruction's, a damaged one."""
    out = str(tmp_path / "out")
    assert "--starts 0: there must be a run to make" in _complaint(capsys, "--starts", "0", "--out", out)
    assert "--workers is for many starts" in _complaint(capsys, "--workers", "2", "--out", out)
    assert "--workers 0" in _unpatched_complaint(capsys, out)
    (tmp_path / "comparison.json").touch()
    assert "holds a study (comparison.json)" in _complaint(capsys, "--starts", "2", "--out", str(tmp_path))
    assert main([*COMMAND, "--out", out]) == 0
    capsys.readouterr()
    changed = ("--starts", "3", "--planner", "pb", "--lamps", "off", "--out", out)
    assert "starts of a reconstruction with another lamps, planner; choose another --out" in _complaint(
        capsys, *changed
    )
    assert len(balls.made) == 3
    (tmp_path / "out" / "starts.json").write_text("{")
    assert "starts.json: cannot be read" in _complaint(capsys, "--starts", "3", "--out", out)


def _unpatched_complaint(capsys: pytest.CaptureFixture[str], out: str) -> str:
    with pytest.MonkeyPatch.context() as real:
        from studies.work.executor import executor_of

        real.setattr(runs, "executor_of", executor_of)
        return _complaint(capsys, "--starts", "2", "--workers", "0", "--out", out)
