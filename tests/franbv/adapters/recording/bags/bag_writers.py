"""Recordings as ROS and librealsense write them, made with rosbags' own writers."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore
from scipy.spatial.transform import RigidTransform

ROS2, ROS1 = get_typestore(Stores.ROS2_HUMBLE), get_typestore(Stores.ROS1_NOETIC)
ROS1.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
WIDTH, HEIGHT = 12, 8
K = (50.0, 0.0, 5.5, 0.0, 51.0, 3.5, 0.0, 0.0, 1.0)
DEPTH_TOPIC = "/camera/depth/image_rect_raw"
SECOND = 1_000_000_000


def steps(number: int) -> np.ndarray:
    """Frame `number`: depth in millimetres, a hole in it."""
    image = np.random.default_rng(number).integers(200, 900, (HEIGHT, WIDTH)).astype(np.uint16)
    image[2:4, 3:5] = 0
    return image


def header(store: Typestore, time_ns: int, frame: str) -> Any:
    """std_msgs/Header."""
    time = store.types["builtin_interfaces/msg/Time"](sec=time_ns // SECOND, nanosec=time_ns % SECOND)
    more = {"seq": 0} if store is ROS1 else {}
    return store.types["std_msgs/msg/Header"](stamp=time, frame_id=frame, **more)


def image(store: Typestore, number: int, time_ns: int, frame: str = "optical", encoding: str = "16UC1") -> Any:
    """Frame `number` as `image_of` has it."""
    return image_of(store, steps(number), time_ns, frame, encoding)


def image_of(store: Typestore, rows: np.ndarray, time_ns: int, frame: str = "optical", encoding: str = "16UC1") -> Any:
    """sensor_msgs/Image of 16-bit millimetres with four bytes of padding behind every row."""
    height, width = rows.shape
    if encoding == "32FC1":
        rows = np.where(rows, rows / np.float32(1000), np.nan).astype(np.float32)
    padded = np.hstack([rows.view(np.uint8), np.full((height, 4), 7, np.uint8)])
    return store.types["sensor_msgs/msg/Image"](
        header=header(store, time_ns, frame), height=height, width=width, encoding=encoding, is_bigendian=0,
        step=padded.shape[1], data=padded.ravel(),
    )  # fmt: skip


def packed(number: int, time_ns: int, frame: str = "optical") -> Any:
    """sensor_msgs/CompressedImage as compressed_depth_image_transport makes it."""
    data = np.frombuffer(bytes(12) + cv2.imencode(".png", steps(number))[1].tobytes(), np.uint8)
    kind = ROS2.types["sensor_msgs/msg/CompressedImage"]
    return kind(header=header(ROS2, time_ns, frame), format="16UC1; compressedDepth png", data=data)


def camera_info(
    store: Typestore,
    width: int = WIDTH,
    model: str = "plumb_bob",
    distortion: Sequence[float] = (0.0,) * 5,
    height: int = HEIGHT,
    matrix: Sequence[float] = K,
) -> Any:
    """sensor_msgs/CameraInfo."""
    roi = store.types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    names = "DKRP" if store is ROS1 else "dkrp"
    arrays = [np.array(distortion, float), np.array(matrix), np.eye(3).ravel(), np.zeros(12)]
    return store.types["sensor_msgs/msg/CameraInfo"](
        header=header(store, 0, "optical"), height=height, width=width, distortion_model=model, binning_x=0,
        binning_y=0, roi=roi, **dict(zip(names, arrays, strict=True)),
    )  # fmt: skip


def transform(store: Typestore, T: RigidTransform, time_ns: int, parent: str, child: str) -> Any:
    """geometry_msgs/TransformStamped."""
    turn = store.types["geometry_msgs/msg/Quaternion"](*T.rotation.as_quat())
    inner = store.types["geometry_msgs/msg/Transform"](
        translation=store.types["geometry_msgs/msg/Vector3"](*T.translation), rotation=turn
    )
    kind = store.types["geometry_msgs/msg/TransformStamped"]
    return kind(header=header(store, time_ns, parent), child_frame_id=child, transform=inner)


def pose_stamped(T: RigidTransform, time_ns: int) -> Any:
    """geometry_msgs/PoseStamped."""
    at = ROS2.types["geometry_msgs/msg/Point"](*T.translation)
    turn = ROS2.types["geometry_msgs/msg/Quaternion"](*T.rotation.as_quat())
    pose = ROS2.types["geometry_msgs/msg/Pose"](position=at, orientation=turn)
    return ROS2.types["geometry_msgs/msg/PoseStamped"](header=header(ROS2, time_ns, "world"), pose=pose)


def tf(store: Typestore, *transforms: Any) -> Any:
    """tf2_msgs/TFMessage."""
    return store.types["tf2_msgs/msg/TFMessage"](transforms=list(transforms))


Said = tuple[str, Any, int]
"""Topic, message, time [ns]."""


def write_rosbag2(folder: Path, said: Sequence[Said], storage: StoragePlugin = StoragePlugin.SQLITE3) -> Path:
    """The folder of rosbag2."""
    with Writer2(folder, version=9, storage_plugin=storage) as writer:
        connections: dict[str, Any] = {}
        for topic, message, time_ns in said:
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=ROS2)
            writer.write(connections[topic], time_ns, ROS2.serialize_cdr(message, kind))
    return folder


def write_rosbag1(path: Path, said: Sequence[Said], behind: dict[str, bytes] | None = None) -> Path:
    """A .bag; behind: bytes that follow every message of a topic, as librealsense's depth unit does."""
    with Writer1(path) as writer:
        connections: dict[str, Any] = {}
        for topic, message, time_ns in said:
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=ROS1)
            raw = bytes(ROS1.serialize_ros1(message, kind)) + (behind or {}).get(topic, b"")
            writer.write(connections[topic], time_ns, raw)
    return path
