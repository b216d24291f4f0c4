"""`dataset make` killed with -9 again and again, at random moments, and resumed: not one byte differs."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import ROOT
from tests.studies.dataset.conftest import SMALL

KILLS = 50
SCENES = 200
"""More than the kills let through: two to three for a kill."""
WORKERS = 2
AT_START = 0.3
"""Share of the kills that wait for no scene (choice)."""
START_S = 6.0
"""Those come within this [s] (choice: about as long as the program takes to begin its first scene)."""
DEADLINE_S = 300.0
"""For a scene to be finished, and for processes to end [s] (choice)."""
CHANGES = (
    ("views: 4", f"views: {SCENES}"),
    ("n_frames: 2", "n_frames: 1"),
    ("keep_frames: true", "keep_frames: false"),
    ("{single: 0.3, pile: 0.7}", "{single: 1}"),
    ("per_scene: 2", "per_scene: 1"),
)
"""From the small dataset to one of many scenes that are made in about a second each."""
PROGRAM = "import sys; from studies.cli.main import main; sys.exit(main())"


@pytest.mark.slow
def test_kills_change_no_byte(tmp_path: Path):
    """50 kills, of the whole process group and of the parent alone in turn; then the command is left to finish.

    Most kills must meet another number of finished scenes than all before, and most must meet scenes in the making:
    kills that all fall into the start of the program would prove nothing.
    """
    config, root, whole = tmp_path / "many.yaml", tmp_path / "killed", tmp_path / "whole"
    config.write_text(_many())
    made = subprocess.run([*_command(config, whole), "--json"], env=_environment(), stdout=subprocess.PIPE, check=True)
    scene_s = json.loads(made.stdout.splitlines()[-1])["wall_s"] * WORKERS / SCENES
    rng, met, in_the_making = np.random.default_rng(0), [], 0
    for kill in range(KILLS):
        _run_and_kill(_command(config, root), root, rng, scene_s, group=kill % 2 == 0)
        met.append(_finished(root))
        in_the_making += any((root / ".work").glob("[0-9]*-*"))
    assert met == sorted(met)
    assert len(set(met)) >= KILLS / 2
    assert in_the_making >= KILLS / 2
    assert subprocess.run(_command(config, root), env=_environment(), check=False).returncode == 0
    assert _contents(root) == _contents(whole)


def _many() -> str:
    text = SMALL
    for before, after in CHANGES:
        assert before in text
        text = text.replace(before, after)
    return text


def _command(config: Path, root: Path) -> list[str]:
    return [sys.executable, "-c", PROGRAM, "dataset", "make", str(config), str(root), "--workers", str(WORKERS)]


def _environment() -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(ROOT)}


def _run_and_kill(command: list[str], root: Path, rng: np.random.Generator, scene_s: float, group: bool) -> None:
    """Kill at a random moment, at the start or while the scene after the first new one is made; wait for all to end."""
    before = _finished(root)
    process = subprocess.Popen(command, env=_environment(), start_new_session=True)
    if rng.random() < AT_START:
        time.sleep(rng.uniform(0, START_S))
    else:
        _wait(lambda: _finished(root) > before or process.poll() is not None)
        time.sleep(rng.uniform(0, scene_s))
    assert process.poll() is None, "ended by itself before it was killed"
    (os.killpg if group else os.kill)(process.pid, signal.SIGKILL)
    process.wait()
    _wait(lambda: not _living(process.pid))


def _finished(root: Path) -> int:
    return len(list((root / "train").glob("*")))


def _living(group: int) -> list[str]:
    """Processes of the group that have not ended."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, of = path.read_text().rpartition(")")[2].split()[:3]
        except OSError:  # it has just ended
            continue
        if int(of) == group and state != "Z":
            found.append(path.parent.name)
    return found


def _wait(until: Callable[[], bool]) -> None:
    deadline = time.monotonic() + DEADLINE_S
    while not until():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def _contents(root: Path) -> dict[str, bytes]:
    return {path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob("*") if path.is_file()}
