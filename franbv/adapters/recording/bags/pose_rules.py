"""Where the camera of a ROS recording stood: the first that applies of

1. a file of poses, if one is given;
2. a named or the only topic of stamped poses;
3. the chain of transforms from the world frame (named, or the tree's root) to the image's frame. librealsense writes
   the transforms between its own imagers alone, so that its recordings need a file.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from scipy.spatial.transform import RigidTransform

from franbv.adapters.recording.bags.choices import BagChoices
from franbv.adapters.recording.bags.facts import DEVICE
from franbv.adapters.recording.bags.images import stamp_ns
from franbv.adapters.recording.bags.timed_poses import TimedPoses, TransformTree, pose_from_numbers, read_poses
from franbv.adapters.recording.contents import RecordingError

PoseAt = Callable[[int, str], RigidTransform | None]
"""(time [ns], frame of the image) -> T_world_cam; None before anything was said."""
STAMPED = {"geometry_msgs/msg/PoseStamped": "pose", "geometry_msgs/msg/TransformStamped": "transform"}
"""Messages that are a pose with a time, and their field that is the pose."""
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")


def poses_by_rule(path: Path, reader: Any, depth_topic: str, choices: BagChoices) -> PoseAt:
    """What says where the camera stood, by the first rule that applies; RecordingError where none does."""
    if choices.poses is not None:
        listed = read_poses(choices.poses)
        return lambda time_ns, frame: listed.at(time_ns)
    stamped = [c for c in reader.connections if c.msgtype in STAMPED]
    if choices.pose_topic is not None:
        stamped = [c for c in stamped if c.topic == choices.pose_topic]
        if not stamped:
            raise RecordingError(f"{path}: has no topic {choices.pose_topic} of stamped poses; name another")
    if len({c.topic for c in stamped}) == 1:
        said = _stamped_poses(reader, stamped)
        return lambda time_ns, frame: said.at(time_ns)
    if len(stamped) > 1:
        names = ", ".join(sorted({c.topic for c in stamped}))
        raise RecordingError(f"{path}: has several topics of poses; choose one of {names}")
    tree = _tree(reader)
    if not tree.parents or DEVICE.match(depth_topic):
        raise RecordingError(
            f"{path}: does not say where the camera stood; give a file of poses, lines `time x y z qx qy qz qw`"
        )

    def by_transforms(time_ns: int, frame: str) -> RigidTransform | None:
        try:
            return tree.pose(choices.world_frame or tree.root_of(frame), frame, time_ns)
        except ValueError as error:
            raise RecordingError(f"{path}: {error}; name the world frame, or give a file of poses") from error

    return by_transforms


def _stamped_poses(reader: Any, connections: list[Any]) -> TimedPoses:
    poses = TimedPoses()
    for c, _, raw in reader.messages(connections):
        message = reader.deserialize(raw, c.msgtype)
        poses.add(stamp_ns(message), _pose(getattr(message, STAMPED[c.msgtype])))
    return poses


def _tree(reader: Any) -> TransformTree:
    tree = TransformTree()
    connections = [c for c in reader.connections if c.msgtype in TRANSFORMS]
    for c, _, raw in reader.messages(connections) if connections else ():
        for t in reader.deserialize(raw, c.msgtype).transforms:
            is_fixed = c.topic.endswith("tf_static")
            tree.add(t.header.frame_id, t.child_frame_id, stamp_ns(t), _pose(t.transform), is_fixed)
    return tree


def _pose(said: Any) -> RigidTransform:
    """Of a geometry_msgs Pose or Transform."""
    at, turn = (said.position, said.orientation) if hasattr(said, "position") else (said.translation, said.rotation)
    return pose_from_numbers([at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w])
