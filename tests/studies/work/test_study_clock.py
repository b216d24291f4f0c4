"""The wall time of a study that takes several commands."""

import os
import time
from pathlib import Path

import pytest

from studies.work.study_clock import BEGAN, StudyClock


@pytest.fixture
def now(monkeypatch: pytest.MonkeyPatch):
    """Sets the time [s]."""

    def set_time(seconds: float) -> None:
        monkeypatch.setattr(time, "time", lambda: seconds)

    return set_time


def test_commands_add_up(tmp_path: Path, now):
    """Two commands of 10 and 5 s, an hour apart: 15 s."""
    now(1000.0)
    first = StudyClock.started(tmp_path, [tmp_path / "runs"], 0.0)
    now(1010.0)
    stored = first.elapsed_s()
    first.stop()
    now(4600.0)
    second = StudyClock.started(tmp_path, [tmp_path / "runs"], stored)
    now(4605.0)
    assert second.elapsed_s() == pytest.approx(15.0)
    second.stop()
    assert not (tmp_path / BEGAN).exists()


def test_killed_commands_count_until_their_last_sign_of_life(tmp_path: Path, now):
    """Killed 30 s after its beginning, again after 20 s, again before any run began; the last one takes 4 s: 54 s, and
    7 s that had been stored before."""
    runs = tmp_path / "runs"
    now(1000.0)
    StudyClock.started(tmp_path, [runs], 7.0)
    runs.mkdir()
    os.utime(runs, (1030.0, 1030.0))
    now(2000.0)
    StudyClock.started(tmp_path, [runs], 7.0)
    os.utime(runs, (2020.0, 2020.0))
    now(3000.0)
    StudyClock.started(tmp_path, [runs], 7.0)
    now(4000.0)
    last = StudyClock.started(tmp_path, [runs], 7.0)
    now(4004.0)
    assert last.elapsed_s() == pytest.approx(61.0)


def test_work_deep_in_a_folder_is_a_sign_of_life(tmp_path: Path, now):
    """Views of a bank lie two folders down: killed 50 s after its beginning, 20 s after a folder above last changed."""
    bank, runs = tmp_path / "bank", tmp_path / "runs"
    now(1000.0)
    StudyClock.started(tmp_path, [bank, runs], 0.0)
    views = bank / "0a1b" / "views"
    views.mkdir(parents=True)
    for folder, changed in ((views, 1050.0), (views.parent, 1030.0), (bank, 1010.0)):
        os.utime(folder, (changed, changed))
    now(9000.0)
    assert StudyClock.started(tmp_path, [bank, runs], 0.0).elapsed_s() == pytest.approx(50.0)
