"""A robot behind a rosbridge, on loopback: six axes whose kinematics are known in closed form, MoveIt's services and
action.

Every message that arrives is held against MoveIt's definitions, every answer too. `script` says what goes wrong.
"""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

from tests.franbv.adapters.arms.ros_messages import faults, fields_of, filled

AXES = ("x", "y", "z", "yaw", "pitch", "roll")
"""Three slides and a wrist: T_base_flange = translation, then intrinsic rotations about z, y, x."""
REACH_M = 1.0
SERVICES = {
    "/compute_ik": "moveit_msgs/srv/GetPositionIK",
    "/compute_fk": "moveit_msgs/srv/GetPositionFK",
    "/plan_kinematic_path": "moveit_msgs/srv/GetMotionPlan",
    "/apply_planning_scene": "moveit_msgs/srv/ApplyPlanningScene",
}
ACTION = "moveit_msgs/action/ExecuteTrajectory"
TOPICS = {"/trajectory_execution_event": "std_msgs/msg/String"}
OPS = {
    "call_service": {"op", "id", "service", "args", "timeout"},
    "send_action_goal": {"op", "id", "action", "action_type", "args", "feedback"},
    "cancel_action_goal": {"op", "id", "action"},
    "advertise": {"op", "id", "topic", "type", "latch", "queue_size"},
    "publish": {"op", "id", "topic", "msg", "latch"},
    "subscribe": {"op", "id", "topic", "type", "compression", "throttle_rate", "queue_length"},
}
"""rosbridge v2 with actions (ROSBRIDGE_PROTOCOL.md), the fields that its operations have."""


def forward(joints: np.ndarray) -> RigidTransform:
    """T_base_flange."""
    return RigidTransform.from_components(joints[:3], Rotation.from_euler("ZYX", joints[3:]))


def inverse(T: RigidTransform) -> np.ndarray:
    """The joints that stand there."""
    return np.concatenate([T.translation, T.rotation.as_euler("ZYX")])


def pose_json(T: RigidTransform) -> dict[str, Any]:
    """geometry_msgs/Pose."""
    return {
        "position": dict(zip("xyz", T.translation.tolist(), strict=True)),
        "orientation": dict(zip("xyzw", T.rotation.as_quat().tolist(), strict=True)),
    }


def transform(pose: dict[str, Any]) -> RigidTransform:
    """The same read."""
    turn = Rotation.from_quat([pose["orientation"][k] for k in "xyzw"])
    return RigidTransform.from_components([pose["position"][k] for k in "xyz"], turn)


@dataclass
class StubMoveIt:
    """The robot, what it heard, and what it is told to do wrong."""

    version: str
    joints: np.ndarray = field(default_factory=lambda: np.array([0.3, 0.1, 0.4, 0.2, 0.1, -0.1]))
    codes: dict[str, int] = field(default_factory=dict)  # service -> error code that it answers
    failing: set[str] = field(default_factory=set)  # services that rosbridge cannot call
    silent: set[str] = field(default_factory=set)  # services, or `goal`, or `states`, that never answer
    script: str = ""  # of the execution: reject, half_way, cut, mute, late, elsewhere, old
    duration_s: float = 0.4
    points: int = 3
    late_s: float = 0.0
    heard: list[dict[str, Any]] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)
    n_results: int = 0
    port: int = 0
    stop: threading.Event = field(default_factory=threading.Event)
    closing: threading.Event = field(default_factory=threading.Event)
    moving: threading.Event = field(default_factory=threading.Event)
    sent_lock: threading.Lock = field(default_factory=threading.Lock)
    movers: list[threading.Thread] = field(default_factory=list)

    @property
    def url(self) -> str:
        """Where it listens."""
        return f"ws://127.0.0.1:{self.port}"

    @property
    def stops(self) -> int:
        """How often MoveIt's own stop was heard."""
        return sum(one.get("topic") == "/trajectory_execution_event" and one["op"] == "publish" for one in self.heard)

    def ops(self, op: str) -> list[dict[str, Any]]:
        """What was heard of that kind."""
        return [one for one in self.heard if one["op"] == op]

    @contextmanager
    def running(self) -> Iterator["StubMoveIt"]:
        """Listen on loopback."""
        fields_of(self.version)  # parsed before anybody waits
        with serve(self._serve, "127.0.0.1", self.port) as server:
            self.port = server.socket.getsockname()[1]
            thread = threading.Thread(target=server.serve_forever)
            thread.start()
            try:
                yield self
            finally:
                self.closing.set()
                self.stop.set()
                server.shutdown()
                thread.join()
                for mover in self.movers:
                    mover.join()

    def _serve(self, connection: ServerConnection) -> None:
        with suppress(ConnectionClosed):
            for text in connection:
                message = json.loads(text)
                self.heard.append(message)
                unknown = set(message) - OPS.get(message["op"], set())
                self.wrong += [f"{message['op']}.{key}: no such field" for key in unknown]
                try:
                    getattr(self, f"_{message['op']}", lambda *_: None)(connection, message)
                except (AssertionError, KeyError, TypeError, ValueError) as error:
                    self.wrong.append(f"{message['op']}: {error!r}")

    def _check(self, value: Any, type_name: str) -> None:
        self.wrong += faults(value, type_name, self.version, complete=False)

    def _send(self, connection: ServerConnection, message: dict[str, Any]) -> None:
        with suppress(ConnectionClosed), self.sent_lock:
            connection.send(json.dumps(message))

    # -- topics -------------------------------------------------------------------------------------------------------
    def _subscribe(self, connection: ServerConnection, message: dict[str, Any]) -> None:
        assert (message["topic"], message["type"]) == ("/joint_states", "sensor_msgs/msg/JointState")
        self.movers.append(threading.Thread(target=self._tell_joints, args=(connection,)))
        self.movers[-1].start()

    def _tell_joints(self, connection: ServerConnection) -> None:
        while not self.closing.wait(0.02):
            if "states" in self.silent:
                continue
            state = {"name": [*AXES, "finger"], "position": [*self.joints.tolist(), 0.0]}
            message = filled(state, "sensor_msgs/msg/JointState", self.version)
            try:
                with self.sent_lock:
                    connection.send(json.dumps({"op": "publish", "topic": "/joint_states", "msg": message}))
            except ConnectionClosed:
                return

    def _advertise(self, connection: ServerConnection, message: dict[str, Any]) -> None:
        if TOPICS.get(message["topic"]) != message["type"]:
            self.wrong.append(f"advertise: {message['topic']} of {message['type']}")

    def _publish(self, connection: ServerConnection, message: dict[str, Any]) -> None:
        self._check(message["msg"], TOPICS[message["topic"]])
        if message["msg"]["data"] == "stop":
            self.stop.set()

    # -- services -----------------------------------------------------------------------------------------------------
    def _call_service(self, connection: ServerConnection, message: dict[str, Any]) -> None:
        service, args = message["service"], message["args"]
        kind = SERVICES[service]
        self._check(args, f"{kind}_Request")
        if service in self.silent:
            return
        answer = {"op": "service_response", "id": message["id"], "service": service, "result": True}
        if service in self.failing:
            self._send(connection, answer | {"result": False, "values": f"Service {service} does not exist"})
            return
        found = getattr(self, service.replace("/", "_"))(args, self.codes.get(service, 1))
        values = filled(found, f"{kind}_Response", self.version)
        self.wrong += faults(values, f"{kind}_Response", self.version, complete=True)
        self._send(connection, answer | {"values": values})

    def _said_joints(self, state: dict[str, Any]) -> np.ndarray:
        said = dict(zip(state["joint_state"]["name"], state["joint_state"]["position"], strict=True))
        return np.array([said[axis] for axis in AXES])

    def _compute_ik(self, args: dict[str, Any], code: int) -> dict[str, Any]:
        request = args["ik_request"]
        goal = transform(request["pose_stamped"]["pose"])
        assert (request["group_name"], request["ik_link_name"]) == ("arm", "flange")
        if code == 1 and np.linalg.norm(goal.translation) > REACH_M:
            code = -31
        return {"solution": self._state(inverse(goal)), "error_code": {"val": code}}

    def _compute_fk(self, args: dict[str, Any], code: int) -> dict[str, Any]:
        pose = {"header": args["header"], "pose": pose_json(forward(self._said_joints(args["robot_state"])))}
        return {"pose_stamped": [pose], "fk_link_names": args["fk_link_names"], "error_code": {"val": code}}

    def _plan_kinematic_path(self, args: dict[str, Any], code: int) -> dict[str, Any]:
        request = args["motion_plan_request"]
        (goal,) = request["goal_constraints"]
        (place,), (turn,) = goal["position_constraints"], goal["orientation_constraints"]
        position = place["constraint_region"]["primitive_poses"][0]["position"]
        end = inverse(transform({"position": position, "orientation": turn["orientation"]}))
        if self.script == "elsewhere":
            end[1] += 0.05
        start = self._said_joints(request["start_state"])
        points = []
        for share in np.linspace(0, 1, self.points):
            seconds = share * self.duration_s
            time_from_start = {"sec": int(seconds), "nanosec": int(seconds % 1 * 1e9)}
            points.append({"positions": (start + share * (end - start)).tolist(), "time_from_start": time_from_start})
        way = {"joint_trajectory": {"joint_names": list(AXES), "points": points if code == 1 else []}}
        response = {"trajectory_start": self._state(start), "group_name": "arm", "trajectory": way}
        return {"motion_plan_response": response | {"planning_time": 0.1, "error_code": {"val": code}}}

    def _apply_planning_scene(self, args: dict[str, Any], code: int) -> dict[str, Any]:
        return {"success": code == 1}

    def _state(self, joints: np.ndarray) -> dict[str, Any]:
        return {"joint_state": {"name": list(AXES), "position": joints.tolist()}}

    # -- the action ---------------------------------------------------------------------------------------------------
    def _send_action_goal(self, connection: ServerConnection, message: dict[str, Any]) -> None:
        assert (message["action"], message["action_type"]) == ("/execute_trajectory", ACTION)
        self._check(message["args"], f"{ACTION}_Goal")
        self.stop.clear()
        mover = threading.Thread(target=self._move, args=(connection, message))
        self.movers.append(mover)
        mover.start()

    def _cancel_action_goal(self, connection: ServerConnection, message: dict[str, Any]) -> None:
        if message["id"] not in {goal["id"] for goal in self.ops("send_action_goal")}:
            self.wrong.append(f"cancel of {message['id']}, which is no goal")
        self.stop.set()

    def _move(self, connection: ServerConnection, message: dict[str, Any]) -> None:
        base = {"op": "action_result", "id": message["id"], "action": message["action"]}
        if self.script == "reject":
            self._send(connection, base | {"values": "Action goal was rejected", "status": 0, "result": False})
            return
        if self.script == "old":  # rosbridge before it sent a status with what failed
            self._send(connection, base | {"values": "Action goal was rejected", "result": False})
            return
        self.moving.set()
        feedback = filled({"state": "MONITOR"}, f"{ACTION}_Feedback", self.version)
        self._send(connection, base | {"op": "action_feedback", "values": feedback})
        points = message["args"]["trajectory"]["joint_trajectory"]["points"]
        positions = np.array([point["positions"] for point in points])
        code = self._follow(connection, positions)
        self.closing.wait(self.late_s)
        if "goal" in self.silent:
            return
        result = filled({"error_code": {"val": code}}, f"{ACTION}_Result", self.version)
        self.wrong += faults(result, f"{ACTION}_Result", self.version, complete=True)
        self.n_results += 1
        status = {1: 4, -7: 5}.get(code, 6)
        self._send(connection, base | {"values": result, "status": status, "result": True})

    def _follow(self, connection: ServerConnection, positions: np.ndarray) -> int:
        """Move the joints along; the error code of how it ended."""
        begun, shares = time.monotonic(), np.linspace(0, 1, len(positions))
        while (share := (time.monotonic() - begun) / self.duration_s) < 1:
            if self.stop.is_set():
                return -7
            self.joints = np.array([np.interp(share, shares, column) for column in positions.T])
            if share > 0.5 and self.script == "half_way":
                return -4
            if share > 0.5 and self.script == "cut":
                self.script = ""
                connection.socket.close()
            if share > 0.5 and self.script == "mute":
                self.silent.add("states")
            time.sleep(0.005)
        self.joints = positions[-1]
        return 1
