"""Reconstructions as draws: finished cases count for what they covered and took, and make a cell's reference."""

import json
import shutil
from pathlib import Path

import pytest
import yaml

from studies.base.case_folder import case_digest
from studies.cli.main import main
from studies.run.acquisition_table import MAP_COVERAGE
from studies.run.batch import RUNS
from studies.run.run_case import RUN_COMMAND
from studies.run.stored_run import StoredRun
from studies.thresholds.command import resolved_preset
from studies.thresholds.config import ThresholdsPreset
from studies.thresholds.reconstructions import cell_reference, run_scores
from studies.thresholds.reference import MONITOR, read_monitor
from studies.thresholds.study import Study
from tests.studies.run.analytic_ball import reconstruct_ball
from tests.studies.thresholds.made_up_bank import write_banks
from tests.studies.thresholds.made_up_study import STATED

N_RUNS = 24
RISKS = {"false_recoveries": {"most": 0, "level": 0.3}, "coverage_shortfall": {"most": 0.9, "level": 0.3}}
STATED_RUNS = STATED | {
    "risks": RISKS | {"acquisitions": {"most": 40, "level": 0.3}},
    "settings": {"n_frames": [3], "cluster_min_samples": [5, 400], "recovered_share": [0.3, 0.6]},
    "budget": {"views": 40, "reconstructions": N_RUNS, "finalists": 1, "stress_views": 0, "repetitions": 5},
}


@pytest.fixture(scope="module")
def ball(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished reconstruction."""
    case = tmp_path_factory.mktemp("ball") / "case"
    case.mkdir()
    reconstruct_ball(case)
    return case


@pytest.fixture(scope="module")
def made(ball: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study whose draws are all there, its reconstructions copies of one."""
    folder = tmp_path_factory.mktemp("runs")
    out, config = folder / "out", folder / "config.yaml"
    config.write_text(yaml.safe_dump(STATED_RUNS))
    preset = resolved_preset(ThresholdsPreset.model_validate(STATED_RUNS))
    write_banks(out, preset)
    # The views decide the finalist when the command scores them: every setting's runs are there.
    study = Study.of(out, preset)
    for minimum in (5, 400):
        for share in (0.3, 0.6):
            values = {"n_frames": 3, "cluster_min_samples": minimum, "recovered_share": share}
            setting = study.setting(values, 0)
            for task in study.run_tasks([setting]):
                shutil.copytree(ball, out / RUNS / case_digest(RUN_COMMAND, task.config))
    assert main(["study", "thresholds", str(config), "--out", str(out), "--workers", "1"]) == 0
    return out


def test_what_a_case_counts(ball: Path):
    """What its table's last row lacks, and its rows."""
    rows = StoredRun(ball).rows
    shortfall, acquisitions = run_scores(ball)
    assert shortfall == pytest.approx(1 - rows[-1][MAP_COVERAGE])
    assert acquisitions == len(rows)


def test_all_risks_at_once(made: Path):
    """Views and reconstructions certify together; the finalist is tried with what only reconstructions tell apart."""
    certificate = json.loads((made / "certificate.json").read_text())
    assert certificate["certified"] is True
    draws = {p["risk"]: p["draws"] for p in certificate["promises"]}
    assert draws == {"false_recoveries": 26, "coverage_shortfall": 16, "acquisitions": 16}
    assert {values["cluster_min_samples"] for values in certificate["certified_settings"]} == {5}
    page = (made / "certificate.html").read_text()
    chart = page[page.index("Coverage against acquisitions") :]
    assert all(f"recovered_share {share}: " in chart for share in (0.3, 0.6))
    assert f"over {N_RUNS} drawn scenes" in page
    assert all(f"recovered_share {share}, 2 acquisitions: " in page for share in (0.3, 0.6))


def test_a_scene_counts_when_all_settings_have_it(made: Path):
    """A case that one setting lacks takes its scene out for all of them."""
    study = Study.of(made, resolved_preset(ThresholdsPreset.model_validate(STATED_RUNS)))
    settings = study.settings(study.view_scores())
    whole = study.whole_runs(settings)
    assert {number: len(row) for number, row in whole.items()} == dict.fromkeys(range(N_RUNS), 2)
    lacking = study.run_tasks(settings)[7].case  # the second setting of the fourth scene
    assert lacking == whole[3][1]
    away = lacking.rename(lacking.with_name("away"))
    try:
        assert study.whole_runs(settings) == {number: row for number, row in whole.items() if number != 3}
    finally:
        away.rename(lacking)


def test_a_cells_reference(made: Path, ball: Path):
    """It stands in the certificate as the monitor reads it; of too few runs there is none."""
    reference = read_monitor(made / "certificate.json")
    assert set(reference.signals) <= {"recovery_without_gain", "invalid_share", "burst_spread"}
    assert reference.signals["burst_spread"].n == N_RUNS // 2
    assert MONITOR in json.loads((made / "certificate.json").read_text())
    assert cell_reference([ball] * 5, 0) is None


def test_runs_are_not_made_twice(made: Path, tmp_path: Path):
    """The same command adds no case."""
    before = sorted(path.name for path in (made / RUNS).iterdir())
    config = tmp_path / "config.yaml"
    config.write_text(yaml.safe_dump(STATED_RUNS))
    assert main(["study", "thresholds", str(config), "--out", str(made), "--workers", "1"]) == 0
    assert sorted(path.name for path in (made / RUNS).iterdir()) == before
