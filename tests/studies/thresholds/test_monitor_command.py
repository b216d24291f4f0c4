"""`franbv monitor` from runs on disk to its exit status, on runs of the ball whose noise was drawn anew."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from shutil import copy2

import pytest

from studies.cli.main import main
from studies.run.replayed import REPLAY_COMMAND
from studies.run.stored_run import StoredRun
from studies.store.views import read_arrays
from studies.thresholds.reference import MONITOR, monitor_object, monitor_reference
from studies.thresholds.signals import depth_spread, observed_of_stored
from tests.conftest import ROOT
from tests.studies.thresholds.ball_runs import BallRun, noisy_copy, with_noise

USUAL, DOCTORED = 1e-3, 1.5e-3
"""Noise over Z^2 inside the domain, and outside of it [1/m]."""
N = 30
"""Runs of each."""


@pytest.fixture(scope="module")
def certificate(run: BallRun, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file whose domain is the ball with the usual noise, seen 400 times."""
    depths, one = read_arrays(run.case / "captures" / "000.npz")["depths"], observed_of_stored(StoredRun(run.case))
    seen = [replace(one, burst_spread=depth_spread(with_noise(depths, USUAL, 10_000 + k))) for k in range(400)]
    path = tmp_path_factory.mktemp("certificate") / "certificate.json"
    path.write_text(json.dumps({"levels": {}, MONITOR: monitor_object(monitor_reference(seen, seed=0))}))
    return path


@pytest.fixture(scope="module")
def cells(run: BallRun, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Folders of runs inside and outside the domain, whose names are not in the order of time."""
    folders = tmp_path_factory.mktemp("inside"), tmp_path_factory.mktemp("outside")
    for folder, spread, first in zip(folders, (USUAL, DOCTORED), (0, 1000), strict=True):
        for k in range(N):
            noisy_copy(run.case, folder / f"{(7 * k) % N:02d}", spread, seed=first + k, finished_s=1e9 + first + k)
    return folders


def said(capsys: pytest.CaptureFixture[str]) -> tuple[str, dict]:
    """The words, and the object in the last line."""
    *words, last = capsys.readouterr().out.splitlines()
    return "\n".join(words), json.loads(last)


def test_runs_inside(certificate: Path, cells: tuple[Path, Path], capsys: pytest.CaptureFixture[str]):
    """Still inside, and how many more runs would be needed to notice a change."""
    assert main(["monitor", str(cells[0]), "--certificate", str(certificate), "--json", "--fail-on-alarm"]) == 0
    words, found = said(capsys)
    assert (found["alarm"], found["runs"]) == (False, N)
    assert f"Still inside after {N} runs" in words
    by_name = {signal["name"]: signal for signal in found["signals"]}
    assert set(by_name) == {"recovery_without_gain", "invalid_share", "burst_spread"}
    spread = by_name["burst_spread"]
    assert spread["n"] == N
    assert spread["alarm_at"] is None
    assert f"noticed after {spread['more_runs_to_notice']} further runs" in words


def test_runs_outside(certificate: Path, cells: tuple[Path, Path], capsys: pytest.CaptureFixture[str]):
    """An alarm of the signal whose number was changed and of no other, at a run that is named; nobody is failed by it
    who does not want to be."""
    args = ["monitor", str(cells[1]), "--certificate", str(certificate), "--json"]
    assert main(args) == 0
    words, found = said(capsys)
    assert found["alarm"] is True
    raised = {signal["name"]: signal["alarm_at"] for signal in found["signals"] if signal["alarm_at"] is not None}
    assert set(raised) == {"burst_spread"}
    at = raised["burst_spread"]
    assert 1 < at <= N
    folder = cells[1] / f"{(7 * (at - 1)) % N:02d}"
    assert f"Alarm at run {at} ({folder}), because first bursts whose depth flickers" in words
    assert f"ALARM at run {at} of {N}: the declared domain is left" in words
    assert main([*args, "--fail-on-alarm"]) == 1


def test_runs_that_leave_the_domain(certificate: Path, cells: tuple[Path, Path], capsys: pytest.CaptureFixture[str]):
    """Ten runs inside in any order, then those outside: the alarm comes among the latter, and the recording of a run is
    one of the row."""
    inside = [str(path) for path in sorted(cells[0].iterdir())[:10]]
    args = ["monitor", *inside, str(cells[1]), "--certificate", str(certificate), "--json"]
    assert main(args) == 0
    _, found = said(capsys)
    assert found["runs"] == 10 + N
    (at,) = [signal["alarm_at"] for signal in found["signals"] if signal["alarm_at"] is not None]
    assert at > 10


def test_a_recording_is_a_run(run: BallRun, certificate: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Whole and once, beside its own folder; one that was cut off counts where it says something."""
    args = ["monitor", str(run.recording), str(run.case), "--certificate", str(certificate), "--json"]
    assert main(args) == 0
    captured = capsys.readouterr()
    found = json.loads(captured.out.splitlines()[-1])
    assert found["runs"] == 1
    assert [signal["n"] for signal in found["signals"]] == [1, 1, 1]
    assert captured.err == f"franbv monitor: {run.case}: is the same run as {run.recording}, and counts once\n"
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(run.recording.read_bytes()[: run.recording.stat().st_size * 2 // 3])
    assert main(["monitor", str(cut), "--certificate", str(certificate), "--json"]) == 0
    words, found = said(capsys)
    assert {s["name"]: s["n"] for s in found["signals"]}["recovery_without_gain"] == 0
    assert "recovery_without_gain: seen in no run yet" in words


def test_a_replay_is_no_run(run: BallRun, certificate: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """It would count twice, and kept no depth by which that could be told."""
    replayed = noisy_copy(run.case, tmp_path / "report" / "case", USUAL, seed=1, finished_s=0)
    told = json.loads((replayed / "run.json").read_text())
    (replayed / "run.json").write_text(json.dumps(told | {"command": REPLAY_COMMAND}))
    copy2(run.recording, tmp_path / "recording-1.mcap")
    assert main(["monitor", str(tmp_path), "--certificate", str(certificate), "--json"]) == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out.splitlines()[-1])["runs"] == 1
    assert (
        captured.err == f"franbv monitor: {replayed}: is a replay and no run; its recording counts, where it is given\n"
    )


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        (["--false-alarms", "0"], "--false-alarms 0: is a probability"),
        (["--false-alarms", "nan"], "--false-alarms nan: is a probability"),
        (["--tolerance", "-0.1"], "--tolerance -0.1: is a rise of a share"),
        (["--tolerance", "1"], "--tolerance 1: is a rise of a share"),
    ],
)
def test_flags_that_mean_nothing(
    run: BallRun, certificate: Path, flags: list[str], words: str, capsys: pytest.CaptureFixture[str]
):
    """One line, exit status 2."""
    assert main(["monitor", str(run.case), "--certificate", str(certificate), *flags]) == 2
    err = capsys.readouterr().err
    assert words in err
    assert err.count("\n") == 1


def test_without_runs_or_certificate(run: BallRun, certificate: Path, capsys: pytest.CaptureFixture[str]):
    """One line, exit status 2."""
    for args in (["--certificate", str(certificate)], [str(run.case)], [str(run.case), "--certificate", str(run.case)]):
        assert main(["monitor", *args]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_it_needs_no_renderer(run: BallRun, certificate: Path):
    """A fresh interpreter that has watched a folder and a recording has loaded nothing of the simulator."""
    args = ["monitor", str(run.case), str(run.recording), "--certificate", str(certificate)]
    program = (
        f"import sys\nfrom studies.cli.main import main\nstatus = main({args!r})\n"
        "print(sorted({name.split('.')[0] for name in sys.modules} & {'mitsuba', 'drjit', 'render', 'scenes'}), status)"
    )
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-W", "error", "-c", program]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "[] 0"
