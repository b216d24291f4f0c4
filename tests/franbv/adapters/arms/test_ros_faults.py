"""What goes wrong between us and a moving arm: each time it is told to stop while anyone listens, and one line says
why."""

import threading
import time

import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.arms import ros_arm
from franbv.adapters.arms.driver import ArmError
from franbv.adapters.arms.ros_arm import RosArm
from franbv.adapters.arms.ros_settings import RosArmSettings
from tests.franbv.adapters.arms.stub_moveit import StubMoveIt

GOAL = RigidTransform.from_components([0.4, 0.2, 0.3], Rotation.from_euler("ZYX", [0.4, 0.1, 0.0]))
HOME = RigidTransform.from_components([0.3, 0.1, 0.4], Rotation.identity())
LONG_S = 20.0
"""A way that is never gone to its end here."""


def on() -> bool:
    """Go on."""
    return True


def fails(words: str, call, *args) -> None:
    """The call ends in one line that says this."""
    with pytest.raises(ArmError, match=words) as caught:
        call(*args)
    assert "\n" not in str(caught.value)


def wait_for(happened, seconds: float = 20.0) -> None:
    """Until it is so; messages are under way."""
    end = time.monotonic() + seconds
    while not happened():
        assert time.monotonic() < end, "it never came"
        time.sleep(0.01)


@pytest.mark.parametrize(
    ("stub", "method", "words"),
    [
        ({"codes": {"/compute_ik": -15}}, "can_reach", r"compute_ik: MoveIt refused \(INVALID_GROUP_NAME -15\); check"),
        (
            {"failing": {"/compute_ik"}},
            "can_reach",
            r"compute_ik was not called \(Service /compute_ik does not exist\)",
        ),
        ({"silent": {"/compute_ik"}}, "can_reach", "compute_ik did not answer within 1 s; is MoveIt"),
        ({"codes": {"/compute_fk": -18}}, "flange_pose", "compute_fk: MoveIt refused .INVALID_LINK_NAME -18"),
        ({"silent": {"states"}}, "flange_pose", "/joint_states: nothing heard for 1 s; start the robot's driver"),
        (
            {"codes": {"/plan_kinematic_path": -10}},
            "plan",
            "plan_kinematic_path: MoveIt refused .START_STATE_IN_COLLISION",
        ),
        ({"failing": {"/plan_kinematic_path"}}, "plan", "plan_kinematic_path was not called"),
        ({"silent": {"/plan_kinematic_path"}}, "plan", "plan_kinematic_path did not answer within 1.2 s"),
        ({"script": "elsewhere"}, "plan", "ends 50.0 mm and 0.0 deg from what was asked; check base_frame base_link"),
    ],
)
def test_refused_or_silent_before_anything_moves(opened, stub: dict, method: str, words: str):
    """Refusals by code, services that are not there, services that are silent: stop was sent, one line says which."""
    waits = bool(stub.get("silent"))
    flags = {"call_timeout_s": 1.0, "planning_time_s": 0.2} if waits else {}
    arm = opened(server := StubMoveIt("later", **stub), **flags)
    fails(words, getattr(arm, method), *([] if method == "flange_pose" else [GOAL]))
    wait_for(lambda: server.stops)


@pytest.mark.parametrize(
    ("stub", "flags", "words"),
    [
        ({"script": "reject"}, {}, r"execute_trajectory: was not begun \(Action goal was rejected\)"),
        ({"script": "old"}, {}, "a message could not be read or sent"),
        ({"script": "half_way"}, {}, r"execute_trajectory: the arm stopped under way \(CONTROL_FAILED -4\)"),
        ({"silent": {"goal"}}, {"duration_margin_s": 0.5}, "no result within 1.1 s"),
        ({"late_s": 3.0}, {"duration_margin_s": 0.5}, "no result within 1.1 s"),
        ({"script": "mute", "duration_s": LONG_S}, {"state_timeout_s": 2.0}, "/joint_states: silent for 2 s while"),
    ],
)
def test_execution_that_goes_wrong(opened, stub: dict, flags: dict, words: str):
    """Refused, stopped half-way, silent, late, or joints that are no longer told: told to stop, in both ways."""
    arm = opened(server := StubMoveIt("later", **stub), **flags)
    path = arm.plan(GOAL)
    fails(words, arm.execute, path, on)
    wait_for(lambda: server.stops)
    if not stub.get("script") or stub["script"] == "mute":  # there was no result yet
        wait_for(lambda: server.ops("cancel_action_goal"))


def test_a_late_result_is_not_taken_for_another(opened):
    """The first way's result comes when the second is under way: the second is at its end when it says so itself."""
    arm = opened(server := StubMoveIt("later", late_s=3.0), duration_margin_s=1.0)
    fails("no result", arm.execute, arm.plan(GOAL), on)
    server.late_s, server.duration_s = 0.5, 2.0
    arm.execute(arm.plan(HOME), on)
    assert server.n_results == 2


@pytest.mark.parametrize("comes_back", [True, False])
def test_the_connection_is_cut_while_the_arm_moves(opened, comes_back: bool):
    """A new connection is opened to stop it; where there is none, the line says that the arm may still move."""
    arm = opened(server := StubMoveIt("later", duration_s=1.0, script="cut"), connect_timeout_s=10.0)
    path = arm.plan(GOAL)
    if not comes_back:
        arm.settings = arm.settings.model_copy(update={"url": "ws://127.0.0.1:9", "connect_timeout_s": 0.5})
        fails("the connection was lost.*; the arm may still move: stop it there", arm.execute, path, on)
        return
    fails("the connection was lost.*; a stop was sent over a new connection", arm.execute, path, on)
    assert server.stops >= 1
    fails("the connection was lost; check network and rosbridge, and open the arm anew", arm.flange_pose)


def test_an_error_while_it_stops_hides_nothing(opened, monkeypatch: pytest.MonkeyPatch):
    """What breaks in the second connection, of whatever kind, ends in the same line: nobody could stop the arm."""
    arm = opened(StubMoveIt("later", duration_s=1.0, script="cut"))
    path = arm.plan(GOAL)

    def broken(url: str, connect_timeout_s: float) -> None:
        raise OSError("no socket is left")

    monkeypatch.setattr(ros_arm, "RosBridge", broken)
    fails("the connection was lost.*; the arm may still move: stop it there", arm.execute, path, on)


@pytest.mark.parametrize("who", ["says no", "raises", "another thread"])
def test_whoever_watches_can_stop_it(opened, who: str):
    """Asked again and again; a no, an error and a stop from elsewhere end the motion long before its end."""
    arm = opened(server := StubMoveIt("later", duration_s=LONG_S))
    path = arm.plan(GOAL)

    def may_go_on() -> bool:
        if who == "raises" and server.moving.is_set():
            raise RuntimeError("the guard fell asleep")
        return who != "says no" or not server.moving.is_set()

    if who == "another thread":
        # Somewhat later: right at the beginning the goal is not known yet, and there is nothing to cancel.
        threading.Thread(target=lambda: (server.moving.wait(), time.sleep(0.5), arm.stop(), arm.stop())).start()
    words = {
        "says no": "whoever watches it",
        "raises": "RuntimeError: the guard fell asleep",
        "another thread": "stopped",
    }
    fails(words[who], arm.execute, path, may_go_on)
    wait_for(lambda: server.stops and server.ops("cancel_action_goal"))
    assert abs(server.joints - path.trajectory.way.positions[-1]).max() > 0.01, "it went on to the end"


def test_it_asks_often_while_the_arm_moves(opened):
    """A way of half a second and the rest after it: asked ten times at least, as the protocol wants it."""
    arm = opened(StubMoveIt("later", duration_s=1.0))
    asked = []
    arm.execute(arm.plan(GOAL), lambda: not asked.append(time.monotonic()))
    assert len(asked) >= 1.0 / 0.05


def test_no_rosbridge_and_no_robot():
    """Nobody listens: one line says how to start it."""
    pytest.importorskip("roslibpy")
    settings = RosArmSettings(url="ws://127.0.0.1:9", connect_timeout_s=0.5)
    fails("ws://127.0.0.1:9: no rosbridge answers; start it on the robot", RosArm, settings)


def test_stop_and_close_never_raise(opened):
    """After the connection is gone as well, again and again."""
    arm = opened(StubMoveIt("later"))
    for _ in range(2):
        arm.stop()
        arm.close()
    arm.stop()
    fails("the connection is closed", arm.flange_pose)
