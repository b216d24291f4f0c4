"""An arm behind MoveIt: what is asked and what becomes of the answers; every message is held against MoveIt's own.

The stub's kinematics are a closed form, so that every pose has a second source.
"""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.arms.driver import ArmDriver, ArmError
from franbv.adapters.arms.flange_poses import STEP_DEG, STEP_M, flange_poses, pose_distance
from franbv.adapters.arms.moveit_messages import CollisionBox, code_words, joint_way
from franbv.adapters.arms.ros_settings import RosArmSettings
from tests.franbv.adapters.arms.ros_messages import VERSIONS, faults, filled
from tests.franbv.adapters.arms.stub_moveit import AXES, StubMoveIt, forward, pose_json, transform

GOAL = RigidTransform.from_components([0.35, 0.2, 0.3], Rotation.from_euler("ZYX", [0.5, 0.2, 0.0]))
FAR = RigidTransform.from_components([2.0, 0.0, 0.0], Rotation.identity())
SAME = 1e-6
"""Of poses that went through JSON [m, 1]."""


def on() -> bool:
    """Go on."""
    return True


@pytest.mark.parametrize("version", VERSIONS)
def test_there_and_back(opened, version: str):
    """Where it is, whether it can, how it would, and then it is there: in ROS 2 Humble's messages and in later ones."""
    stub = StubMoveIt(version)
    begin = forward(stub.joints)
    arm = opened(stub)
    assert isinstance(arm, ArmDriver)
    assert "arm" in arm.name
    assert stub.url in arm.name
    assert pose_distance(arm.flange_pose(), begin) < (SAME, SAME)
    assert arm.can_reach(GOAL)
    assert not arm.can_reach(FAR)
    path = arm.plan(GOAL)
    assert path is not None
    assert path.duration_s == pytest.approx(stub.duration_s)
    assert stub.ops("send_action_goal") == [], "nothing moves before it is told to"
    arm.execute(path, on)
    assert max(pose_distance(arm.flange_pose(), GOAL)) < SAME
    assert stub.stops == 0
    arm.close()
    assert stub.stops == 1


def test_a_path_shows_where_the_flange_goes(opened):
    """From where it stands to the goal, on the way that the joints go, in steps that pass over nothing."""
    stub = StubMoveIt("humble", points=2)
    arm = opened(stub)
    path = arm.plan(GOAL)
    assert max(pose_distance(path.poses[0], forward(stub.joints))) < SAME
    assert max(pose_distance(path.poses[-1], GOAL)) < SAME
    steps = [pose_distance(a, b) for a, b in zip(path.poses, path.poses[1:], strict=False)]
    assert max(metres for metres, _ in steps) <= STEP_M
    assert max(degrees for _, degrees in steps) <= STEP_DEG
    first, last = stub.joints[:3], GOAL.translation
    for pose in path.poses:  # the three slides go straight
        share = np.dot(pose.translation - first, last - first) / np.dot(last - first, last - first)
        assert np.allclose(pose.translation, first + share * (last - first), atol=SAME)


def test_what_is_asked_of_the_planner(opened):
    """Speed, group, frame, start and goal as they are set; MoveIt's tolerances around the goal."""
    stub = StubMoveIt("later")
    arm = opened(stub, velocity_scale=0.05, acceleration_scale=0.07, pipeline="ompl", planner="RRTConnect")
    arm.plan(GOAL)
    (call,) = [one for one in stub.ops("call_service") if one["service"] == "/plan_kinematic_path"]
    request = call["args"]["motion_plan_request"]
    assert (request["max_velocity_scaling_factor"], request["max_acceleration_scaling_factor"]) == (0.05, 0.07)
    assert (request["group_name"], request["pipeline_id"], request["planner_id"]) == ("arm", "ompl", "RRTConnect")
    start = request["start_state"]["joint_state"]
    assert dict(zip(start["name"], start["position"], strict=True)) == dict(
        zip([*AXES, "finger"], [*stub.joints.tolist(), 0.0], strict=True)
    )
    ((place,), (turn,)) = (
        request["goal_constraints"][0][f"{what}_constraints"] for what in ("position", "orientation")
    )
    assert place["header"]["frame_id"] == turn["header"]["frame_id"] == "base_link"
    assert place["link_name"] == turn["link_name"] == "flange"
    region = place["constraint_region"]
    asked = transform({"position": region["primitive_poses"][0]["position"], "orientation": turn["orientation"]})
    assert max(pose_distance(asked, GOAL)) < SAME
    assert region["primitives"] == [{"type": 2, "dimensions": [1e-4]}]  # shape_msgs/SolidPrimitive SPHERE
    assert turn["absolute_x_axis_tolerance"] == pytest.approx(1e-3, rel=0.05)  # MoveGroupInterface's [rad]


def test_obstacles_come_and_go(opened):
    """Boxes by name; those that are not named again are removed; MoveIt's refusal is told."""
    stub = StubMoveIt("humble")
    arm = opened(stub)
    table = CollisionBox("table", RigidTransform.from_translation([0.0, 0.0, -0.05]), (1.0, 0.8, 0.1))
    part = CollisionBox("part", RigidTransform.from_translation([0.5, 0.0, 0.1]), (0.2, 0.2, 0.2))
    arm.set_obstacles([table, part])
    arm.set_obstacles([table])
    first, second = (one["args"]["scene"] for one in stub.ops("call_service"))
    assert first["is_diff"]
    told = {one["id"]: one for one in first["world"]["collision_objects"]}
    assert set(told) == {"table", "part"}
    assert told["table"]["primitives"] == [{"type": 1, "dimensions": [1.0, 0.8, 0.1]}]  # SolidPrimitive BOX
    assert told["table"]["pose"]["position"] == {"x": 0.0, "y": 0.0, "z": -0.05}
    gone = [one for one in second["world"]["collision_objects"] if one.get("operation") == 1]  # CollisionObject REMOVE
    assert [one["id"] for one in gone] == ["part"]
    with pytest.raises(ArmError, match="two have the same name"):
        arm.set_obstacles([table, table])
    stub.codes["/apply_planning_scene"] = 0
    with pytest.raises(ArmError, match="did not take the obstacles; is base_link"):
        arm.set_obstacles([part])


@pytest.mark.parametrize("code", [-1, -6, -12, -31, 99999])
def test_no_way_is_none(opened, code: int):
    """A planner that finds nothing is no fault: another pose is tried."""
    arm = opened(stub := StubMoveIt("later", codes={"/plan_kinematic_path": code}))
    assert arm.plan(GOAL) is None
    assert stub.stops == 0


@pytest.mark.parametrize("way", ["by another", "after a stop", "moved since"])
def test_only_a_way_that_still_holds_is_gone(opened, way: str):
    """A way is gone only as it was looked at: planned here, not stopped since, from where the arm stands."""
    arm = opened(stub := StubMoveIt("later"))
    path = arm.plan(GOAL)
    if way == "by another":
        path = type(path)(path.poses, path.duration_s)
    elif way == "after a stop":
        arm.stop()
    else:
        stub.joints = stub.joints + 0.02
        while np.abs(arm.flange_pose().translation - stub.joints[:3]).max() > SAME:
            pass
    with pytest.raises(ArmError, match=r"plan anew|was not planned by this arm"):
        arm.execute(path, on)
    assert stub.ops("send_action_goal") == []


def test_settings_are_conservative_and_checked():
    """A tenth of the speed; what cannot be is refused where it is written."""
    settings = RosArmSettings()
    assert (settings.velocity_scale, settings.acceleration_scale) == (0.1, 0.1)
    for wrong in (
        {"velocity_scale": 1.5},
        {"velocity_scale": 0},
        {"url": "10.0.0.2:9090"},
        {"group": ""},
        {"speed": 1},
    ):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            RosArmSettings.model_validate(wrong)


def test_a_jump_is_no_way():
    """Between two neighbouring points the flange jumps, however finely one looks: refused."""

    def forward_with_jump(joints):
        return RigidTransform.from_translation([0.0 if joints[0] < 0.5 else 1.0, 0.0, 0.0])

    with pytest.raises(ArmError, match="jumps by 1000 mm"):
        flange_poses(np.array([[0.0], [1.0]]), forward_with_jump)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"joint_trajectory": {"joint_names": [], "points": []}}, "is empty"),
        ({"multi_dof_joint_trajectory": {"points": [{}]}}, "several degrees of freedom"),
        ({"joint_trajectory": {"joint_names": ["x"], "points": [{"positions": [0.0]}]}}, "cannot be read"),
        ({"joint_trajectory": {"joint_names": ["x", "y"], "points": [{"positions": [0.0]}]}}, "cannot be read"),
    ],
)
def test_a_trajectory_that_is_none(change: dict, words: str):
    """What joints cannot follow is refused before anything moves."""
    with pytest.raises(ArmError, match=words):
        joint_way(change)


def test_codes_are_told_with_their_names():
    """As moveit_msgs/MoveItErrorCodes has them, with what MoveIt says beside."""
    assert code_words({"error_code": {"val": -21}}) == "FRAME_TRANSFORM_FAILURE -21"
    assert (
        code_words({"error_code": {"val": -4, "error_message": "no\ncontroller"}}) == "CONTROL_FAILED -4, no controller"
    )


def test_the_checker_itself_finds_faults():
    """A wrong field, a wrong type, a missing field: each is a fault, and a message that is right has none."""
    pose = pose_json(GOAL)
    kind = "geometry_msgs/msg/Pose"
    assert faults(pose, kind, "humble", complete=True) == []
    assert faults(pose | {"frame": ""}, kind, "humble", complete=False) == [f"{kind}.frame: no such field"]
    assert faults({"position": {"x": "0"}}, kind, "humble", complete=False) == [f"{kind}.position.x: '0' is no float64"]
    assert f"{kind}.orientation: missing" in faults({"position": pose["position"]}, kind, "humble", complete=True)
    goal = {"trajectory": {}, "controller_names": []}
    kind = "moveit_msgs/action/ExecuteTrajectory_Goal"
    assert faults(goal, kind, "later", complete=False) == []
    assert faults(goal, kind, "humble", complete=False) == [f"{kind}.controller_names: no such field"]
    whole = filled({}, "moveit_msgs/srv/GetMotionPlan_Request", "later")
    assert faults(whole, "moveit_msgs/srv/GetMotionPlan_Request", "later", complete=True) == []
