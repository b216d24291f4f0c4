"""`franbv study mitigations`: bad input in one line; a case that is interrupted goes on; a small study, killed."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from studies.advise import score_store
from studies.advise.scoring import SurfaceCount
from studies.base.case_folder import PROGRESS
from studies.cli.main import main
from studies.mitigations.cases import mitigation_cases
from studies.mitigations.measurement import MitigationTask, do_mitigation_case
from studies.mitigations.preset import MitigationsPreset
from studies.sensitivity.measurement import CASES, RESULT
from tests.conftest import ROOT
from tests.studies.mitigations.made_up_study import cases

PROGRAM = "import sys; from studies.cli.main import main; sys.exit(main())"
TINY = """
title: one metal in two finishes
metals: [aluminium]
finishes: [ground, blasted]
coupons: [plate]
poses: 2
sensor: {profile: 424x240, decimation: 1, crop: null}
remedies: {laser: [60 mW], lamps: ["off"], roll: [90 deg], spray: [matte]}
"""
DEADLINE_S = 1800.0
"""For a count to be written, and for processes to end [s] (choice)."""


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        (["--preset", "medium"], "preset medium: there is none"),
        (["--preset", "none.yaml"], "none.yaml: no such file"),
        (["--workers", "0"], "--workers 0: there must be someone"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(
    flags: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """Exit status 2."""
    assert main(["study", "mitigations", *flags, "--out", str(tmp_path / "out")]) == 2
    message = capsys.readouterr().err.strip()
    assert words in message
    assert "\n" not in message
    assert not (tmp_path / "out").exists()


def test_a_preset_that_cannot_be_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """File, key, nearest name."""
    file = tmp_path / "mine.yaml"
    file.write_text("title: mine\nmetals: [iron]\nfinishes: [polished]\nremedies: {laser: [61 mW]}\n")
    assert main(["study", "mitigations", "--preset", str(file), "--out", str(tmp_path / "out")]) == 2
    message = capsys.readouterr().err.strip()
    assert "mine.yaml" in message
    assert "laser has no level 61 mW; did you mean 60 mW" in message


def test_a_dry_run_tells_and_does_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Cases, and about how long they take."""
    assert main(["study", "mitigations", "--preset", "metals", "--out", str(tmp_path / "out"), "--dry-run"]) == 0
    assert capsys.readouterr().out.startswith("49 cases, 0 of them finished")
    assert not (tmp_path / "out").exists()


class StandIn:
    """In place of what is measured: counts calls, and dies at one of them."""

    def __init__(self, dies_at: int | None) -> None:
        self.calls = 0
        self.dies_at = dies_at

    def __call__(self, lights: object, setup: object, index: int, seed: int) -> "StandIn":
        """As `measured_part`."""
        self.calls += 1
        if self.calls == self.dies_at:
            raise KeyboardInterrupt
        return self

    @property
    def count(self) -> SurfaceCount:
        """Of any part."""
        return SurfaceCount(1.0, 0.5, 0.1, 1.0)


def test_an_interrupted_case_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Three remedies and the camera as set, six poses: 24 counts. The first process dies in the tenth, the second makes
    the fifteen that are missing; no progress and no radiance stay behind."""
    case = cases(remedies={"laser": ("60 mW",), "roll": ("90 deg",), "spray": ("matte",)})[0]
    first, second = StandIn(10), StandIn(None)
    monkeypatch.setattr(score_store, "measured_part", first)
    with pytest.raises(KeyboardInterrupt):
        do_mitigation_case(MitigationTask(tmp_path, case))
    assert not (tmp_path / CASES / case.digest).exists()
    monkeypatch.setattr(score_store, "measured_part", second)
    do_mitigation_case(MitigationTask(tmp_path, case))
    assert (first.calls, second.calls) == (10, 15)
    folder = tmp_path / CASES / case.digest
    assert {path.name for path in folder.iterdir()} == {"case.json", RESULT}
    counts = json.loads((folder / RESULT).read_text())["counts"]
    assert [row["remedy"] for row in counts] == [[], ["laser", "60 mW"], ["spray", "matte"], ["roll", "90 deg"]]
    assert all(len(row["views"]) == 6 for row in counts)


@pytest.mark.slow
def test_a_small_study_that_is_killed_goes_on_and_says_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Killed with -9 as soon as a count is written; given again it finishes with the bytes of one that was left alone.
    Lamps off and spray are what they are on ground aluminium: each case has shares that add up to one."""
    preset, killed, whole = tmp_path / "tiny.yaml", tmp_path / "killed", tmp_path / "whole"
    preset.write_text(TINY)
    command = ["study", "mitigations", "--preset", str(preset), "--workers", "2", "--json", "--out"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *command, str(killed)], env=environment, start_new_session=True
    )
    until = time.monotonic() + DEADLINE_S
    while not list(killed.glob(f"{CASES}/.partial-*/{PROGRESS}/scores/*.json")) and time.monotonic() < until:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert main([*command, str(killed)]) == 0
    found = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert (found["cases"], found["failed"]) == (2, 0)
    assert main([*command, str(whole)]) == 0
    for case in mitigation_cases(MitigationsPreset.named(str(preset))):
        results = [(out / CASES / case.digest / RESULT).read_bytes() for out in (killed, whole)]
        assert results[0] == results[1]
    assert list(killed.rglob("*.npz")) == []
    page = (killed / "report.html").read_bytes()
    assert main(["report", str(killed)]) == 0
    assert (killed / "report.html").read_bytes() == page
