"""What a ROS or librealsense recording says of its camera: calibration, device, options, times of frames.

librealsense's topics (its src/media/ros/ros_file_format.h): /device_N/info, /device_N/sensor_M/option/NAME/value,
/device_N/sensor_M/STREAM/image/metadata. Its .db3 has text `key=value;...` where its .bag has typed messages.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from franbv.adapters.recording.bags.images import PACKED_DEPTH
from franbv.adapters.recording.contents import CameraFacts, RecordingError
from franbv.adapters.recording.forms import RECTIFY, intrinsics_of, lens_distortion
from franbv.adapters.recording.messages import MOST_SIDE
from franbv.frames import Intrinsics, stereo_min_z

CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
DEVICE = re.compile(r"(?P<device>/device_\d+)(?P<sensor>/sensor_\d+)/(?P<stream>[^/]+)/")
OPTION = re.compile(r"/option/(?P<name>[^/]+)/value$")
MM_PER_M = 1000.0
UNITS_OPTION, BASELINE_OPTION, SHIFT_OPTION = "depth_units", "stereo_baseline", "disparity_shift"
"""Options by librealsense's names; the baseline is in millimetres."""


@dataclass
class Facts:
    """All that was found."""

    intrinsics: Intrinsics
    options: dict[str, float | str] = field(default_factory=dict)
    """Of the sensor that the depth is of, by their names in lower case."""
    model: str | None = None
    serial: str | None = None
    firmware: str | None = None
    times_ns: dict[int, int] = field(default_factory=dict)
    """Time by which the file finds a frame -> when it was taken, where metadata say so [ns]."""

    @property
    def depth_unit(self) -> float | None:
        """Depth of a step [m], None where nothing is said."""
        unit = self.options.get(UNITS_OPTION)
        return unit if isinstance(unit, float) and unit > 0 else None

    @property
    def min_z(self) -> float | None:
        """Smallest Z-depth of a stereo camera [m], None where nothing is said."""
        baseline, shift = self.options.get(BASELINE_OPTION), self.options.get(SHIFT_OPTION, 0.0)
        if not isinstance(baseline, float) or not isinstance(shift, float):
            return None
        if not (np.isfinite(baseline) and baseline != 0 and np.isfinite(shift) and shift >= 0):
            return None
        return stereo_min_z(self.intrinsics.fx * abs(baseline) / MM_PER_M, shift)

    def camera(self, seen: Intrinsics, min_z: float) -> CameraFacts:
        """The camera, with the intrinsics of what the planner sees of it; min_z: see `CameraFacts`."""
        return CameraFacts(seen, min_z, self.depth_unit, self.model, self.serial, self.firmware)


def facts_of(path: Path, reader: Any, depth_topic: str) -> Facts:
    """Read them from an open recording; ValueError or RecordingError where a calibration is none that can be used."""
    facts = Facts(_intrinsics(path, reader, depth_topic))
    place = DEVICE.match(depth_topic)
    wanted = [c for c in reader.connections if _is_fact(c.topic, place)]
    for connection, time_ns, raw in _messages(reader, wanted):
        pairs = _pairs(reader.deserialize(raw, connection.msgtype))
        if connection.topic.endswith("/image/metadata"):
            if "timestamp" in pairs:
                facts.times_ns[time_ns] = round(float(pairs["timestamp"]) * 1e6)  # from milliseconds
        elif option := OPTION.search(connection.topic):
            facts.options[option["name"].lower().replace(" ", "_")] = _number(pairs.get("", ""))
        else:
            facts.model = pairs.get("Name", facts.model)
            facts.serial = pairs.get("Serial Number", facts.serial)
            facts.firmware = pairs.get("Firmware Version", facts.firmware)
    return facts


def _is_fact(topic: str, place: re.Match[str] | None) -> bool:
    if place is None:
        return False
    sensor = place["device"] + place["sensor"]
    stream = f"{sensor}/{place['stream']}"
    is_option = topic.startswith(f"{sensor}/option/") and OPTION.search(topic) is not None
    return is_option or topic in (f"{place['device']}/info", f"{stream}/image/metadata")


def _intrinsics(path: Path, reader: Any, depth_topic: str) -> Intrinsics:
    """Of the depth images' own calibration; RecordingError where there is none, or it is no pinhole's."""
    own = _calibration(path, [c for c in reader.connections if c.msgtype == CAMERA_INFO], depth_topic)
    for connection, _, raw in _messages(reader, [own]):
        said = reader.deserialize(raw, connection.msgtype)
        if not (0 < said.width <= MOST_SIDE and 0 < said.height <= MOST_SIDE):
            raise ValueError(f"{own.topic} is of {said.width} x {said.height} px")
        K, D = (said.K, said.D) if hasattr(said, "K") else (said.k, said.d)
        lens = lens_distortion(said.distortion_model, D)
        if lens is not None:
            raise RecordingError(f"{path}: {own.topic} has {lens}: {RECTIFY}")
        return intrinsics_of(said.width, said.height, K)
    raise RecordingError(f"{path}: holds no calibration, and {own.topic} is empty; record it, too")


def _calibration(path: Path, calibrations: list[Any], depth_topic: str) -> Any:
    """The connection that calibrates the stream of the depth images.

    librealsense keeps it below the stream's own name; ROS beside the images, and as `camera_info` where several are
    there (image_transport, `getCameraInfoTopic`). Those of colour and infrared stand elsewhere.
    """
    place = DEVICE.match(depth_topic)
    namespace = depth_topic.removesuffix(f"/{PACKED_DEPTH}").rpartition("/")[0]
    below = place[0] if place else f"{namespace}/"
    own = [c for c in calibrations if c.topic.startswith(below) and (place or "/" not in c.topic.removeprefix(below))]
    named = [c for c in own if c.topic.endswith("/camera_info")] if len({c.topic for c in own}) > 1 else own
    if not named:
        others = ", ".join(sorted({c.topic for c in calibrations})) or "none"
        raise RecordingError(
            f"{path}: holds no calibration (sensor_msgs/CameraInfo) of {depth_topic}, below {below}; record it, too; "
            f"its calibrations are: {others}"
        )
    return named[0]


def _messages(reader: Any, connections: list[Any]) -> Iterator[tuple[Any, int, bytes]]:
    """Of these connections alone; rosbags takes none for all."""
    return reader.messages(connections) if connections else iter(())


def _pairs(message: Any) -> dict[str, str]:
    """Keys and values of a message; the key of a lone value is empty."""
    if hasattr(message, "key"):
        return {message.key: message.value}
    text = str(message.data)
    if "=" not in text:
        return {"": text}
    return dict(part.split("=", 1) for part in text.split(";") if "=" in part)


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
