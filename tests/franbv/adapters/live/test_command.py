"""`run` and `record` in this process, on an arm that goes at once; what a person sees and what is refused."""

import contextlib
import io
import json
import os
import sys

import pytest
import yaml

from franbv.adapters.__main__ import run
from franbv.adapters.recording.mcap_recording import read_recording
from franbv.adapters.view import opening
from tests.franbv.adapters.live.cells import CELL
from tests.franbv.adapters.live.controllers import CAMERA
from tests.franbv.adapters.recording.recorded_run import PARAMETERS

ARM = "tests.franbv.adapters.live.cells:open_scripted"


@pytest.fixture
def command(tmp_path):
    """Flags of a run, by name; None takes one away."""
    stated = CELL.model_dump(mode="json") | {"arm": {"speed": 0.15}}
    (tmp_path / "cell.yaml").write_text(yaml.safe_dump(stated))
    (tmp_path / "parameters.yaml").write_text(yaml.safe_dump(PARAMETERS.model_dump(mode="json")))

    def made(**changes) -> list[str]:
        flags = {"cell": tmp_path / "cell.yaml", "arm": ARM, "camera": CAMERA, "out": tmp_path / "run", "seed": 2}
        flags |= {"parameters": tmp_path / "parameters.yaml"} | changes
        return [word for name, value in flags.items() if value is not None for word in (f"--{name}", str(value))]

    return made


def test_a_whole_run(command, tmp_path, capsys):
    """Every motion is shown, the run is recorded, and the same command then finds it finished."""
    assert run(["run", *command(), "--go", "--json"]) == 0
    said = capsys.readouterr().out
    shown = [line for line in said.splitlines() if "mm from the object at its nearest" in line]
    result = json.loads(said.splitlines()[-1])
    recording = read_recording(tmp_path / "run" / "recording-1.mcap")
    assert (len(recording.bursts), recording.stop) == (result["acquisitions"], result["stop"])
    assert len(shown) >= len(recording.bursts)
    assert f"franbv replay {tmp_path}/run/recording-1.mcap" in said
    assert recording.run.planner == "fra"
    assert run(["run", *command(), "--go"]) == 0
    assert "this run is finished (max_iterations)" in capsys.readouterr().out
    assert [path.name for path in (tmp_path / "run").iterdir()] == ["recording-1.mcap"]


def test_a_run_is_shown_while_it_lasts(command, tmp_path, capsys, monkeypatch):
    """Every acquisition is drawn at its step; the address goes to stderr. A dry run has nothing to show."""
    pytest.importorskip("rerun")
    from tests.franbv.adapters.view.rrd_reading import counts, drawn

    @contextlib.contextmanager
    def page(title, invalid_share, say):
        say("http://127.0.0.1:1/")
        with opening.rrd_file(tmp_path / "page.rrd", title, invalid_share) as view:
            yield view

    monkeypatch.setattr(opening, "live_page", page)
    assert run(["run", *command(), "--view"]) == 0
    assert not (tmp_path / "page.rrd").exists()
    assert run(["run", *command(), "--view", "--go"]) == 0
    assert "Watch it at http://127.0.0.1:1/\n" in capsys.readouterr().err
    taken = len(read_recording(tmp_path / "run" / "recording-1.mcap").bursts)
    assert counts(drawn(tmp_path / "page.rrd"), "/world/camera:Transform3D:translation") == [1] * taken


def test_a_missing_viewer_is_said_before_anything_moves(command, tmp_path, capsys, monkeypatch):
    """In one line with the mend, exit 2."""
    monkeypatch.setitem(sys.modules, "rerun", None)
    assert run(["run", *command(), "--view", "--go"]) == 2
    assert "views need the package rerun-sdk; pip install 'franbv[view]'\n" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_a_dry_run(command, tmp_path, capsys):
    """By default: where the camera is, how the first view would be reached, and nothing is written."""
    assert run(["run", *command(), "--json"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert "scripted arm at 0.15 m/s: the camera is at (-0.400, -0.000, +0.500) m; nothing is moved" in said[0]
    assert said[1].startswith("first view: camera to (")
    assert json.loads(said[2]) == {"dry_run": True}
    assert not (tmp_path / "run").exists()


def test_answers_to_the_question(command, tmp_path, capsys, monkeypatch):
    """Yes, an answer that is none, no: another pose; then quit."""
    read_end, write_end = _pipe("y\nwhat\nn\ny\nq\n")
    monkeypatch.setattr(sys, "stdin", read_end)
    assert run(["run", *command(), "--move"]) == 2
    said = capsys.readouterr()
    assert said.err == "franbv.adapters: stopped at the question\n"
    assert said.out.count("move? [y]es") == 5
    assert "was not confirmed; the planner chooses another pose" in said.out
    read_end.close()
    write_end.close()


def _pipe(text: str):
    """A standard input that holds this text and no more."""
    number, other = os.pipe()
    writer = io.TextIOWrapper(os.fdopen(other, "wb", 0), write_through=True)
    writer.write(text)
    return io.TextIOWrapper(os.fdopen(number, "rb", 0)), writer


BAD_CELLS = {
    "no such file": (None, "cell.yaml: cannot be read (No such file or directory); name a YAML file"),
    "no YAML": ("{", "cell.yaml: no YAML ("),
    "empty": ("", "cell.yaml: has no settings"),
    "a box upside down": (
        {"object_box": ((0.1, 0, 0), (0.0, 1, 1))},
        "cell.yaml: cell: object_box: lower corner (0.1, 0.0, 0.0) is not below",
    ),
    "a misspelt key": ({"workspce": 1}, "cell.yaml: workspce: Extra inputs are not permitted"),
    "no rotation": (
        {"T_flange_cam": [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]},
        "cell.yaml: cell: T_flange_cam: its upper left 3 x 3 is no rotation",
    ),
    "mirrored": (
        {"T_world_base": [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]},
        "cell.yaml: cell: T_world_base: its upper left 3 x 3 is no rotation",
    ),
    "millimetres": (
        {"object_box": ((-60, -50, 0), (60, 50, 80))},
        "cell.yaml: object_box is not inside what the planner maps",
    ),
    "under the table": (
        {"object_box": ((-0.06, -0.05, -0.2), (0.06, 0.05, -0.1))},
        "cell.yaml: cell: object_box: ends at -0.1 m, under the table",
    ),
    "another table": ({"table_height": 0.01}, "cell.yaml: table_height is 0.01 m, the planner's 0.0 m; give the same"),
    "a number that is none": ({"clearance": float("nan")}, "cell.yaml: clearance: "),
}


@pytest.mark.parametrize("name", BAD_CELLS)
def test_bad_cells_are_one_line(name, command, tmp_path, capsys):
    """The file, the place, the mend; exit 2."""
    stated, words = BAD_CELLS[name]
    path = tmp_path / "cell.yaml"
    if stated is None:
        path.unlink()
    elif isinstance(stated, str):
        path.write_text(stated)
    else:
        path.write_text(yaml.safe_dump(CELL.model_dump(mode="json") | json.loads(json.dumps(stated))))
    assert run(["run", *command()]) == 2
    complaint = capsys.readouterr().err
    assert complaint.startswith("franbv.adapters: ")
    assert words in complaint
    assert complaint.count("\n") == 1


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"arm": "gofa"}, "arm gofa: unknown; choose ros, manual, or package.module:function"),
        ({"arm": "nowhere:f"}, "arm nowhere:f: cannot be loaded"),
        ({"arm": "tests.conftest:absent"}, "arm tests.conftest:absent: cannot be loaded"),
        ({"camera": "kinect"}, "camera kinect: unknown; choose realsense, or package.module:function"),
        ({"camera": "nowhere:f"}, "camera nowhere:f: cannot be loaded"),
        ({"seed": -1}, "--seed: give 0 or more"),
        ({"azimuth": 10.0, "parameters": "none.yaml"}, "none.yaml: cannot be read"),
    ],
)
def test_bad_flags_are_one_line(changes, words, command, capsys):
    """Exit 2, before anything moves."""
    assert run(["run", *command(**changes)]) == 2
    assert words in capsys.readouterr().err


def test_thresholds_that_hold_for_a_camera(command, tmp_path, capsys):
    """Of a camera of somebody's own all is said; a RealSense's own settings may not contradict it, which is one line
    before a camera is looked for."""
    stated = {"parameters": PARAMETERS.model_dump(mode="json"), "sensor": {"preset": "hand", "roll_deg": 0.0}}
    thresholds = tmp_path / "thresholds.yaml"
    thresholds.write_text(yaml.safe_dump(stated))
    assert run(["run", *command(parameters=thresholds)]) == 0
    assert (
        f"{thresholds}: holds for preset hand; nothing here sets that, see to it yourself\n" in capsys.readouterr().err
    )
    (tmp_path / "camera.yaml").write_text("preset: default\n")
    flags = command(parameters=thresholds, camera="realsense")
    assert run(["run", *flags, "--camera-settings", str(tmp_path / "camera.yaml")]) == 2
    complaint = capsys.readouterr().err
    assert (
        f"{thresholds}: holds for preset hand, and not default; leave that out of {tmp_path}/camera.yaml" in complaint
    )
    thresholds.write_text(yaml.safe_dump(stated | {"sensor": 3}))
    assert run(["run", *command(parameters=thresholds)]) == 2
    assert "sensor: has no settings; give names and values" in capsys.readouterr().err


def test_a_first_view_that_the_guard_refuses(command, tmp_path, capsys):
    """Through a wall: the dry run says why, in one line."""
    wall = {"keep_out": {"wall": ((0.1, -0.6, 0.0), (0.5, 0.6, 0.9))}}
    (tmp_path / "cell.yaml").write_text(yaml.safe_dump(CELL.model_dump(mode="json") | wall))
    assert run(["run", *command()]) == 2
    complaint = capsys.readouterr().err
    assert "touches wall" in complaint
    assert run(["run", *command(), "--go"]) == 2
    assert "the arm cannot reach the first view" in capsys.readouterr().err


def test_bursts_by_hand(command, tmp_path, capsys, monkeypatch):
    """Two lines and the end of the input: two bursts; bad flags are one line."""
    flags = command(seed=None, parameters=None, out=tmp_path / "hand.mcap", frames=2)
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n\n"))
    assert run(["record", *flags]) == 0
    assert capsys.readouterr().out.endswith("hand.mcap: 2 bursts of 2 frames\n")
    assert len(read_recording(tmp_path / "hand.mcap").bursts) == 2
    for changes, words in [({"frames": 0}, "--frames 0: a burst has 1 to"), ({"out": "a.bag"}, "recordings are MCAP")]:
        assert run(["record", *command(**{"seed": None, "parameters": None, **changes})]) == 2
        assert words in capsys.readouterr().err
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n"))
    assert run(["record", *flags]) == 2
    assert "is there already, and is never written over" in capsys.readouterr().err
