"""`docs/architecture.md`: its drawing is that of the layer rules, what it names exists, and its examples work as shown.

The examples are made in a copy of the packages: edits and new files first, all of them, then linters, layer rules and
every block that runs. What a line is to print stands behind it as a comment, or below it on a console.
"""

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from franbv.adapters.arms.driver import ArmError
from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.adapters.camera_error import CameraError
from franbv.adapters.live.cell import CellError
from franbv.adapters.live.guarded_arm import RefusedError
from franbv.adapters.live.resumed import CannotResumeError
from franbv.adapters.live.switch import StoppedError
from franbv.adapters.recording.contents import RecordingError
from franbv.adapters.recording.tape import OffTapeError
from franbv.adapters.view.sight import ViewError
from franbv.known_planners import PLANNERS
from materials.input_error import InputError
from render.matcher.by_name import MATCHERS
from render.world.backend import BackendError
from studies.base.output_errors import FutileError
from studies.cli.main import Stopped
from studies.store.images import write_png
from tests.conftest import PACKAGES, ROOT

TEXT = (ROOT / "docs" / "architecture.md").read_text()
LINTERS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
RUN = """
import contextlib, io, json, shlex, sys
from studies.cli.main import main

def printed(kind, source):
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        if kind == "python":
            exec(compile(source, "<page>", "exec"), {"__name__": "page"})
        elif main(shlex.split(source)[1:]):
            raise SystemExit(f"{source}: failed")
    return said.getvalue().splitlines()

if __name__ == "__main__":  # worker processes import this file
    print(json.dumps([printed(*step) for step in json.load(sys.stdin)]))
"""


class Block(NamedTuple):
    """A fenced block of the page."""

    kind: str
    body: str

    @property
    def file(self) -> str | None:
        """The new file that it is; None if it is something else."""
        named = re.match(r"# ([\w/]+\.(?:py|yaml))\n", self.body)
        return named[1] if named and self.kind in ("python", "yaml") else None


BLOCKS = [Block(*found) for found in re.findall(r"^```(\w+)\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)]
DRAWING = BLOCKS[0].body


def drawn_layers() -> dict[str, list[list[str]]]:
    """Rows of each box of the left column, as lists of the rooms beside each other."""
    boxes: dict[str, list[list[str]]] = {}
    box = ""
    for line in DRAWING.splitlines():
        if head := re.match(r"┌─ (\w+) ─", line):
            box = head[1]
        elif row := re.match(r"│ ([^│├]+?) *[│├]", line):
            boxes.setdefault(box, []).append(row[1].split(" | "))
    return boxes


def ruled_layers(container: str) -> list[list[str]]:
    """The same as import-linter has them."""
    (contract,) = (c for c in LINTERS if c["type"] == "layers" and c.get("containers") == [container])
    return [layer.split(" | ") for layer in contract["layers"]]


def test_its_drawing_is_that_of_the_layer_rules():
    """Boxes from top to bottom, rows in boxes, the dataset's line, what render sees of the planner: all as linted."""
    drawn = drawn_layers()
    (packages,) = (c["layers"] for c in LINTERS if c["type"] == "layers" and "containers" not in c)
    assert list(drawn) == packages
    assert set(drawn) | {"franbv"} == set(PACKAGES)
    assert drawn["studies"] == ruled_layers("studies")
    assert drawn["render"] == ruled_layers("render")
    line = re.search(r"studies/dataset: (.*)", DRAWING)
    assert line
    assert [[room] for room in line[1].split(" > ")] == ruled_layers("studies.dataset")
    seen = re.search(r"│ d435i +│ (.*?) +│", DRAWING)
    assert seen
    (contract,) = (c for c in LINTERS if c["name"] == "render sees only frames and sensing of the planner")
    assert {f"render.** -> franbv.{name}" for name in seen[1].split(", ")} == set(contract["ignore_imports"])
    (alone,) = (c for c in LINTERS if c["name"] == "franbv stands alone")
    assert set(alone["forbidden_modules"]) >= set(drawn)


def test_what_it_names_exists():
    """Files and folders in backticks and every module of a package, unless a block of the page makes it."""
    made = {block.file for block in BLOCKS if block.file}
    files = set(re.findall(r"`((?:franbv|render|scenes|materials|studies|tests|examples|docs)/[\w/.]+\.\w+)`", TEXT))
    assert len(files) > 10
    assert [name for name in files - made if not (ROOT / name).exists()] == []
    folders = set(re.findall(r"`((?:franbv|render|scenes|materials|studies)/[\w/]+)`", TEXT))
    assert [name for name in folders if not (ROOT / name).is_dir()] == []
    whole = re.sub(r"\b((?:\w+\.)+)(\w+), \.(\w+)", r"\1\2, \1\3", TEXT)  # `a.b, .c` is short for `a.b, a.c`
    modules = set(re.findall(r"\b(?:franbv|render|scenes|materials|studies)(?:\.[a-z]\w*)+", whole))
    made_modules = {name.removesuffix(".py").removesuffix("/__init__").replace("/", ".") for name in made}
    assert len(modules) > 30
    assert [name for name in modules - made_modules if not resolves(name)] == []


def resolves(name: str) -> bool:
    """Whether this is a module, or something in one."""
    parent, _, last = name.rpartition(".")
    try:
        if importlib.util.find_spec(name):
            return True
    except ModuleNotFoundError:
        return False
    return hasattr(importlib.import_module(parent), last)


def test_exceptions_are_what_it_says():
    """Each class of the table is a subclass of the one beside it, and the packages define no others."""
    rows = dict(re.findall(r"^\| `(\w+)` .*?\| (?:`(\w+)`)? *\|", TEXT, re.MULTILINE))
    studies = (InputError, BackendError, FutileError, Stopped)
    robot = (ArmError, CalibrationError, CameraError, CannotResumeError, CellError, RefusedError, StoppedError)
    told = (*studies, *robot, RecordingError, OffTapeError, ViewError)
    ours = {cls.__name__: cls for cls in told}
    assert {name: rows[name] for name in ours} == {name: cls.__bases__[0].__name__ for name, cls in ours.items()}
    sources = [path.read_text() for package in PACKAGES for path in (ROOT / package).rglob("*.py")]
    exception = re.compile(r"^class (\w+)\((?:\w*Error|\w*Exception|\w*Interrupt)\)", re.MULTILINE)
    defined = {name for text in sources for name in exception.findall(text) if not name.startswith("_")}
    assert defined == {*ours, "NotConnectedError", "NothingRecordedError", "StreamLostError"}
    raised = {name for text in sources for name in re.findall(r"raise (ValueError|RuntimeError)\b", text)}
    assert raised <= set(rows)


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages with everything that the page adds, and a dataset of one view to export."""
    root = tmp_path_factory.mktemp("added")
    for name in (*PACKAGES, "examples"):
        shutil.copytree(ROOT / name, root / name)  # with times, so that compiled functions are found again
    for name in ("pyproject.toml", "README.md"):
        shutil.copy2(ROOT / name, root)
    for block in BLOCKS:
        if block.kind == "diff":
            edit(root, block.body)
        elif block.file:
            path = root / block.file
            path.parent.mkdir(parents=True, exist_ok=True)
            assert not path.exists(), path
            path.write_text(block.body.partition("\n")[2])
    (root / "run_page.py").write_text(RUN)
    write_small_dataset(root / "runs" / "dataset")
    return root


def edit(root: Path, diff: str) -> None:
    """Make the edits; what a hunk shows of the old file must stand there once."""
    for name, hunks in re.findall(r"^--- a/(\S+)\n(.*?)(?=^--- a/|\Z)", diff, re.MULTILINE | re.DOTALL):
        text = (root / name).read_text()
        for hunk in re.split(r"^@@.*@@\n", hunks, flags=re.MULTILINE)[1:]:
            lines = hunk.splitlines(keepends=True)
            old = "".join(line[1:] for line in lines if line[0] in " -")
            new = "".join(line[1:] for line in lines if line[0] in " +")
            assert text.count(old) == 1, f"{name}: {text.count(old)} times in it:\n{old}"
            text = text.replace(old, new)
        (root / name).write_text(text)


def write_small_dataset(folder: Path) -> None:
    """What an exporter reads of a dataset: one view, half a metre of depth, a camera at (0.1, 0.2, 0.3)."""
    scene = folder / "train" / "000000"
    for name, image in (("gray", np.full((4, 6), 9, np.uint8)), ("depth", np.full((4, 6), 500, np.uint16))):
        (scene / name).mkdir(parents=True)
        write_png(scene / name / "000000.png", image)
    pose = np.eye(4)
    pose[:3, 3] = 0.1, 0.2, 0.3
    files = {
        folder / "dataset.json": {"causes": {}, "materials": []},
        scene / "scene_camera.json": {"0": {}},
        scene / "scene_gt.json": {"0": []},
        scene / "scene.json": {"draw": {"views": [{"T_world_cam": pose.tolist()}]}},
    }
    for path, content in files.items():
        path.write_text(json.dumps(content))


def in_tree(tree: Path, *command: str, given: str = "") -> str:
    """What a command prints there; it must succeed."""
    environment = os.environ | {"PYTHONPATH": str(tree)}
    done = subprocess.run(command, cwd=tree, env=environment, input=given, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_its_examples_are_in_style_and_in_their_layers(tree: Path):
    """What the page shows passes the linters that every change passes."""
    tools = Path(sys.executable).parent
    in_tree(tree, str(tools / "ruff"), "check", "--no-cache", "--extend-exclude", "run_page.py", ".")
    in_tree(tree, str(tools / "ruff"), "format", "--check", "--no-cache", "--exclude", "run_page.py", ".")
    in_tree(tree, str(tools / "lint-imports"), "--no-cache")


def test_its_examples_print_what_it_shows(tree: Path):
    """All blocks that run, in the page's order; poses are exported as they were, and flags offer what was added."""
    steps, expected = [], []
    for block in BLOCKS:
        if block.kind == "python" and not block.file:
            steps.append(("python", block.body))
            expected.append(re.findall(r"^ *print\(.*\)  # (.*)$", block.body, re.MULTILINE))
        elif block.kind == "console":
            command, *output = block.body.splitlines()
            steps.append(("console", command.removeprefix("$ ")))
            expected.append(output)
    steps.append(("console", "franbv reconstruct --help"))
    answer = in_tree(tree, sys.executable, "run_page.py", given=json.dumps(steps)).splitlines()[-1]
    *printed, choices = json.loads(answer)
    for said, wanted in zip(printed, expected, strict=True):
        assert wanted
        assert said[-len(wanted) :] == wanted
    assert f"--planner {{{','.join([*PLANNERS, 'nearest'])}}}" in "\n".join(choices)
    assert f"--sensor.matcher {{{','.join([*MATCHERS, 'block'])}}}" in "\n".join(choices)
    line = (tree / "runs" / "tum" / "groundtruth.txt").read_text().splitlines()[1]
    assert line.split() == ["000000", "0.100000", "0.200000", "0.300000", *["0.000000"] * 3, "1.000000"]
