"""Which calibration of a recording is depth's own, and which cannot be used."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from franbv.adapters.recording.contents import RecordingError
from franbv.adapters.recording.opening import open_recording
from tests.franbv.adapters.recording.bags.bag_writers import (
    DEPTH_TOPIC,
    ROS1,
    ROS2,
    Said,
    camera_info,
    write_rosbag1,
    write_rosbag2,
)
from tests.franbv.adapters.recording.bags.test_reading import CHOICES, INFO, check, frames, stamped, transforms

COLOUR: Said = ("/camera/color/camera_info", camera_info(ROS2, width=640), 0)
INFRARED: Said = ("/camera/infra1/camera_info", camera_info(ROS2, width=640), 0)


def test_calibrations_of_other_streams_are_not_taken(tmp_path: Path):
    """Those of colour and infrared come first in the file and are passed by; without depth's own nothing is read."""
    others = [COLOUR, INFRARED, ("/camera/depth_camera_info", camera_info(ROS2, width=640), 0)]
    check(open_recording(write_rosbag2(tmp_path / "a", [*others, INFO, *stamped(), *frames()]), CHOICES))
    with pytest.raises(RecordingError, match=rf"of {DEPTH_TOPIC}, below /camera/depth/; record it.*{COLOUR[0]}"):
        open_recording(write_rosbag2(tmp_path / "b", [*others, *stamped(), *frames()]), CHOICES)


def test_calibration_of_another_stream_of_librealsense_is_not_taken(tmp_path: Path):
    """Its infrared imager has the depth sensor's name in its own topics, too, and another stream's."""
    sensor = "/device_0/sensor_0"
    info: Said = (f"{sensor}/Infrared_1/info/camera_info", camera_info(ROS1), 1)
    path = write_rosbag1(tmp_path / "a.bag", [info, *frames(ROS1, f"{sensor}/Depth_0/image/data")])
    with pytest.raises(RecordingError, match=f"below {sensor}/Depth_0/; record it"):
        open_recording(path, CHOICES)


@pytest.mark.parametrize(
    ("model", "distortion", "words"),
    [
        ("plumb_bob", (0.1, 0, 0, 0, 0), r"plumb_bob distortion \(0.1, 0, 0, 0, 0\)"),
        ("Brown Conrady", (0, 0, 0, 0, -1e-4), "Brown Conrady distortion"),
        ("rational_polynomial", (0,) * 7 + (float("nan"),), "rational_polynomial distortion"),
        ("equidistant", (0, 0, 0, 0), "equidistant distortion"),
        ("Kannala Brandt4", (0,) * 5, "Kannala Brandt4 distortion"),
    ],
)
@pytest.mark.parametrize("store", [ROS1, ROS2])
def test_distortion_is_refused(tmp_path: Path, store, model: str, distortion: Sequence[float], words: str):
    """Points would lie elsewhere: a pinhole's images are rectified, and a wide lens bends even with zeros."""
    said: list[Said] = [("/camera/depth/camera_info", camera_info(store, model=model, distortion=distortion), 1)]
    said += [*transforms(store), *frames(store)]
    bag = write_rosbag1(tmp_path / "a.bag", said) if store is ROS1 else write_rosbag2(tmp_path / "a", said)
    with pytest.raises(RecordingError, match=f"{words}.*rectify the depth images") as error:
        open_recording(bag, CHOICES)
    assert str(error.value).startswith(f"{bag}: /camera/depth/camera_info has ")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("model", ["", "None", "Inverse Brown Conrady", "rational_polynomial"])
def test_a_model_with_zeros_is_a_pinhole(tmp_path: Path, model: str):
    """As ROS and librealsense write of rectified streams, with as many coefficients as they like."""
    info: Said = (INFO[0], camera_info(ROS2, model=model, distortion=(0.0,) * (8 if model else 0)), 0)
    check(open_recording(write_rosbag2(tmp_path / "a", [info, *stamped(), *frames()]), CHOICES))
