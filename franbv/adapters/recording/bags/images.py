"""Depth images of ROS messages: raw or as PNG, of ROS 1 and 2, and of librealsense, whose .bag adds a number."""

import struct
from typing import Any, NamedTuple

import numpy as np

from franbv.adapters.recording.bags.png_image import png_image
from franbv.adapters.recording.depth_codes import METRES_32, PIXEL_TYPES, STEPS_16
from franbv.adapters.recording.forms import NS_PER_S
from franbv.adapters.recording.messages import MOST_SIDE

RAW_IMAGE, PACKED_IMAGE = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
CODINGS = {"16UC1": STEPS_16, "mono16": STEPS_16, "Z16": STEPS_16, "z16": STEPS_16, "32FC1": METRES_32}
"""Depth by the names that ROS and librealsense have for it."""
PACKED_DEPTH = "compressedDepth"
"""What compressed_depth_image_transport and librealsense call a PNG behind a head of PACKED_HEAD bytes."""
PACKED_HEAD = 12
"""Kind and two parameters, which matter to 32-bit depth alone [bytes]."""
MARK_OF_UNIT, UNIT_BEHIND = "1", struct.Struct("<f")
"""librealsense's .bag: where a header's frame has this name, the depth unit [m] follows the image, beyond its type
(its third-party/realsense-file/rosbag/msgs/sensor_msgs/Image.h)."""


class DepthFrame(NamedTuple):
    """A depth image of a recording."""

    pixels: np.ndarray
    """(h, w), uint16 steps or float32 [m]."""
    frame_id: str
    stamp_ns: int
    """Of its header [ns]."""
    unit: float | None
    """Depth of a step as the message itself states it [m]."""


def image_message(reader: Any, connection: Any, raw: bytes) -> tuple[Any, float | None]:
    """The message, and the depth unit behind it [m], if there is one."""
    if not reader.is2 and connection.msgtype == RAW_IMAGE and _is_marked(raw):
        unit = UNIT_BEHIND.unpack(raw[-UNIT_BEHIND.size :])[0]
        return reader.deserialize(raw[: -UNIT_BEHIND.size], connection.msgtype), unit or None
    return reader.deserialize(raw, connection.msgtype), None


def _is_marked(raw: bytes) -> bool:
    """ROS 1: sequence number, two numbers of time, then the frame's name with its length."""
    length = struct.unpack_from("<I", raw, 12)[0]
    return length == len(MARK_OF_UNIT) and raw[16 : 16 + length] == MARK_OF_UNIT.encode()


def is_depth(message: Any) -> bool:
    """Whether the message is an image of depth."""
    return PACKED_DEPTH in message.format if hasattr(message, "format") else message.encoding in CODINGS


def stamp_ns(message: Any) -> int:
    """Time of the message's header [ns]."""
    return message.header.stamp.sec * NS_PER_S + message.header.stamp.nanosec


def depth_frame(message: Any, unit: float | None) -> DepthFrame:
    """The message's image; ValueError where it is damaged or of another kind."""
    if not is_depth(message):
        raise ValueError(f"an image of {getattr(message, 'format', None) or message.encoding}, which is no depth")
    pixels = _unpacked(message) if hasattr(message, "format") else _raw(message)
    return DepthFrame(pixels, message.header.frame_id, stamp_ns(message), unit)


def _raw(message: Any) -> np.ndarray:
    kind = PIXEL_TYPES[CODINGS[message.encoding]].newbyteorder(">" if message.is_bigendian else "<")
    width, height, step = message.width, message.height, message.step
    data = np.asarray(message.data, np.uint8)
    if not (0 < width <= MOST_SIDE and 0 < height <= MOST_SIDE and step >= width * kind.itemsize):
        raise ValueError(f"an image of {width} x {height} px in rows of {step} bytes")
    if data.size != step * height:
        raise ValueError(f"an image of {data.size} bytes in {height} rows of {step}")
    rows = data.reshape(height, step)[:, : width * kind.itemsize]
    return np.ascontiguousarray(rows).view(kind).astype(kind.newbyteorder("="))


def _unpacked(message: Any) -> np.ndarray:
    pixels = png_image(np.asarray(message.data, np.uint8)[PACKED_HEAD:].tobytes())
    if pixels.dtype != np.uint16 or not message.format.startswith("16UC1"):
        raise ValueError(f"an image of {message.format}; 16-bit depth can be read")
    return pixels
