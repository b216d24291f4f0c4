"""An arm behind MoveIt 2, through rosbridge: planned by its planning services, moved by its execution action.

What MoveIt knows of joints, limits and collisions stays there; here is what must not go wrong between: an answer that
does not come, a way that is not the one that was looked at, a connection that is cut while the arm moves.
"""

import contextlib
import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

from scipy.spatial.transform import RigidTransform

from franbv.adapters.arms.driver import POLL_S, ArmError, FlangePath
from franbv.adapters.arms.flange_poses import flange_poses, pose_distance
from franbv.adapters.arms.joint_states import JointStates, farthest
from franbv.adapters.arms.moveit_messages import (
    NO_WAY,
    OUT_OF_REACH,
    SUCCESS,
    CollisionBox,
    JointWay,
    check_executed,
    code_of,
    code_words,
    fk_request,
    ik_request,
    joint_way,
    plan_request,
    pose_from_message,
    scene_request,
)
from franbv.adapters.arms.ros_settings import RosArmSettings
from franbv.adapters.arms.rosbridge import BridgeGoal, RosBridge, in_one_line

IK, FK, PLAN_SERVICE, SCENE_SERVICE = "/compute_ik", "/compute_fk", "/plan_kinematic_path", "/apply_planning_scene"
"""MoveIt's services (move_group's capabilities of kinematics, planning and scenes)."""
EXECUTE, EXECUTE_TYPE = "/execute_trajectory", "moveit_msgs/action/ExecuteTrajectory"
"""MoveIt's action."""
STOP, STOP_TYPE, STOP_WORD = "/trajectory_execution_event", "std_msgs/msg/String", "stop"
"""MoveIt's own stop (TrajectoryExecutionManager): whoever started it, what moves is stopped."""
JOINTS, JOINTS_TYPE = "/joint_states", "sensor_msgs/msg/JointState"
"""Where the arm says where it is."""
END_M, END_DEG = 0.002, 0.5
"""From a path's end to the pose that was asked for, at most (choice: what a planner's tolerance never reaches, and a
wrong frame or link always does)."""
STILL, STILL_S = 2e-4, 0.1
"""Joints that move less than this [rad, m] in this time [s] stand still (choice: 0.2 mm at the end of 1 m; encoders are
noisier by less)."""
_JOINTS_EVERY_MS = 20
"""Joint states are thinned to this [ms] (choice: as often as they are looked at)."""
_STOP_AGAIN_S, _STOP_AGAIN_EVERY_S = 1.0, 0.1
"""A new connection repeats its stop for so long [s], since ROS 2 needs a moment to bring publisher and listener
together."""


@dataclass(frozen=True, eq=False)
class PlannedWay:
    """What `RosArm` keeps in `FlangePath.trajectory`."""

    way: JointWay
    """The joints along it."""
    stops: int
    """How often the arm had been stopped when it was planned."""


class RosArm:
    """An `ArmDriver`. What is planned before a stop is not executed after it: plan anew.

    If the connection is cut while the arm moves, MoveIt goes on to the way's end; a new connection is opened at once to
    stop it. Where that fails, too, the message says so, and only the robot's own stop is left.
    """

    def __init__(self, settings: RosArmSettings) -> None:
        self.settings = settings
        self._stops = 0
        self._goal: BridgeGoal | None = None
        self._lock = threading.Lock()
        self._boxes: set[str] = set()
        self._states = JointStates()
        self._bridge = RosBridge(settings.url, settings.connect_timeout_s)
        try:
            self._bridge.advertise(STOP, STOP_TYPE)
            self._bridge.subscribe(JOINTS, JOINTS_TYPE, self._states.hear, _JOINTS_EVERY_MS)
        except ArmError:
            self._bridge.close()
            raise

    def __enter__(self) -> "RosArm":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def name(self) -> str:
        """For people."""
        return f"MoveIt's {self.settings.group} at {self.settings.url}"

    def flange_pose(self) -> RigidTransform:
        """Where the flange is now, T_base_flange: joints as they are, through MoveIt's kinematics."""
        with self._stopped_on_failure():
            return self._fk(self._joints())

    def can_reach(self, T_base_flange: RigidTransform) -> bool:
        """Whether MoveIt finds joint angles for it, free of collisions."""
        with self._stopped_on_failure():
            answer = self._call(IK, ik_request(self.settings, T_base_flange, self._joints()))
            if code_of(answer) in OUT_OF_REACH:
                return False
            self._check_code(IK, answer)
            return True

    def set_obstacles(self, boxes: Sequence[CollisionBox]) -> None:
        """Tell MoveIt what to plan around; boxes of an earlier call that are not among these are taken away."""
        with self._stopped_on_failure():
            names = [box.name for box in boxes]
            if len(set(names)) < len(names):
                raise ArmError(f"obstacles: two have the same name ({', '.join(sorted(names))}); name each otherwise")
            answer = self._call(SCENE_SERVICE, scene_request(self.settings, boxes, sorted(self._boxes - set(names))))
            if answer.get("success") is not True:
                raise ArmError(
                    f"{SCENE_SERVICE}: MoveIt did not take the obstacles; is {self.settings.base_frame} a frame of it?"
                )
            self._boxes = set(names)

    def plan(self, T_base_flange: RigidTransform) -> FlangePath | None:
        """A way there as MoveIt plans it, with the flange's poses along it; None if it finds none."""
        s = self.settings
        with self._stopped_on_failure():
            stops = self._stops
            search_s = s.planning_time_s * s.planning_attempts + s.call_timeout_s
            answer = self._call(PLAN_SERVICE, plan_request(s, T_base_flange, self._joints()), search_s)
            found = answer.get("motion_plan_response", {})
            if code_of(found) in NO_WAY:
                return None
            self._check_code(PLAN_SERVICE, found)
            way = joint_way(found.get("trajectory", {}))
            poses = self._poses_along(way)
            apart_m, apart_deg = pose_distance(poses[-1], T_base_flange)
            if apart_m > END_M or apart_deg > END_DEG:
                raise ArmError(
                    f"{PLAN_SERVICE}: the way ends {1e3 * apart_m:.1f} mm and {apart_deg:.1f} deg from what was asked; "
                    f"check base_frame {s.base_frame} and flange_link {s.flange_link}"
                )
            return FlangePath(tuple(poses), way.duration_s, PlannedWay(way, stops))

    def execute(self, path: FlangePath, may_go_on: Callable[[], bool]) -> None:
        """Go that way, watched; see `ArmDriver.execute`."""
        try:
            with self._stopped_on_failure():
                planned = path.trajectory
                if not isinstance(planned, PlannedWay):
                    raise ArmError("path: was not planned by this arm; execute what its plan gave")
                self._check_not_stopped(planned)
                self._check_stands_at(planned.way, 0, "start")
                self._ask(may_go_on)
                self._goal = self._bridge.send_goal(EXECUTE, EXECUTE_TYPE, {"trajectory": planned.way.message})
                self._watch(self._goal, planned, may_go_on)
                check_executed(EXECUTE, self._goal.values, refused=self._goal.refused)
                self._settle(planned, may_go_on)
        finally:
            self._goal = None

    def stop(self) -> None:
        """Stop at once, by MoveIt's own stop and by cancelling; over a new connection if this one is lost under way."""
        with contextlib.suppress(Exception):
            self._stop_by_all_means()

    def close(self) -> None:
        """Stop, and let go of the arm."""
        self.stop()
        self._bridge.close()

    def _stop_by_all_means(self) -> str:
        """Stop; returns what became of it where the connection is lost."""
        with self._lock:
            self._stops += 1
        goal = self._goal
        with contextlib.suppress(Exception):  # a stop that fails in one way is tried in the other
            self._bridge.publish(STOP, {"data": STOP_WORD})
        if goal is None:
            return ""
        with contextlib.suppress(Exception):
            self._bridge.cancel(goal)
        if not self._bridge.fault or goal.wait(0):
            return ""
        return "a stop was sent over a new connection" if self._stop_anew() else "the arm may still move: stop it there"

    def _stop_anew(self) -> bool:
        """Whether a new connection could be opened and a stop be sent."""
        try:
            with RosBridge(self.settings.url, self.settings.connect_timeout_s) as bridge:
                bridge.advertise(STOP, STOP_TYPE)
                end = time.monotonic() + _STOP_AGAIN_S
                while time.monotonic() < end:
                    bridge.publish(STOP, {"data": STOP_WORD})
                    time.sleep(_STOP_AGAIN_EVERY_S)
                return not bridge.fault
        except Exception:  # whatever it is, the stop did not get through
            return False

    @contextlib.contextmanager
    def _stopped_on_failure(self) -> Iterator[None]:
        """Whatever goes wrong inside, the arm is told to stop before anyone learns of it; errors come out as
        ArmError."""
        try:
            yield
        except BaseException as error:
            fate = self._stop_by_all_means()
            if not isinstance(error, Exception):
                raise
            words = str(error) if isinstance(error, ArmError) else f"{type(error).__name__}: {in_one_line(error)}"
            raise ArmError(f"{words}; {fate}" if fate else words) from error

    def _call(self, service: str, args: Mapping[str, Any], timeout_s: float | None = None) -> dict[str, Any]:
        return self._bridge.call(service, args, timeout_s or self.settings.call_timeout_s)

    def _joints(self) -> dict[str, float]:
        self._bridge.check()
        return self._states.latest(self.settings.state_timeout_s, self.settings.call_timeout_s)

    def _check_code(self, service: str, answer: Mapping[str, Any]) -> None:
        if code_of(answer) != SUCCESS:
            raise ArmError(
                f"{service}: MoveIt refused ({code_words(answer)}); check group {self.settings.group}, link "
                f"{self.settings.flange_link}, frame {self.settings.base_frame}, and the state of the arm"
            )

    def _fk(self, joints: Mapping[str, float]) -> RigidTransform:
        answer = self._call(FK, fk_request(self.settings, joints))
        self._check_code(FK, answer)
        try:
            (stamped,) = answer["pose_stamped"]
            return pose_from_message(stamped["pose"])
        except (KeyError, TypeError, ValueError) as error:
            raise ArmError(f"{FK}: MoveIt's answer is no pose ({error!r}); check flange_link") from error

    def _poses_along(self, way: JointWay) -> list[RigidTransform]:
        others = self._joints()
        return flange_poses(way.positions, lambda joints: self._fk(others | dict(zip(way.names, joints, strict=True))))

    def _watch(self, goal: BridgeGoal, planned: PlannedWay, may_go_on: Callable[[], bool]) -> None:
        """Wait for the result; ArmError as soon as anything speaks against going on."""
        s = self.settings
        allowed_s = s.duration_factor * planned.way.duration_s + s.duration_margin_s
        deadline = time.monotonic() + allowed_s
        while not goal.wait(POLL_S):
            self._check_watched(planned, may_go_on)
            if time.monotonic() > deadline:
                raise ArmError(
                    f"{EXECUTE}: no result within {allowed_s:.1f} s; look whether the arm moves, and at MoveIt's log"
                )

    def _check_watched(self, planned: PlannedWay, may_go_on: Callable[[], bool]) -> None:
        self._bridge.check()
        self._check_not_stopped(planned)
        self._ask(may_go_on)
        if self._states.age_s() > self.settings.state_timeout_s:
            raise ArmError(
                f"{JOINTS}: silent for {self.settings.state_timeout_s:g} s while the arm moves; check the network"
            )

    def _check_not_stopped(self, planned: PlannedWay) -> None:
        if planned.stops != self._stops:
            raise ArmError("the arm was stopped since this way was planned; plan anew from where it stands")

    def _ask(self, may_go_on: Callable[[], bool]) -> None:
        if not may_go_on():
            raise ArmError("the arm was stopped: whoever watches it said so")

    def _settle(self, planned: PlannedWay, may_go_on: Callable[[], bool]) -> None:
        """Wait until the joints say themselves that they are at the end and stand still; ArmError if they do not."""
        end = time.monotonic() + self.settings.call_timeout_s
        before = self._joints()
        while time.monotonic() < end:
            pause_end = time.monotonic() + STILL_S
            while time.monotonic() < pause_end:
                self._check_watched(planned, may_go_on)
                time.sleep(POLL_S)
            now = self._joints()
            at_end = farthest(now, planned.way.joints(-1)) <= self.settings.joint_tolerance
            if at_end and farthest(now, {name: before.get(name, math.inf) for name in planned.way.names}) <= STILL:
                return
            before = now
        self._check_stands_at(planned.way, -1, "end")
        raise ArmError(f"{EXECUTE}: the arm does not come to rest; look what moves it")

    def _check_stands_at(self, way: JointWay, k: int, word: str) -> None:
        if (apart_by := farthest(self._joints(), way.joints(k))) > self.settings.joint_tolerance:
            raise ArmError(
                f"a joint stands {apart_by:.3f} rad (or m) from the way's {word}, {self.settings.joint_tolerance:g} "
                "allowed; plan anew from where the arm stands"
            )
