"""Runs on a cell: the same decisions as a replay of their recording, taken up again after whatever stopped them."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.adapters.arms.driver import ArmError, FlangePath
from franbv.adapters.camera_error import CameraError
from franbv.adapters.live.resumed import CannotResumeError
from franbv.adapters.live.run import LiveRun, last_recording, recordings_in
from franbv.adapters.live.switch import StoppedError, StopSwitch
from franbv.adapters.recording.contents import RecordingError
from franbv.adapters.recording.decisions import decision_of, first_difference
from franbv.adapters.recording.mcap_recording import read_recording
from franbv.adapters.recording.replay import replay
from franbv.planners import fra
from tests.franbv.adapters.live.cells import CELL, ScriptedArm, guarded
from tests.franbv.adapters.recording.recorded_run import CAMERA, PARAMETERS, RUN, SEED, InSteps, camera


class Failing(InSteps):
    """A camera that fails at one of its bursts."""

    fails_at: int | None = None

    def capture(self, T_world_cam, n_frames):
        if self.captures == self.fails_at:
            self.fails_at = None
            raise CameraError("analytic camera: no frame within 5 s; check its cable")
        return super().capture(T_world_cam, n_frames)


def a_run(out, driver=None, first=0, **changes) -> LiveRun:
    """On the scripted arm; first: the burst at which the camera's noise begins."""
    taken = camera(Failing)
    taken.captures = first
    settings = {"camera": taken, "arm": guarded(driver or ScriptedArm()), "facts": RUN} | changes
    return LiveRun(planner=fra(), parameters=PARAMETERS, camera_facts=CAMERA, out=out, **settings)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run that nothing stopped."""
    out = tmp_path_factory.mktemp("whole")
    return out, a_run(out).go()


def decisions(run) -> list:
    return [decision_of(a) for a in run.acquisitions]


def test_a_replay_of_its_recording_decides_alike(whole):
    """Every decision of the run is in the recording, and is taken again."""
    out, run = whole
    recording = last_recording(out)
    assert recording is not None
    found = replay(recording, fra(), PARAMETERS, SEED)
    assert (found.mode, found.decisions_equal, found.n_decisions) == ("closed_loop", True, len(run.acquisitions))
    assert {a.kind for a in run.acquisitions} == {"first", "nbv", "recovery"}


@pytest.mark.parametrize("at", [1, 2, 4])
def test_what_was_stopped_goes_on(at, whole, tmp_path):
    """By a camera that fails at a burst: afterwards all decisions are those of the run that nothing stopped."""
    _, run = whole
    stopped = a_run(tmp_path)
    stopped.camera.fails_at = at
    with pytest.raises(CameraError, match="check its cable"):
        stopped.go()
    recording = last_recording(tmp_path)
    assert recording is not None
    assert (len(recording.bursts), recording.stop) == (at, None)
    seen, shown = [], []
    driver = ScriptedArm(flange=stopped.arm.driver.flange)
    watched = {"observe": lambda a: seen.append(a.index), "show": lambda a, infrared: shown.append(a.index)}
    again = a_run(tmp_path, driver, first=at, **watched).go()
    assert first_difference(decisions(run), decisions(again)) is None
    assert seen == list(range(at, len(run.acquisitions)))
    assert shown == list(range(len(run.acquisitions)))
    last = last_recording(tmp_path)
    assert last is not None
    assert (len(last.bursts), last.stop) == (len(run.acquisitions), str(run.stop))
    assert len(recordings_in(tmp_path)) == 2


def test_nothing_moves_while_the_recording_is_used_up(whole, tmp_path):
    """The motions of the second part alone are sent."""
    stopped = a_run(tmp_path)
    stopped.camera.fails_at = 3
    with pytest.raises(CameraError):
        stopped.go()
    driver = ScriptedArm(flange=stopped.arm.driver.flange)
    a_run(tmp_path, driver, first=3).go()
    first_goal = CELL.camera_at(driver.sent[-1].poses[-1])
    recording = last_recording(tmp_path)
    assert recording is not None
    assert np.allclose(first_goal.as_matrix(), recording.bursts[-1].T_asked.as_matrix())
    ends = [CELL.camera_at(path.poses[-1]).translation for path in driver.sent]
    asked = [burst.T_asked.translation for burst in recording.bursts]
    reached = [min(np.linalg.norm(end - place) for end in ends) < 1e-9 for place in asked]
    assert reached[:3] == [False] * 3
    assert all(reached[3:])


def test_a_refused_motion_makes_the_planner_choose_another(tmp_path):
    """A person says no to the second motion: that pose is not taken, the run ends well, and so does its replay."""
    answers = iter([True, False])
    arm = guarded(ScriptedArm(), may_move=lambda motion: next(answers, True))
    said, shown = [], []
    run = a_run(tmp_path, arm=arm, say=said.append, show=lambda a, infrared: shown.append(a.index))
    ended = run.go()
    assert shown == list(range(len(ended.acquisitions)))
    assert any("was not confirmed; the planner chooses another pose" in words for words in said)
    refused = arm.refused[0]
    taken = [a.burst.T_world_cam for a in ended.acquisitions]
    assert all(np.linalg.norm(T.translation - refused.translation) > 1e-6 for T in taken)
    recording = last_recording(tmp_path)
    assert recording is not None
    assert replay(recording, fra(), PARAMETERS, SEED).decisions_equal


def test_another_run_is_not_taken_up(whole):
    """Another seed, planner or parameter needs another folder."""
    out, _ = whole
    for changed in (replace(RUN, seed=9), replace(RUN, planner="pb"), replace(RUN, parameters={"n_frames": 4})):
        with pytest.raises(CannotResumeError, match="was begun with another"):
            a_run(out, facts=changed).go()


def test_cut_off_anywhere(whole, tmp_path):
    """A recording that a kill cut at any byte is taken up at its last whole burst, or begun anew."""
    out, run = whole
    data = recordings_in(out)[0].read_bytes()
    rng = np.random.default_rng(0)
    for k, size in enumerate(sorted(rng.integers(0, len(data), 6))):
        folder = tmp_path / str(k)
        folder.mkdir()
        (folder / "recording-1.mcap").write_bytes(data[:size])
        found = last_recording(folder)
        n = 0 if found is None else len(found.bursts)
        again = a_run(folder, first=n).go()
        assert first_difference(decisions(run), decisions(again)) is None


def test_a_full_disk(tmp_path, monkeypatch):
    """The run ends in one line, the arm stands, and what was written is taken up."""
    run = a_run(tmp_path)
    import franbv.adapters.recording.writer as writer

    real, count = writer.os.fsync, iter(range(100))

    def fsync(number):
        if next(count) >= 4:
            raise OSError(28, "No space left on device")
        real(number)

    monkeypatch.setattr(writer.os, "fsync", fsync)
    with pytest.raises(RecordingError, match=r"No space left on device.; free some space"):
        run.go()
    monkeypatch.undo()
    assert not run.arm.driver.moving
    recording = last_recording(tmp_path)
    assert recording is not None
    assert read_recording(recording.path).bursts


ARM_FAULTS = {
    "stops half-way": lambda arm, step: setattr(arm, "moving", False),
    "connection lost": lambda arm, step: (_ for _ in ()).throw(ArmError("arm: connection lost; check the network")),
}


@pytest.mark.parametrize("fault", ARM_FAULTS)
def test_arm_faults(fault, tmp_path):
    """In the middle of the third motion: stopped, one line, and what was taken is kept."""
    driver = ScriptedArm()

    def on_step(arm, step):
        if len(arm.sent) == 3 and step == 2:
            ARM_FAULTS[fault](arm, step)

    driver.on_step = on_step
    with pytest.raises(ArmError):
        a_run(tmp_path, driver).go()
    assert (driver.moving, driver.stops > 0) == (False, True)
    recording = last_recording(tmp_path)
    assert recording is not None
    assert 1 <= len(recording.bursts) <= 2


def test_the_switch_stops_a_motion(tmp_path):
    """Pressed in the middle of one: the driver is told at once, and the run says who pressed it."""
    switch, driver = StopSwitch(), ScriptedArm()

    def on_step(arm, step):
        if len(arm.sent) == 2 and step == 1:
            switch.press("stopped by a key")

    driver.on_step = on_step
    with pytest.raises(StoppedError, match="stopped by a key"):
        a_run(tmp_path, arm=guarded(driver, switch=switch)).go()
    assert (driver.moving, driver.stops > 0) == (False, True)


def test_a_silent_camera_stops_a_motion(tmp_path):
    """No frame while the arm moves."""
    driver = ScriptedArm()
    arm = guarded(driver, camera_lives=lambda: len(driver.sent) < 2)
    with pytest.raises(ArmError, match="camera no longer answers"):
        a_run(tmp_path, arm=arm).go()
    assert driver.stops > 0


def test_an_arm_that_leaves_its_way_is_stopped(tmp_path):
    """Its own word says that it is elsewhere."""
    driver = ScriptedArm()
    clock = iter(np.arange(0.0, 1e5, 0.15))
    arm = guarded(driver, clock=lambda: float(next(clock)))

    def on_step(moved, step):
        if step == 3:
            moved.flange = CELL.flange_at(
                CELL.camera_at(moved.flange) * RigidTransform.from_translation((0.0, 0.1, 0.0))
            )

    driver.on_step = on_step
    with pytest.raises(ArmError, match="mm off its way"):
        a_run(tmp_path, arm=arm).go()
    assert driver.stops > 0


def test_a_person_as_the_arm(tmp_path):
    """They take the camera some way of their own and put it 1 cm beside the goal: bursts have the pose where it is."""

    @dataclass
    class Person(ScriptedArm):
        def execute(self, path, may_go_on):
            super().execute(path, may_go_on)
            self.flange = CELL.flange_at(
                RigidTransform.from_translation((0.0, 0.01, 0.0)) * CELL.camera_at(self.flange)
            )

    through_it = lambda path: FlangePath((path.poses[0], path.poses[-1]), 0.0)  # noqa: E731
    driver = Person(bend=through_it)
    ended = a_run(tmp_path, arm=guarded(driver, by_hand=True)).go()
    recording = last_recording(tmp_path)
    assert recording is not None
    assert len(recording.bursts) == len(ended.acquisitions) > 3
    for burst in recording.bursts:
        assert np.allclose(burst.T_world_cam.translation - burst.T_asked.translation, (0.0, 0.01, 0.0))


def test_an_arm_that_does_not_arrive_is_stopped(tmp_path):
    """Its clock runs on, and it is not there."""
    driver = ScriptedArm()
    clock = iter(np.arange(0.0, 1e6, 10.0))
    with pytest.raises(ArmError, match="did not arrive in time"):
        a_run(tmp_path, arm=guarded(driver, clock=lambda: float(next(clock)))).go()
    assert driver.stops > 0
