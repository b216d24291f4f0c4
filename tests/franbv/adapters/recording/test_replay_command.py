"""`python -m franbv.adapters replay`: what a robot's computer has of it, and what it says of bad input."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from franbv.adapters.__main__ import run
from tests.conftest import ROOT
from tests.franbv.adapters.recording.test_contradictions import changed, messages_in, write

ALONE = """
import sys
from importlib.abc import MetaPathFinder

class Absent(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in set(sys.argv[1].split(",")):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
from franbv.adapters.__main__ import run
sys.exit(run(sys.argv[2:]))
"""
NOT_ON_A_ROBOT = "render,scenes,materials,studies,mitsuba,drjit,trimesh,cv2,tyro,rich"


def adapters(*args: object, absent: str = NOT_ON_A_ROBOT) -> subprocess.CompletedProcess[str]:
    """The command in an interpreter that lacks some packages."""
    command = [sys.executable, "-c", ALONE, absent, *map(str, args)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_replay_needs_the_planner_alone(recorded, tmp_path: Path):
    """Without renderer, studies and what they need, the decisions are replayed, compared and written down."""
    done = adapters("replay", recorded.path, "--json", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    figures = json.loads(done.stdout.splitlines()[-1])
    n = len(recorded.run.acquisitions)
    assert (figures["acquisitions"], figures["decisions"], figures["decisions_equal"]) == (n, n, True)
    assert figures["first_difference"] is None
    written = json.loads((tmp_path / "out" / "replay.json").read_text())
    assert [decision["index"] for decision in written["replayed"]] == list(range(n))


@pytest.mark.parametrize(
    ("absent", "name", "words"),
    [
        ("mcap", "run.mcap", "need the package mcap; pip install 'franbv[record]'"),
        ("rosbags", "a.db3", "need the package rosbags; pip install 'franbv[record]'"),
        ("none", "none.mcap", "no such file"),
    ],
)
def test_bad_input_is_one_line(recorded, tmp_path: Path, absent: str, name: str, words: str):
    """A missing extra names itself; nothing else is said."""
    path = recorded.path if name == recorded.path.name else tmp_path / name
    if name.endswith("db3"):
        path.touch()
    done = adapters("replay", path, absent=absent)
    assert (done.returncode, done.stdout) == (2, "")
    assert words in done.stderr
    assert done.stderr.count("\n") == 1


def test_flags_go_over_the_recording(recorded, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Another planner and fewer frames; a recording that was cut off says so on stderr."""
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(recorded.path.read_bytes()[:-100])
    args = ["replay", str(cut), "--planner", "random", "--n-frames", "1", "--json", "--out", str(tmp_path / "out")]
    assert run(args) == 0
    out, err = capsys.readouterr()
    figures = json.loads(out.splitlines()[-1])
    assert figures["decisions_equal"] is False
    assert "it decides otherwise from acquisition" in out
    assert "was cut off" in err
    assert (tmp_path / "out" / "replay.json").is_file()
    assert run(["replay", str(recorded.path)]) == 0
    assert "every decision is as recorded" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("facts", "words"),
    [
        ({"ablation": {"without_filter": "erosion"}}, "was planned by a changed method"),
        ({"planner": "oracle"}, "was planned by oracle; choose one of fra"),
        ({"parameters": {"n_frames": 0}}, "parameter n_frames"),
        ({"parameters": {"flux": 1}}, "parameter flux"),
    ],
)
def test_a_run_that_is_not_known_is_refused(
    recorded, tmp_path: Path, capsys: pytest.CaptureFixture[str], facts: dict, words: str
):
    """A method, a planner or parameters of another version."""
    path = write(tmp_path / "a.mcap", changed("/recording/header", **facts)(messages_in(recorded.path)))
    assert run(["replay", str(path)]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        (["--n-frames", "0"], "--n-frames 0: a burst has frames; ask for 1 at least"),
        (["--n-frames", "-3"], "--n-frames -3: "),
        (["--min-z", "0"], "--min-z 0: is no distance; give metres above 0"),
        (["--min-z", "-0.1"], "--min-z -0.1: "),
        (["--min-z", "nan"], "--min-z nan: "),
        (["--min-z", "inf"], "--min-z inf: "),
    ],
)
def test_numbers_that_mean_nothing_are_refused(
    recorded, capsys: pytest.CaptureFixture[str], flags: list[str], words: str
):
    """One line with the flag and what to give."""
    assert run(["replay", str(recorded.path), *flags]) == 2
    said = capsys.readouterr()
    assert words in said.err
    assert (said.out, said.err.count("\n")) == ("", 1)


def test_a_folder_that_cannot_be_written_is_refused(recorded, capsys: pytest.CaptureFixture[str]):
    """Here it is a file."""
    assert run(["replay", str(recorded.path), "--out", str(recorded.path)]) == 2
    assert "cannot be written" in capsys.readouterr().err
