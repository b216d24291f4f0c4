"""Runs in processes of their own, on an arm in another one."""

import subprocess
import sys
import time
from pathlib import Path

import yaml

from franbv.adapters.arms.opening import open_arm
from tests.conftest import ROOT
from tests.franbv.adapters.live.cells import CELL
from tests.franbv.adapters.recording.recorded_run import PARAMETERS

ARM = "tests.franbv.adapters.live.tcp_arm:open_tcp_arm"
CAMERA = "tests.franbv.adapters.live.analytic_cell:open_analytic"


def write_cell(folder: Path, port: int, speed: float) -> Path:
    """The cell's file, and the parameters beside it."""
    stated = CELL.model_dump(mode="json") | {"arm": {"port": port, "speed": speed}}
    (folder / "cell.yaml").write_text(yaml.safe_dump(stated))
    (folder / "parameters.yaml").write_text(yaml.safe_dump(PARAMETERS.model_dump(mode="json")))
    return folder / "cell.yaml"


def start(folder: Path, port: int, speed: float = 0.2, *flags: str) -> subprocess.Popen:
    """`python -m franbv.adapters run` on that arm."""
    command = [sys.executable, "-m", "franbv.adapters", "run", "--cell", str(write_cell(folder, port, speed))]
    command += ["--arm", ARM, "--camera", CAMERA, "--out", str(folder / "run"), "--seed", "2"]
    command += ["--parameters", str(folder / "parameters.yaml"), *flags]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(command, cwd=ROOT, text=True, **pipes)


def wait_for(log: Path, words: str, count: int, seconds: float = 60.0) -> str:
    """The log, once it has the words so often."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        said = log.read_text() if log.exists() else ""
        if said.count(words) >= count:
            return said
        time.sleep(0.01)
    raise AssertionError(f"{words} did not come {count} times: {said}")


def still(port: int) -> bool:
    """Whether the arm stands."""
    arm = open_arm(ARM, {"port": port})
    try:
        return not arm.ask(op="state")["moving"]
    finally:
        arm.socket.close()
