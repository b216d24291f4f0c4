"""An arm that goes on by itself is not left moving by a run that was killed, hung, or ended by a signal."""

import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from franbv.adapters.arms.driver import ArmError
from franbv.adapters.live.keeper import Keeper
from franbv.adapters.live.run import last_recording
from franbv.adapters.recording.mcap_recording import read_recording
from tests.conftest import ROOT
from tests.franbv.adapters.live.cells import HOME
from tests.franbv.adapters.live.controllers import ARM, CAMERA, start, still, wait_for, write_cell


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGSTOP])
def test_an_arm_is_not_left_moving(number, controller, tmp_path):
    """In the middle of the first motion, which would take seconds: it stands within one."""
    port, log = controller
    process = start(tmp_path, port, 0.05, "--go")
    wait_for(log, "go", 1)
    time.sleep(0.3)
    os.kill(process.pid, number)
    said = wait_for(log, "stopped", 1, seconds=5.0)
    assert still(port)
    takes, share = (float(re.findall(rf"{word} ([0-9.]+)", said)[0]) for word in ("go", "stopped at"))
    assert takes * (1.0 - share) > 1.0  # it would have gone on
    if number == signal.SIGSTOP:
        os.kill(process.pid, signal.SIGKILL)
    _, complaint = process.communicate(timeout=20)
    if number in (signal.SIGTERM, signal.SIGINT):
        assert process.returncode == 2
        assert complaint == f"franbv.adapters: stopped by {number.name}\n"


def test_a_killed_run_goes_on(controller, tmp_path):
    """Killed after two bursts: the next command takes it up and ends it; the one after that finds it ended."""
    port, log = controller
    process = start(tmp_path, port, 0.25, "--go")
    wait_for(log, "go", 3)
    process.kill()
    process.communicate(timeout=20)
    before = last_recording(tmp_path / "run")
    assert before is not None
    assert before.stop is None
    again = start(tmp_path, port, 0.25, "--go", "--json")
    said, complaint = again.communicate(timeout=120)
    assert again.returncode == 0, complaint
    assert '"stop": "max_iterations"' in said
    after = last_recording(tmp_path / "run")
    assert after is not None
    assert len(after.bursts) > len(before.bursts)
    for old, new in zip(before.bursts, after.bursts, strict=False):
        assert (old.read().depths == new.read().depths).all()
    found = start(tmp_path, port, 0.25, "--go")
    assert "this run is finished" in found.communicate(timeout=60)[0]


def test_nothing_moves_by_default(controller, tmp_path):
    """A dry run says where the camera is and how it would go; the arm is never told to."""
    port, log = controller
    process = start(tmp_path, port)
    said, complaint = process.communicate(timeout=60)
    assert (process.returncode, complaint) == (0, "")
    assert "nothing is moved without --move or --go" in said
    assert re.search(r"first view: camera to .* mm from the object at its nearest", said)
    assert "go" not in log.read_text()
    assert not (tmp_path / "run").exists()


def test_each_motion_is_asked_for(controller, tmp_path):
    """With --move and nobody there to answer: nothing moves, one line."""
    port, log = controller
    process = start(tmp_path, port, 0.2, "--move")
    said, complaint = process.communicate(timeout=60)
    assert process.returncode == 2
    assert "move? [y]es, [n]o: another pose, [q]uit:" in said
    assert complaint == "franbv.adapters: stopped at the question\n"
    assert "go" not in log.read_text()


def test_a_keeper_without_an_arm(tmp_path):
    """No second connection, no motion."""
    with pytest.raises(ArmError, match=r"second connection to the arm.* failed: TCP arm at port 9: .*; start it"):
        Keeper(ARM, {"port": 9})


def test_bursts_by_hand(controller, tmp_path):
    """Three lines, three bursts with the arm's pose; nothing moves, and a replay takes the file."""
    port, log = controller
    command = [sys.executable, "-m", "franbv.adapters", "record", "--cell", str(write_cell(tmp_path, port, 0.2))]
    command += ["--arm", ARM, "--camera", CAMERA, "--out", str(tmp_path / "hand.mcap"), "--frames", "3"]
    done = subprocess.run(command, cwd=ROOT, input="\n\n\nq\n", capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith("hand.mcap: 3 bursts of 3 frames\n")
    recording = read_recording(tmp_path / "hand.mcap")
    assert [burst.n_frames for burst in recording.bursts] == [3, 3, 3]
    assert np.allclose(recording.bursts[2].T_world_cam.as_matrix(), HOME.as_matrix())
    assert "go" not in log.read_text()
