"""The command: bad input, a stopped study that is taken up again, and its folder as all that a report needs."""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from franbv.parameters import Parameters
from studies.cli.main import Stopped, main
from studies.comparison.command import write_preset
from studies.comparison.preset import ComparisonPreset
from studies.readings import command
from studies.readings.evaluation import READING_RUNS, READINGS_PAGE, READINGS_SUMMARY
from studies.run.batch import RUNS, PlannedRun, jobs
from studies.run.run_case import RunSettings
from studies.work.workers import Failure
from tests.studies.run.analytic_ball import reconstruct_ball

TINY = "title: Tiny readings\nparts: [D]\nstarts: 1\nparameters: {max_iterations: 1, n_frames: 3}\n"


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """One finished run of a ball by each planner."""
    made = {}
    for planner in ("pb", "fra"):
        made[planner] = tmp_path_factory.mktemp(planner)
        settings = RunSettings(planner=planner, parameters=Parameters(n_frames=3, max_iterations=1))
        reconstruct_ball(made[planner], settings=settings)
    return made


class Worker:
    """Stands in for the executor: finishes runs in their order, with the ball's files, until it is stopped."""

    def __init__(self, cases: dict[str, Path], most: int) -> None:
        self.cases, self.most, self.made = cases, most, 0

    def __call__(self, out: Path, runs: Sequence[PlannedRun], executor: object, program: str) -> list[Failure]:
        for job in jobs(out, runs):
            if self.made == self.most:
                raise Stopped(15)
            run = next(run for run in runs if run.title == job.name)
            shutil.copytree(self.cases[run.config.planner], out / RUNS / run.digest)
            self.made += 1
        return []


def test_a_stopped_study_is_taken_up_again(
    cases: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """Stopped after 10 of 32 runs the command makes 22 more the next time, none the third, and then says the same."""
    (tmp_path / "tiny.yaml").write_text(TINY)
    flags = ["study", "readings", "--out", str(tmp_path / "out"), "--preset", str(tmp_path / "tiny.yaml"), "--json"]
    printed = []
    for most, made, status in ((10, 10, 128 + 15), (100, 22, 0), (100, 0, 0)):
        worker = Worker(cases, most)
        monkeypatch.setattr(command, "make_runs", worker)
        assert main(flags) == status
        assert worker.made == made
        printed.append(capsys.readouterr().out.splitlines()[-1:])
    assert printed[0] == []
    second, third = (json.loads(lines[0]) for lines in printed[1:])
    assert (second["runs"], second["planned"], second["failed"]) == (32, 32, 0)
    assert {**second, "wall_s": 0} == {**third, "wall_s": 0}
    assert pq.read_table(tmp_path / "out" / READING_RUNS).num_rows == 32
    # All readings gave the same ball: no decision moves anything, and the method as it comes stays.
    assert second["sure"] == []
    assert [row["effect"] for row in second["effects"]["distance"]] == pytest.approx([0.0] * 13, abs=1e-12)
    assert second["candidates"][1]["second"] == []


def test_report_rebuilds_from_the_folder_alone(
    cases: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """The same bytes; and where a comparison confirms a reading in the same folder, the reports of both."""
    preset = tmp_path / "tiny.yaml"
    preset.write_text(TINY)
    out = tmp_path / "out"
    monkeypatch.setattr(command, "make_runs", Worker(cases, 100))
    assert main(["study", "readings", "--out", str(out), "--preset", str(preset)]) == 0
    first = {name: (out / name).read_bytes() for name in (READINGS_PAGE, READINGS_SUMMARY)}
    assert main(["report", str(out)]) == 0
    assert {name: (out / name).read_bytes() for name in first} == first
    write_preset(out, ComparisonPreset.named(str(out / "reading_best.yaml")))
    capsys.readouterr()
    assert main(["report", str(out)]) == 0
    assert {Path(line).name for line in capsys.readouterr().out.splitlines()} == {READINGS_PAGE, "report.html"}


def test_another_version_is_not_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Runs of another format go by other names; the report of none of them must not replace that of all."""
    (tmp_path / command.READINGS).write_text(json.dumps({"format": 0, "preset": {}}))
    assert main(["report", str(tmp_path)]) == 2
    assert "was written by an older or newer version (format 0, here" in capsys.readouterr().err
    assert not (tmp_path / READINGS_PAGE).exists()


def test_a_preset_in_the_folder_is_not_overwritten(
    cases: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """The candidates' files have fixed names; a preset of the user's that is called so is refused, and stays."""
    own = tmp_path / "reading_best.yaml"
    own.write_text(TINY)
    monkeypatch.setattr(command, "make_runs", Worker(cases, 100))
    assert main(["study", "readings", "--out", str(tmp_path), "--preset", str(own)]) == 2
    assert "reading_best.yaml" in capsys.readouterr().err
    assert own.read_text() == TINY
