"""MoveIt 2's messages as rosbridge carries them: made from poses and settings, read into poses and joints.

Fields are those that moveit_msgs has in ROS 2 Humble and later alike; what is left out, rosbridge fills with zeros.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.arms.driver import ArmError
from franbv.adapters.arms.ros_settings import RosArmSettings
from franbv.adapters.arms.rosbridge import in_one_line

Json = Mapping[str, Any]
SUCCESS = 1
"""moveit_msgs/MoveItErrorCodes."""
OUT_OF_REACH = {
    -31: "NO_IK_SOLUTION",
    -12: "GOAL_IN_COLLISION",
    -14: "GOAL_CONSTRAINTS_VIOLATED",
    -27: "GOAL_STATE_INVALID",
}
"""Codes that say of a goal that the arm cannot be there."""
NO_WAY = OUT_OF_REACH | {-1: "PLANNING_FAILED", -2: "INVALID_MOTION_PLAN", -6: "TIMED_OUT", 99999: "FAILURE"}
"""Codes that say that a planner found no way."""
CODE_NAMES = NO_WAY | {
    -3: "MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE", -4: "CONTROL_FAILED", -5: "UNABLE_TO_AQUIRE_SENSOR_DATA",
    -7: "PREEMPTED", -10: "START_STATE_IN_COLLISION", -11: "START_STATE_VIOLATES_PATH_CONSTRAINTS",
    -13: "GOAL_VIOLATES_PATH_CONSTRAINTS", -15: "INVALID_GROUP_NAME", -16: "INVALID_GOAL_CONSTRAINTS",
    -17: "INVALID_ROBOT_STATE", -18: "INVALID_LINK_NAME", -19: "INVALID_OBJECT_NAME", -21: "FRAME_TRANSFORM_FAILURE",
    -22: "COLLISION_CHECKING_UNAVAILABLE", -23: "ROBOT_STATE_STALE", -24: "SENSOR_INFO_STALE",
    -25: "COMMUNICATION_FAILURE", -26: "START_STATE_INVALID", -28: "UNRECOGNIZED_GOAL_TYPE", -29: "CRASH", -30: "ABORT",
}  # fmt: skip
"""moveit_msgs/MoveItErrorCodes, ROS 2."""
_BOX, _SPHERE = 1, 2
"""shape_msgs/SolidPrimitive."""
_REMOVE = 1
"""moveit_msgs/CollisionObject; ADD is 0 and so left out."""


@dataclass(frozen=True, eq=False)
class CollisionBox:
    """Something that the arm must not touch."""

    name: str
    """By which it is known to MoveIt; a box of the same name is replaced."""
    T_base_box: RigidTransform
    """Its middle and its axes in the robot's base."""
    size_m: tuple[float, float, float]
    """Its sides along its own axes [m]."""


def pose_message(T: RigidTransform) -> dict[str, Any]:
    """geometry_msgs/Pose."""
    x, y, z = T.translation.tolist()
    qx, qy, qz, qw = T.rotation.as_quat().tolist()
    return {"position": {"x": x, "y": y, "z": z}, "orientation": {"x": qx, "y": qy, "z": qz, "w": qw}}


def pose_from_message(message: Json) -> RigidTransform:
    """The same read; KeyError, TypeError or ValueError where it is none."""
    place, turn = message["position"], message["orientation"]
    numbers = [place[k] for k in "xyz"] + [turn[k] for k in "xyzw"]
    if not np.isfinite(np.array(numbers, float)).all():
        raise ValueError("pose that is not finite")
    return RigidTransform.from_components(numbers[:3], Rotation.from_quat(numbers[3:]))


def state_message(joints: Mapping[str, float]) -> dict[str, Any]:
    """moveit_msgs/RobotState: these joints there, all others where MoveIt sees them."""
    return {"joint_state": {"name": list(joints), "position": list(joints.values())}, "is_diff": True}


def duration_message(seconds: float) -> dict[str, int]:
    """builtin_interfaces/Duration."""
    whole = int(seconds)
    return {"sec": whole, "nanosec": round((seconds - whole) * 1e9) % 1_000_000_000}


def ik_request(settings: RosArmSettings, T_base_flange: RigidTransform, joints: Mapping[str, float]) -> dict[str, Any]:
    """moveit_msgs/GetPositionIK, begun from these joints."""
    return {
        "ik_request": {
            "group_name": settings.group,
            "robot_state": state_message(joints),
            "avoid_collisions": True,
            "ik_link_name": settings.flange_link,
            "pose_stamped": {"header": {"frame_id": settings.base_frame}, "pose": pose_message(T_base_flange)},
            "timeout": duration_message(settings.call_timeout_s / 2),
        }
    }


def fk_request(settings: RosArmSettings, joints: Mapping[str, float]) -> dict[str, Any]:
    """moveit_msgs/GetPositionFK of the flange."""
    return {
        "header": {"frame_id": settings.base_frame},
        "fk_link_names": [settings.flange_link],
        "robot_state": state_message(joints),
    }


def plan_request(
    settings: RosArmSettings, T_base_flange: RigidTransform, joints: Mapping[str, float]
) -> dict[str, Any]:
    """moveit_msgs/GetMotionPlan from these joints to the flange's pose, as MoveGroupInterface asks for a pose."""
    header = {"frame_id": settings.base_frame}
    pose = pose_message(T_base_flange)
    upright = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    ball = {"type": _SPHERE, "dimensions": [settings.position_tolerance_m]}
    region = {"primitives": [ball], "primitive_poses": [{"position": pose["position"], "orientation": upright}]}
    tolerance = float(np.radians(settings.angle_tolerance_deg))
    place = {"header": header, "link_name": settings.flange_link, "constraint_region": region, "weight": 1.0}
    turn = {"header": header, "link_name": settings.flange_link, "orientation": pose["orientation"], "weight": 1.0}
    turn |= {f"absolute_{axis}_axis_tolerance": tolerance for axis in "xyz"}
    return {
        "motion_plan_request": {
            "start_state": state_message(joints),
            "goal_constraints": [{"position_constraints": [place], "orientation_constraints": [turn]}],
            "pipeline_id": settings.pipeline,
            "planner_id": settings.planner,
            "group_name": settings.group,
            "num_planning_attempts": settings.planning_attempts,
            "allowed_planning_time": settings.planning_time_s,
            "max_velocity_scaling_factor": settings.velocity_scale,
            "max_acceleration_scaling_factor": settings.acceleration_scale,
        }
    }


def scene_request(settings: RosArmSettings, boxes: Sequence[CollisionBox], gone: Sequence[str]) -> dict[str, Any]:
    """moveit_msgs/ApplyPlanningScene: these boxes there, and those of these names away."""
    header = {"frame_id": settings.base_frame}
    upright = pose_message(RigidTransform.identity())
    objects: list[dict[str, Any]] = [{"header": header, "id": name, "operation": _REMOVE} for name in gone]
    for box in boxes:
        solid = {"type": _BOX, "dimensions": [float(side) for side in box.size_m]}
        shape = {"primitives": [solid], "primitive_poses": [upright]}
        objects.append({"header": header, "id": box.name, "pose": pose_message(box.T_base_box)} | shape)
    scene = {"is_diff": True, "robot_state": {"is_diff": True}, "world": {"collision_objects": objects}}
    return {"scene": scene}


@dataclass(frozen=True, eq=False)
class JointWay:
    """A trajectory of joints as MoveIt planned it."""

    message: dict[str, Any]
    """moveit_msgs/RobotTrajectory, which is what is executed."""
    names: tuple[str, ...]
    """Of the joints."""
    positions: Float[np.ndarray, "n j"]
    """Along it [rad, m]."""
    duration_s: float
    """From first to last point [s]."""

    def joints(self, k: int) -> dict[str, float]:
        """Where the joints are at point k."""
        return dict(zip(self.names, self.positions[k].tolist(), strict=True))


def joint_way(message: Json) -> JointWay:
    """A moveit_msgs/RobotTrajectory read; ArmError where nothing that joints can follow is in it."""
    if message.get("multi_dof_joint_trajectory", {}).get("points"):
        raise ArmError(
            "MoveIt plans with joints of several degrees of freedom (a moving base?); name a group of the arm alone"
        )
    try:
        path = message["joint_trajectory"]
        names = tuple(path["joint_names"])
        points = path["points"]
        positions = np.array([point["positions"] for point in points], float).reshape(len(points), len(names))
        times = [point["time_from_start"] for point in points]
        seconds = np.array([time["sec"] + 1e-9 * time["nanosec"] for time in times])
    except (KeyError, TypeError, ValueError) as error:
        raise ArmError(
            f"MoveIt's trajectory cannot be read ({error!r}); check the versions of MoveIt and rosbridge"
        ) from error
    if not names or not len(positions) or not np.isfinite(positions).all() or np.any(np.diff(seconds) < 0):
        raise ArmError("MoveIt's trajectory is empty, not finite or not in order; check the planning pipeline")
    return JointWay(dict(message), names, positions, float(seconds[-1]))


def code_of(answer: Json) -> int:
    """The error code of an answer; ArmError where it has none."""
    try:
        return int(answer["error_code"]["val"])
    except (KeyError, TypeError, ValueError) as error:
        raise ArmError(f"MoveIt's answer has no error code ({error!r}); check its version") from error


def code_words(answer: Json) -> str:
    """The code with its name, and what else MoveIt says."""
    code = code_of(answer)
    said = answer["error_code"].get("message") or answer["error_code"].get("error_message")  # by version, or neither
    return f"{CODE_NAMES.get(code, 'unknown')} {code}" + (f", {in_one_line(said)}" if said else "")


def check_executed(action: str, said: Any, *, refused: bool) -> None:
    """ArmError unless the result of an execution, as roslibpy hands it over, says that the way was gone."""
    values = said.get("values") if isinstance(said, Mapping) else said
    if refused or not isinstance(values, Mapping):
        raise ArmError(f"{action}: was not begun ({in_one_line(values)}); is MoveIt (move_group) running, and free?")
    result = values.get("result", values)  # the first versions of rosbridge wrap it once more
    if code_of(result) != SUCCESS:
        raise ArmError(f"{action}: the arm stopped under way ({code_words(result)}); look at it, and plan anew")
