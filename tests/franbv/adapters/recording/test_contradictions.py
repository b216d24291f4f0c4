"""Recordings whose bytes are whole and whose messages contradict each other: one line that names message and reason."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from franbv.adapters.recording.contents import RecordingError
from franbv.adapters.recording.mcap_recording import read_recording
from franbv.adapters.recording.topics import PROFILE

Messages = list[tuple[str, dict[str, Any]]]
HEADER, INFO, DEPTH, BURST = "/recording/header", "/camera/depth/camera_info", "/camera/depth/image", "/camera/burst"
INFRARED, ASKED, DECISION = "/camera/infrared/image", "/arm/reachability", "/planner/decision"


def messages_in(path: Path) -> Messages:
    """Topics and messages, in the order of the file."""
    with path.open("rb") as file:
        found = make_reader(file).iter_messages(log_time_order=False)
        return [(channel.topic, json.loads(message.data)) for _, channel, message in found]


def write(path: Path, messages: Messages, compression: CompressionType = CompressionType.ZSTD) -> Path:
    """A whole file of these."""
    with path.open("wb") as file:
        writer = Writer(file, compression=compression, enable_data_crcs=True)
        writer.start(PROFILE)
        schema = writer.register_schema("any", "jsonschema", b"{}")
        channels = {topic: writer.register_channel(topic, "json", schema) for topic in dict(messages)}
        for topic, message in messages:
            writer.add_message(channels[topic], 0, json.dumps(message).encode(), 0)
        writer.finish()
    return path


def changed(topic: str, **fields: Any) -> Callable[[Messages], Messages]:
    """The first message of the topic with other fields."""

    def change(messages: Messages) -> Messages:
        k = [name for name, _ in messages].index(topic)
        return [*messages[:k], (topic, messages[k][1] | fields), *messages[k + 1 :]]

    return change


def without(topic: str) -> Callable[[Messages], Messages]:
    """All but the first message of the topic."""

    def leave_out(messages: Messages) -> Messages:
        k = [name for name, _ in messages].index(topic)
        return messages[:k] + messages[k + 1 :]

    return leave_out


def only(*topics: str) -> Callable[[Messages], Messages]:
    """Messages of these topics."""
    return lambda messages: [message for message in messages if message[0] in topics]


SKEW = [[1.0, 0.1, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda messages: [messages[0], *messages], "it is the second one"),
        (without(HEADER), "it comes before the header"),
        (only(HEADER), "ends before its header"),
        (only(HEADER, INFO), "holds no whole burst"),
        (without(INFO), "it comes before the calibration"),
        (changed(HEADER, format=99), "has format 99, and this version reads 1"),
        (changed(HEADER, surprise=1), "surprise: Extra inputs"),
        (changed(HEADER, min_z=-1.0), "min_z: Input should be greater"),
        (changed(INFO, K=[0.0] * 9), "focal lengths 0 and 0 px"),
        (changed(INFO, D=[0.0, 0.0, 0.01, 0.0, 0.0]), f"{INFO} has plumb_bob distortion .*; rectify the depth images"),
        (changed(INFO, distortion_model="equidistant"), f"{INFO} has equidistant distortion .*; rectify"),
        (changed(INFO, width=61), "an image of 60 x 40 px, not as the calibration says"),
        (changed(DEPTH, width=10**9), "width: Input should be less"),
        (changed(DEPTH, data="AAAA"), "3 bytes are no 16UC1 image of 60 x 40 pixels"),
        (changed(DEPTH, data="*"), "cannot be used"),
        (changed(BURST, index=5), "it is burst 5 where 0 should stand"),
        (changed(BURST, n_frames=2), "it has 3 of 2 frames"),
        (changed(BURST, infrared=False), "it has 1 infrared images of 0"),
        (changed(BURST, T_world_cam=SKEW), "a pose is no rotation"),
        (changed(BURST, T_world_cam=[[1.0]]), "T_world_cam.0"),
        (changed(ASKED, reachable=[True, False, True]), "as many answers as questions"),
        (changed(DECISION, index=1), "it is about burst 1 where 0 should stand"),
        (changed(DECISION, kind="guess"), "kind: Input should be"),
    ],
)
def test_a_contradiction_is_named(recorded, tmp_path: Path, change: Callable[[Messages], Messages], words: str):
    """With every checksum right: the reader looks at what is said."""
    path = write(tmp_path / "a.mcap", change(messages_in(recorded.path)))
    with pytest.raises(RecordingError, match=words) as error:
        read_recording(path)
    assert str(error.value).startswith(f"{path}: ")


def test_other_writers_of_the_format_are_read(recorded, tmp_path: Path):
    """The same messages in one chunk, packed or not, are the same recording; what is packed otherwise is refused."""
    messages = messages_in(recorded.path)
    for compression in (CompressionType.ZSTD, CompressionType.NONE):
        found = read_recording(write(tmp_path / "a.mcap", messages, compression))
        assert len(found.bursts) == len(recorded.run.acquisitions)
        assert (found.bursts[-1].read().depths == recorded.run.acquisitions[-1].burst.depths).all()
    with pytest.raises(RecordingError, match="compression 'lz4', which is unknown"):
        read_recording(write(tmp_path / "b.mcap", messages, CompressionType.LZ4))


def test_a_recording_that_changes_while_it_is_used_is_refused(recorded, tmp_path: Path):
    """Images are loaded when they are asked for: then the chunk must still be what it was."""
    path = tmp_path / "a.mcap"
    path.write_bytes(recorded.path.read_bytes())
    found = read_recording(path)
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(RecordingError, match="the chunk that was there is gone"):
        found.bursts[-1].read()
