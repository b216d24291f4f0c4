"""What one command of a comparison leaves to the next: the arms, and how its runs and failures are counted."""

import json
from pathlib import Path

import pytest

from studies.cli.main import main
from studies.comparison.command import STUDY, STUDY_FORMAT, with_stored_arms, write_preset
from studies.comparison.planning_speed import SPEED_JOB
from studies.comparison.preset import CORNER, ComparisonPreset
from studies.comparison.statistics import Comparison
from studies.comparison.summary import failed_runs, json_summary
from studies.work.workers import Failure
from tests.studies.comparison.comparison_records import made_record


def test_a_second_command_keeps_the_arms_of_the_first(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Ablations, then links, then neither in one folder: all arms remain, each once, and nothing is warned of."""
    quick = ComparisonPreset.named("quick")
    for field, names in (("ablations", ("poses_8", "unweighted")), ("links", ("mirror",)), ("ablations", ("poses_8",))):
        preset = with_stored_arms(quick.model_copy(update={field: names}), tmp_path)
        write_preset(tmp_path, preset)
    assert with_stored_arms(quick, tmp_path) == quick.model_copy(
        update={"ablations": ("poses_8", "unweighted"), "links": ("mirror",)}
    )
    assert capsys.readouterr().err == ""


def test_arms_of_another_study_are_left_out_aloud(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """More runs in the folder of a quick study: the arms that it had are named, and what differs is."""
    stored = ComparisonPreset.named("quick").model_copy(update={"ablations": ("poses_8", "unweighted")})
    write_preset(tmp_path, stored)
    paper = ComparisonPreset.named("paper").model_copy(update={"ablations": ("poses_8",)})
    assert with_stored_arms(paper, tmp_path) == paper
    warning = capsys.readouterr().err
    assert "runs" in warning
    assert "its unweighted are not in this one" in warning


def test_an_unreadable_study_is_replaced_aloud(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A key of another version must not keep the study from going on."""
    stored = {"format": STUDY_FORMAT, "preset": {"title": "Old", "glue": 1}}
    (tmp_path / STUDY).write_text(json.dumps(stored))
    assert with_stored_arms(ComparisonPreset.named("quick"), tmp_path) == ComparisonPreset.named("quick")
    assert "unknown key `glue`" in capsys.readouterr().err


def test_json_counts_the_planners_runs_apart():
    """Two planners on A and C; the corner, an ablation and a changed link stand beside them."""
    arms = [
        ("A", "fra"),
        ("A", "pb"),
        ("C", "fra"),
        ("C", "pb"),
        (CORNER, "fra"),
        ("C", "poses_8"),
        ("C", "pb, mirror"),
    ]
    records = [made_record(part, arm, run) for part, arm in arms for run in range(2)]
    summary = json_summary(Comparison(records), ["A", "C", CORNER], ("fra", "pb"), 0, 1.0)
    assert (summary["runs"], summary["other_runs"]) == (8, 6)


def test_planning_times_that_failed_are_no_run():
    """One run of the two jobs that failed."""
    assert failed_runs([Failure("D re, run 3", "SIGKILL"), Failure(SPEED_JOB, "SIGKILL")]) == 1


def test_a_study_of_an_older_version_is_not_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Its runs go by other names: a report of none of them must not replace that of all."""
    old = {STUDY: ComparisonPreset.named("quick").model_dump_json(), "report.html": "all", "summary.json": "{}"}
    for name, text in old.items():
        (tmp_path / name).write_text(text)
    assert main(["report", str(tmp_path)]) == 2
    assert "was written by an older or newer version (format 1, here" in capsys.readouterr().err
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == old
