"""Reads depth, poses and options from recordings of ROS and librealsense, without ROS: folders, .db3, .mcap, .bag.

Rules, where a recording leaves it open:
- depth: the one topic of 16-bit or 32-bit depth images, raw or as 16-bit PNG (`compressedDepth`); of several, the one
  that is named. 16-bit depth counts millimetres (REP 118), or what the option `depth_units` says.
- calibration: the CameraInfo of the same stream, never that of colour or infrared, and without distortion.
- time of a frame: that of its metadata (librealsense), else that of its header.
- pose: `franbv.adapters.recording.bags.pose_rules`.
- burst: frames from one place, at least as many as are asked for, and the first of them; shorter runs of frames were
  taken in motion. Where our recording of the same run is given, the frames that it names by their times.
Needs the extra `record`.
"""

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import apsw
import numpy as np
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag1 import ReaderError as Bag1Error
from rosbags.rosbag2 import ReaderError as Bag2Error
from rosbags.typesys import Stores, TypesysError, get_typestore
from scipy.spatial.transform import RigidTransform

from franbv.adapters.recording.bags.choices import BagChoices, Reduce
from franbv.adapters.recording.bags.facts import Facts, facts_of
from franbv.adapters.recording.bags.images import (
    PACKED_DEPTH,
    PACKED_IMAGE,
    RAW_IMAGE,
    depth_frame,
    image_message,
    is_depth,
    stamp_ns,
)
from franbv.adapters.recording.bags.pose_rules import PoseAt, poses_by_rule
from franbv.adapters.recording.bags.timed_poses import one_place
from franbv.adapters.recording.contents import RecordedBurst, Recording, RecordingError, RunFacts
from franbv.adapters.recording.depth_codes import metres
from franbv.adapters.recording.forms import NS_PER_S
from franbv.adapters.recording.mcap_recording import read_recording
from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst

BAG_MEND = "copy it anew, or record again"
MALFORMED_BAG = (
    AnyReaderError, Bag1Error, Bag2Error, TypesysError, apsw.Error, OSError, ValueError, KeyError, IndexError,
    TypeError, AttributeError, OverflowError, EOFError, RuntimeError, MemoryError, AssertionError, struct.error,
)  # fmt: skip
"""What rosbags raises when it takes a damaged file apart, its assertions among it."""


class _Frame(NamedTuple):
    """A frame in the file."""

    stored_ns: int
    """By which the file finds it [ns]."""
    time_ns: int
    """When it was taken [ns]."""
    frame_id: str


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

    def burst(self, wanted: list[_Frame], T_world_cam: RigidTransform) -> DepthBurst:
        """Load these frames."""
        times, found, unit = {frame.stored_ns for frame in wanted}, [], self.unit
        with opened(self.path) as reader:
            connections = [c for c in reader.connections if c.topic == self.topic]
            for c, stored, raw in reader.messages(connections, wanted[0].stored_ns, wanted[-1].stored_ns + 1):
                if stored in times:
                    frame = depth_frame(*image_message(reader, c, raw))
                    if frame.pixels.shape != (self.intrinsics.height, self.intrinsics.width):
                        raise ValueError(f"an image of {frame.pixels.shape[::-1]} px, not as the calibration says")
                    unit = frame.unit or unit
                    found.append(frame.pixels)
            frames = np.stack(found[: len(wanted)])
            if self.reduced is not None:
                if frames.dtype != np.uint16:
                    raise ValueError("32-bit depth, and 16-bit depth alone can be made smaller")
                frames, _ = self.reduced(frames, self.intrinsics)
            return DepthBurst(metres(frames, unit), self.seen, T_world_cam)


def read_bag(path: Path, choices: BagChoices) -> Recording:
    """The recording; RecordingError, one line, where it is damaged or lacks what the rules need."""
    beside = _run_beside(choices)
    with opened(path) as reader:
        depth = _depth_connection(path, reader, choices.depth_topic)
        facts = facts_of(path, reader, depth.topic)
        frames = list(_frames(path, reader, depth, facts))
        pose_at = None if beside is not None else poses_by_rule(path, reader, depth.topic, choices)
    source = _Source(path, depth.topic, facts.intrinsics, facts.depth_unit, choices.reduced)
    if beside is not None:
        return _of_run(source, facts, tuple(_as_taken(source, frames, beside)), beside)
    assert pose_at is not None
    bursts = tuple(_stays(source, frames, pose_at, choices.n_frames))
    if not bursts:
        raise RecordingError(
            f"{path}: nowhere {choices.n_frames} of its {len(frames)} depth frames from one place; ask for fewer frames"
        )
    min_z = facts.min_z if choices.min_z is None else choices.min_z
    unknown = f"{path}: does not say how near the camera measures, so that no pose is too near; give its Min-Z"
    return Recording(
        path=path,
        run=RunFacts(path.stem),
        camera=facts.camera(source.seen, min_z or 0.0),
        bursts=bursts,
        options=facts.options,
        notices=(unknown,) if min_z is None else (),
    )


def _of_run(source: _Source, facts: Facts, bursts: tuple[RecordedBurst, ...], beside: Recording) -> Recording:
    """A camera's own recording of a run of which ours says the rest."""
    camera = facts.camera(source.seen, beside.camera.min_z)
    return replace(beside, path=source.path, camera=camera, bursts=bursts, options=facts.options)


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


def _frames(path: Path, reader: Any, depth: Any, facts: Facts) -> Iterator[_Frame]:
    """The depth frames in the order of the file."""
    before = 0
    for connection, stored, raw in reader.messages([c for c in reader.connections if c.topic == depth.topic]):
        message, _ = image_message(reader, connection, raw)
        time_ns = facts.times_ns.get(stored, stamp_ns(message))
        if time_ns < before:
            raise RecordingError(f"{path}: its frames go back in time, at {time_ns / NS_PER_S:.6f} s; {BAG_MEND}")
        before = time_ns
        yield _Frame(stored, time_ns, message.header.frame_id)


def _stays(source: _Source, frames: list[_Frame], pose_at: PoseAt, n_frames: int) -> Iterator[RecordedBurst]:
    """The first frames of every stay that is long enough; frames without a pose belong to none."""
    stays: list[tuple[RigidTransform, list[_Frame]]] = []
    for frame in frames:
        pose = pose_at(frame.time_ns, frame.frame_id)
        if pose is None:
            continue
        if stays and one_place(stays[-1][0], pose):
            stays[-1][1].append(frame)
        else:
            stays.append((pose, [frame]))
    for pose, stay in stays:
        if len(stay) >= n_frames:
            yield _burst(source, stay[:n_frames], pose, pose, 0.0)


def _as_taken(source: _Source, frames: list[_Frame], beside: Recording) -> Iterator[RecordedBurst]:
    """The very frames of which another recording of the run says that they are its bursts, by their times."""
    by_time = {frame.time_ns: frame for frame in frames}
    for number, burst in enumerate(beside.bursts):
        there = [by_time[time_ns] for time_ns in burst.times_ns if time_ns in by_time]
        if len(there) != burst.n_frames:
            raise RecordingError(
                f"{source.path}: has {len(there)} of the {burst.n_frames} frames of burst {number} of {beside.path}; "
                "give the recording of the same run"
            )
        yield _burst(source, there, burst.T_world_cam, burst.T_asked, burst.motion_s)


def _burst(
    source: _Source, frames: list[_Frame], T_world_cam: RigidTransform, T_asked: RigidTransform, motion_s: float
) -> RecordedBurst:
    times = tuple(frame.time_ns for frame in frames)
    read = partial(source.burst, frames, T_world_cam)
    return RecordedBurst(T_world_cam, T_asked, len(frames), times, motion_s, read)
