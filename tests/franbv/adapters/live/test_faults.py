"""Faults by script, at random places of a run: one line, an arm that stands, what was taken is kept, and it goes on."""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import franbv.adapters.recording.writer as writer_module
from franbv.adapters.arms.driver import ArmError
from franbv.adapters.camera_error import CameraError
from franbv.adapters.live.command import ONE_LINE
from franbv.adapters.live.run import LiveRun, last_recording
from franbv.adapters.recording.decisions import decision_of, first_difference
from tests.franbv.adapters.live.cells import ScriptedArm
from tests.franbv.adapters.live.controllers import start, still, wait_for
from tests.franbv.adapters.live.test_run import a_run

TIMES = 50
Fault = Callable[[LiveRun, ScriptedArm, np.random.Generator, pytest.MonkeyPatch], None]


def camera_fails(words: str) -> Fault:
    """At a burst, with the adapter's own line for it (tests/franbv/adapters/realsense/test_faults.py makes each)."""

    def fault(run, driver, rng, monkeypatch):
        at, capture = rng.integers(1, 5), run.camera.capture

        def failing(T_world_cam, n_frames):
            if run.camera.captures == at:
                raise CameraError(f"camera: {words}; check cable and port")
            return capture(T_world_cam, n_frames)

        monkeypatch.setattr(run.camera, "capture", failing)

    return fault


def arm_fails(what: Callable[[ScriptedArm], None]) -> Fault:
    """At a step of a motion."""

    def fault(run, driver, rng, monkeypatch):
        motion, step = rng.integers(2, 5), rng.integers(1, 4)

        def on_step(arm, now):
            if len(arm.sent) == motion and now == step:
                what(arm)

        driver.on_step = on_step

    return fault


def disk_fills(run, driver, rng, monkeypatch):
    """At one of the times at which the recording is brought to the disk."""
    left, real = int(rng.integers(2, 9)), os.fsync

    def fsync(number):
        nonlocal left
        left -= 1
        if left < 0:
            raise OSError(28, "No space left on device")
        real(number)

    monkeypatch.setattr(writer_module.os, "fsync", fsync)


def refuses(arm: ScriptedArm) -> None:
    """As a controller does that does not take a way."""
    raise ArmError("arm: refused the motion (protective stop); acknowledge it there")


def cut(arm: ScriptedArm) -> None:
    """The connection."""
    raise ArmError("arm: connection lost; check the network")


FAULTS: dict[str, Fault] = {
    "camera silent": camera_fails("no frame within 5 s"),
    "unplugged": camera_fails("unplugged, and not back within 15 s"),
    "frames dropped": camera_fails("no frame of which any can be used"),
    "timestamps backwards": camera_fails("its clock runs backwards"),
    "arm refuses": arm_fails(refuses),
    "arm stops half-way": arm_fails(lambda arm: setattr(arm, "moving", False)),
    "connection cut": arm_fails(cut),
    "disk full": disk_fills,
}


def try_fault(fault: Fault, seed: int, out: Path, whole: list, monkeypatch: pytest.MonkeyPatch) -> None:
    """Break a run at a place that the seed says, then take it up again."""
    driver = ScriptedArm()
    run = a_run(out, driver)
    with monkeypatch.context() as patch:
        fault(run, driver, np.random.default_rng(seed), patch)
        with pytest.raises(ONE_LINE) as raised:
            run.go()
    assert "\n" not in str(raised.value)
    assert not driver.moving
    assert driver.stops > 0 or raised.type is not ArmError
    kept = last_recording(out)
    n = 0 if kept is None else len(kept.bursts)
    assert n >= 1
    again = a_run(out, ScriptedArm(flange=driver.flange), first=n).go()
    assert first_difference(whole, [decision_of(a) for a in again.acquisitions]) is None


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Decisions of a run that nothing stopped."""
    return [decision_of(a) for a in a_run(tmp_path_factory.mktemp("whole")).go().acquisitions]


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_once(name, whole, tmp_path, monkeypatch):
    """The slow test has each 50 times."""
    try_fault(FAULTS[name], 0, tmp_path, whole, monkeypatch)


@pytest.mark.slow
@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_fifty_times(name, whole, tmp_path, monkeypatch):
    """At other places of the run each time."""
    for seed in range(1, TIMES + 1):
        try_fault(FAULTS[name], seed, tmp_path / str(seed), whole, monkeypatch)


@pytest.mark.slow
def test_kill_9_fifty_times(controller, tmp_path):
    """In a motion, at a random time after it began: it stands soon, and what was recorded can be read."""
    port, log = controller
    rng = np.random.default_rng(0)
    for k in range(1, TIMES + 1):
        folder = tmp_path / str(k)
        folder.mkdir()
        motions = log.read_text().count("go") if log.exists() else 0
        process = start(folder, port, 0.05, "--go")
        wait_for(log, "go", motions + 1)
        time.sleep(rng.uniform(0.0, 0.4))
        os.kill(process.pid, signal.SIGKILL)
        process.communicate(timeout=20)
        time.sleep(1.0)
        assert still(port)
        last_recording(folder / "run")
