"""Reads depth, poses and options from recordings of ROS and librealsense, without ROS: folders, .db3, .mcap, .bag.

Rules, where a recording leaves it open:
- depth: the one topic of 16-bit or 32-bit depth images, raw or as 16-bit PNG (`compressedDepth`); of several, the one
  that is named. 16-bit depth counts millimetres (REP 118), or what the option `depth_units` says.
- time of a frame: that of its metadata (librealsense), else that of its header.
- pose: a file of poses if one is given; else a named or the only topic of stamped poses; else the chain of transforms
  from the world frame (named, or the tree's root) to the image's frame. librealsense writes the transforms between its
  own imagers alone, so that its recordings need a file.
- burst: frames from one place, at least as many as are asked for, and the first of them; shorter runs of frames were
  taken in motion.
Needs the extra `record`.
"""

import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import apsw
import numpy as np
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag1 import ReaderError as Bag1Error
from rosbags.rosbag2 import ReaderError as Bag2Error
from rosbags.typesys import Stores, TypesysError, get_typestore
from scipy.spatial.transform import RigidTransform

from franbv.adapters.recording.bag_choices import BagChoices, Reduce
from franbv.adapters.recording.bag_facts import DEVICE, Facts, facts_of
from franbv.adapters.recording.bag_images import (
    PACKED_DEPTH,
    PACKED_IMAGE,
    RAW_IMAGE,
    depth_frame,
    image_message,
    is_depth,
    stamp_ns,
)
from franbv.adapters.recording.contents import CameraFacts, RecordedBurst, Recording, RecordingError, RunFacts
from franbv.adapters.recording.depth_codes import metres
from franbv.adapters.recording.mcap_recording import read_recording
from franbv.adapters.recording.poses import TimedPoses, TransformTree, one_place, pose_from_numbers, read_poses
from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst

STAMPED = {"geometry_msgs/msg/PoseStamped": "pose", "geometry_msgs/msg/TransformStamped": "transform"}
"""Messages that are a pose with a time, and their field that is the pose."""
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
BAG_MEND = "copy it anew, or record again"
MALFORMED_BAG = (
    AnyReaderError, Bag1Error, Bag2Error, TypesysError, apsw.Error, OSError, ValueError, KeyError, IndexError,
    TypeError, AttributeError, OverflowError, EOFError, RuntimeError, MemoryError, AssertionError, struct.error,
)  # fmt: skip
"""What rosbags raises when it takes a damaged file apart, its assertions among it."""


@dataclass(frozen=True, eq=False)
class _Shot:
    """A frame in the file."""

    stored_ns: int
    """By which the file finds it [ns]."""
    time_ns: int
    """When it was taken [ns]."""
    pose: RigidTransform


@dataclass(frozen=True, eq=False)
class _Source:
    """Where the frames are."""

    path: Path
    topic: str
    intrinsics: Intrinsics
    unit: float | None
    """Depth of one step [m]."""
    reduced: Reduce | None

    @property
    def seen(self) -> Intrinsics:
        """Intrinsics of what the planner sees."""
        if self.reduced is None:
            return self.intrinsics
        return self.reduced(np.zeros((1, self.intrinsics.height, self.intrinsics.width), np.uint16), self.intrinsics)[1]

    def burst(self, shots: list[_Shot]) -> DepthBurst:
        """Load these frames."""
        wanted, found, unit = {shot.stored_ns for shot in shots}, [], self.unit
        with opened(self.path) as reader:
            connections = [c for c in reader.connections if c.topic == self.topic]
            for c, stored, raw in reader.messages(connections, shots[0].stored_ns, shots[-1].stored_ns + 1):
                if stored in wanted:
                    frame = depth_frame(*image_message(reader, c, raw))
                    if frame.pixels.shape != (self.intrinsics.height, self.intrinsics.width):
                        raise ValueError(f"an image of {frame.pixels.shape[::-1]} px, not as the calibration says")
                    unit = frame.unit or unit
                    found.append(frame.pixels)
            frames = np.stack(found[: len(shots)])
            if self.reduced is not None:
                if frames.dtype != np.uint16:
                    raise ValueError("32-bit depth, and 16-bit depth alone can be made smaller")
                frames, _ = self.reduced(frames, self.intrinsics)
            return DepthBurst(metres(frames, unit), self.seen, shots[0].pose)


def read_bag(path: Path, choices: BagChoices) -> Recording:
    """The recording; RecordingError, one line, where it is damaged or lacks what the rules need."""
    with opened(path) as reader:
        depth = _depth_connection(path, reader, choices.depth_topic)
        facts = facts_of(reader, depth.topic)
        if facts.intrinsics is None:
            raise RecordingError(f"{path}: holds no calibration (sensor_msgs/CameraInfo); record it, too")
        shots = list(_shots(path, reader, depth, facts, choices))
    source = _Source(path, depth.topic, facts.intrinsics, facts.depth_unit, choices.reduced)
    bursts = tuple(_bursts(source, shots, choices.n_frames))
    if not bursts:
        raise RecordingError(
            f"{path}: nowhere {choices.n_frames} of its {len(shots)} depth frames from one place; ask for fewer frames"
        )
    min_z = facts.min_z if choices.min_z is None else choices.min_z
    unknown = f"{path}: does not say how near the camera measures, so that no pose is too near; give its Min-Z"
    camera = CameraFacts(source.seen, min_z or 0.0, facts.depth_unit, facts.model, facts.serial, facts.firmware)
    notices = (unknown,) if min_z is None else ()
    recording = Recording(path, RunFacts(path.stem), camera, bursts, options=facts.options, notices=notices)
    beside = _run_beside(choices)
    if beside is None:
        return recording
    camera = replace(camera, min_z=beside.camera.min_z if choices.min_z is None else choices.min_z)
    said = {"run": beside.run, "decisions": beside.decisions, "stop": beside.stop, "reachability": beside.reachability}
    return replace(recording, camera=camera, notices=beside.notices, **said)


def _run_beside(choices: BagChoices) -> Recording | None:
    """The recording of ours that gives the poses, if it is one that does."""
    is_recording = choices.poses is not None and choices.poses.suffix == ".mcap"
    return read_recording(choices.poses) if choices.poses is not None and is_recording else None


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """The recording, to be read by rosbags; RecordingError for all that is wrong with the file."""
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:
            yield reader
    except RecordingError:
        raise
    except MALFORMED_BAG as error:
        words = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        raise RecordingError(f"{path}: cannot be read ({words}); {BAG_MEND}") from error


def _depth_connection(path: Path, reader: Any, named: str | None) -> Any:
    """The connection of the depth images."""
    images = [c for c in reader.connections if c.msgtype in (RAW_IMAGE, PACKED_IMAGE)]
    found = [c for c in images if c.topic == named] if named else [c for c in images if _first_is_depth(reader, c)]
    names = ", ".join(sorted(c.topic for c in (images if named or not found else found))) or "none"
    if len({c.topic for c in found}) == 1:
        return found[0]
    if named or not found:
        wanted = f"topic {named}" if named else "topic of depth images"
        raise RecordingError(f"{path}: has no {wanted}; its topics of images are: {names}")
    raise RecordingError(f"{path}: has several topics of depth; choose one of {names}")


def _first_is_depth(reader: Any, connection: Any) -> bool:
    if connection.msgtype == PACKED_IMAGE and not connection.topic.endswith(PACKED_DEPTH):
        return False
    for c, _, raw in reader.messages([connection]):
        return is_depth(image_message(reader, c, raw)[0])
    return False


def _shots(path: Path, reader: Any, depth: Any, facts: Facts, choices: BagChoices) -> Iterator[_Shot]:
    """Frames whose pose is known, in the order of the file."""
    pose_at = _poses(path, reader, depth.topic, choices)
    before = 0
    for connection, stored, raw in reader.messages([c for c in reader.connections if c.topic == depth.topic]):
        message, _ = image_message(reader, connection, raw)
        time_ns = facts.times_ns.get(stored, stamp_ns(message))
        if time_ns < before:
            raise RecordingError(f"{path}: its frames go back in time, at {time_ns / 1e9:.6f} s; {BAG_MEND}")
        before = time_ns
        pose = pose_at(time_ns, message.header.frame_id)
        if pose is not None:
            yield _Shot(stored, time_ns, pose)


def _poses(
    path: Path, reader: Any, depth_topic: str, choices: BagChoices
) -> Callable[[int, str], RigidTransform | None]:
    """(time [ns], frame of the image) -> T_world_cam, by the first rule that applies."""
    if choices.poses is not None:
        beside = _run_beside(choices)
        listed = read_poses(choices.poses) if beside is None else TimedPoses()
        for burst in beside.bursts if beside else ():
            listed.add(burst.times_ns[0], burst.T_world_cam)
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


def _bursts(source: _Source, shots: list[_Shot], n_frames: int) -> Iterator[RecordedBurst]:
    """The first frames of every stay that is long enough."""
    stays: list[list[_Shot]] = []
    for shot in shots:
        if stays and one_place(stays[-1][0].pose, shot.pose):
            stays[-1].append(shot)
        else:
            stays.append([shot])
    for stay in stays:
        if len(stay) >= n_frames:
            yield _burst(source, stay[:n_frames])


def _burst(source: _Source, shots: list[_Shot]) -> RecordedBurst:
    pose, times = shots[0].pose, tuple(shot.time_ns for shot in shots)
    return RecordedBurst(pose, pose, len(shots), times, 0.0, lambda: source.burst(shots))
