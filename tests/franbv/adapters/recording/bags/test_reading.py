"""Recordings of ROS 1, ROS 2 and librealsense: depth to the bit, poses by the stated rules, options as set."""

import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.recording.bags.choices import BagChoices
from franbv.adapters.recording.bags.reading import read_bag
from franbv.adapters.recording.contents import Recording, RecordingError
from franbv.adapters.recording.opening import open_recording
from franbv.adapters.recording.replay import replay
from franbv.adapters.recording.watched import Watch
from franbv.adapters.recording.writer import RecordingWriter
from franbv.frames import Intrinsics
from franbv.planners import fra
from franbv.reconstruction import reconstruct
from tests.franbv.adapters.recording.bags.bag_writers import (
    DEPTH_TOPIC,
    HEIGHT,
    ROS1,
    ROS2,
    SECOND,
    WIDTH,
    Said,
    camera_info,
    image,
    packed,
    pose_stamped,
    steps,
    tf,
    transform,
    write_rosbag1,
    write_rosbag2,
)
from tests.franbv.adapters.recording.recorded_run import CAMERA, PARAMETERS, RUN, SEED, UNIT, camera
from tests.franbv.analytic_camera import SENSOR, FreeArm

POSES = [
    RigidTransform.from_components([0.1 * k, 0.2, 0.3], Rotation.from_euler("xyz", [180 + 5 * k, 10, 20], degrees=True))
    for k in range(3)
]
"""Where the camera stands, three frames at each."""
MOUNT = RigidTransform.from_components([0.0, 0.01, 0.02], Rotation.from_euler("z", 90, degrees=True))
"""Of the camera on the flange."""
CHOICES = BagChoices(n_frames=3)
INFO: Said = ("/camera/depth/camera_info", camera_info(ROS2), 0)
SAME_POSE = 1e-12
"""What is left of a pose after a quaternion and two products, with numbers below 1."""


def frames(store=ROS2, topic: str = DEPTH_TOPIC, **kind) -> list[Said]:
    """Nine frames, one a second from 1 s on."""
    return [(topic, image(store, k, (k + 1) * SECOND, **kind), (k + 1) * SECOND) for k in range(9)]


def stamped() -> list[Said]:
    """Three poses, at 1, 4 and 7 s."""
    return [("/pose", pose_stamped(T, (3 * k + 1) * SECOND), (3 * k + 1) * SECOND) for k, T in enumerate(POSES)]


def transforms(store=ROS2) -> list[Said]:
    """The flange in the world at 1, 4 and 7 s, and the camera on the flange for good."""
    fixed = ("/tf_static", tf(store, transform(store, MOUNT, 0, "flange", "optical")), 0)
    moves = [
        ("/tf", tf(store, transform(store, T * MOUNT.inv(), t, "world", "flange")), t)
        for t, T in zip([SECOND, 4 * SECOND, 7 * SECOND], POSES, strict=True)
    ]
    return [fixed, *moves]


def check(found: Recording, in_steps: bool = True) -> None:
    """Three bursts of three frames, at the poses, in metres, holes 0; in_steps: depth was coded in millimetres."""
    assert found.camera.intrinsics == Intrinsics(WIDTH, HEIGHT, 50.0, 51.0, 5.5, 3.5)
    assert len(found.bursts) == 3
    for k, (burst, pose) in enumerate(zip(found.bursts, POSES, strict=True)):
        millimetres = np.stack([steps(3 * k + i) for i in range(3)])
        expected = millimetres * np.float32(0.001) if in_steps else millimetres / np.float32(1000)
        assert np.array_equal(burst.read().depths, expected)
        np.testing.assert_allclose(burst.T_world_cam.as_matrix(), pose.as_matrix(), atol=SAME_POSE)
        assert burst.times_ns == tuple((3 * k + i + 1) * SECOND for i in range(3))


@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
@pytest.mark.parametrize("said", [stamped, transforms])
def test_rosbag2(tmp_path: Path, storage: StoragePlugin, said):
    """Both storages, as a folder and as the lone file in it; poses by topic and by transforms."""
    folder = write_rosbag2(tmp_path / "bag", [INFO, *said(), *frames()], storage)
    check(open_recording(folder, CHOICES))
    lone = next(path for path in folder.iterdir() if path.suffix in (".db3", ".mcap"))
    check(open_recording(lone, CHOICES))


def test_rosbag1(tmp_path: Path):
    """The same of ROS 1, whose fields have other names."""
    info: Said = ("/camera/depth/camera_info", camera_info(ROS1), 1)
    path = write_rosbag1(tmp_path / "a.bag", [info, *transforms(ROS1), *frames(ROS1)])
    check(open_recording(path, CHOICES))


def test_other_codings_of_depth(tmp_path: Path):
    """32-bit metres with NaN for holes (REP 118), 16-bit PNG with the transport's head: the same depth."""
    metres = write_rosbag2(tmp_path / "a", [INFO, *stamped(), *frames(encoding="32FC1")])
    check(open_recording(metres, CHOICES), in_steps=False)
    topic = f"{DEPTH_TOPIC}/compressedDepth"
    images = [(topic, packed(k, (k + 1) * SECOND), (k + 1) * SECOND) for k in range(9)]
    check(open_recording(write_rosbag2(tmp_path / "b", [INFO, *stamped(), *images]), CHOICES))


def test_poses_of_a_file(tmp_path: Path):
    """Lines of time, position and quaternion go before whatever the recording says; a comment is none."""
    bag = write_rosbag2(tmp_path / "bag", [INFO, *frames()])
    lines = [
        f"{3 * k + 1} {' '.join(map(repr, [*T.translation.tolist(), *T.rotation.as_quat().tolist()]))}  # view {k}"
        for k, T in enumerate(POSES)
    ]
    poses = tmp_path / "poses.txt"
    poses.write_text("# time x y z qx qy qz qw\n" + "\n".join(lines))
    check(open_recording(bag, replace(CHOICES, poses=poses)))
    poses.write_text("1 0 0 0 0 0 0 2\n")
    with pytest.raises(RecordingError, match="line 1 is no pose"):
        open_recording(bag, replace(CHOICES, poses=poses))


def test_frames_in_motion_are_left_out(tmp_path: Path):
    """A pose that holds for two frames is no burst of three; more frames than three are more than are asked for."""
    moving = [
        ("/pose", pose_stamped(T, t * SECOND), t * SECOND) for t, T in zip([1, 3, 7], POSES, strict=True)
    ]  # two frames, four, three
    found = open_recording(write_rosbag2(tmp_path / "bag", [INFO, *moving, *frames()]), CHOICES)
    assert [burst.times_ns[0] // SECOND for burst in found.bursts] == [3, 7]
    assert [burst.n_frames for burst in found.bursts] == [3, 3]
    with pytest.raises(RecordingError, match="nowhere 5 of its 9 depth frames from one place"):
        open_recording(tmp_path / "bag", BagChoices(n_frames=5))


def test_frames_before_the_first_pose_are_left_out(tmp_path: Path):
    """Nobody knows where they were taken."""
    late = [("/pose", pose_stamped(POSES[1], 4 * SECOND), 4 * SECOND)]
    found = open_recording(write_rosbag2(tmp_path / "bag", [INFO, *late, *frames()]), CHOICES)
    assert [burst.times_ns[0] // SECOND for burst in found.bursts] == [4]


def test_depth_is_made_smaller_as_asked(tmp_path: Path):
    """The frames go through what whoever reads them gives, with their intrinsics."""

    def every_other(frames, intrinsics):
        i = intrinsics
        return frames[:, ::2, ::2], Intrinsics(i.width // 2, i.height // 2, i.fx / 2, i.fy / 2, i.cx / 2, i.cy / 2)

    folder = write_rosbag2(tmp_path / "bag", [INFO, *stamped(), *frames()])
    found = open_recording(folder, replace(CHOICES, reduced=every_other))
    assert found.camera.intrinsics == Intrinsics(6, 4, 25.0, 25.5, 2.75, 1.75)
    assert np.array_equal(found.bursts[0].read().depths[0], steps(0)[::2, ::2] * np.float32(0.001))


OTHER = "/other/depth/image"


@pytest.mark.parametrize(
    ("said", "choices", "words"),
    [
        ([INFO, *stamped()], CHOICES, "has no topic of depth images"),
        ([*stamped(), *frames()], CHOICES, "holds no calibration"),
        ([INFO, *frames()], CHOICES, "does not say where the camera stood"),
        ([INFO, *stamped(), *frames(), *frames(topic=OTHER)], CHOICES, f"choose one of {DEPTH_TOPIC}, {OTHER}"),
        ([INFO, *stamped(), *frames()], BagChoices(3, depth_topic="/none"), "has no topic /none"),
        ([INFO, *stamped(), *frames()], BagChoices(3, pose_topic="/none"), "has no topic /none of stamped poses"),
        ([INFO, *transforms(), *frames()], BagChoices(3, world_frame="moon"), "no transform leads from moon"),
        ([INFO, *transforms(), *frames(frame="lens")], BagChoices(3, world_frame="world"), "from world to lens"),
    ],
)  # fmt: skip
def test_what_is_missing_is_named(tmp_path: Path, said: list[Said], choices: BagChoices, words: str):
    """One line that names the file and what to do."""
    folder = write_rosbag2(tmp_path / "bag", said)
    with pytest.raises(RecordingError, match=words) as error:
        open_recording(folder, choices)
    assert str(folder) in str(error.value)
    assert "\n" not in str(error.value)


def test_images_of_another_size_than_the_calibration_are_refused(tmp_path: Path):
    """Points would lie elsewhere."""
    info: Said = ("/camera/depth/camera_info", camera_info(ROS2, width=2 * WIDTH), 0)
    found = open_recording(write_rosbag2(tmp_path / "bag", [info, *stamped(), *frames()]), CHOICES)
    with pytest.raises(RecordingError, match="not as the calibration says"):
        found.bursts[0].read()


def test_frames_that_go_back_in_time_are_refused(tmp_path: Path):
    """Bursts could be told from nothing."""
    turned = [(DEPTH_TOPIC, image(ROS2, k, (9 - k) * SECOND), (k + 1) * SECOND) for k in range(3)]
    with pytest.raises(RecordingError, match="go back in time"):
        open_recording(write_rosbag2(tmp_path / "bag", [INFO, *stamped(), *turned]), CHOICES)


def test_legacy_bag_of_librealsense(tmp_path: Path):
    """librealsense's .bag: `mono16`, the frame named 1 and a depth unit behind every image, options as Float32.

    Layout: its ros_file_format.h, ros_writer.cpp and sensor_msgs/Image.h.
    """
    stream = "/device_0/sensor_0/Depth_0"
    value, pair = ROS1.types["std_msgs/msg/Float32"], ROS1.types["diagnostic_msgs/msg/KeyValue"]
    options = {"Exposure": 7500.0, "Laser_Power": 120.0, "Gain": 20.0, "Stereo_Baseline": 50.0, "Depth_Units": 0.0001}
    said: list[Said] = [
        (f"{stream}/info/camera_info", camera_info(ROS1), 1),
        *((f"/device_0/sensor_0/option/{name}/value", value(number), 1) for name, number in options.items()),
        ("/device_0/sensor_1/option/Exposure/value", value(1.0), 1),
        ("/device_0/info", pair("Name", "Intel RealSense D435I"), 1),
        ("/device_0/info", pair("Serial Number", "00123"), 1),
        *frames(ROS1, f"{stream}/image/data", frame="1", encoding="mono16"),
    ]
    path = write_rosbag1(tmp_path / "a.bag", said, {f"{stream}/image/data": struct.pack("<f", 0.002)})
    (tmp_path / "p.txt").write_text("0 0 0 0.3 1 0 0 0\n")
    found = read_bag(path, BagChoices(9, poses=tmp_path / "p.txt"))
    assert found.options["exposure"] == 7500.0
    assert found.options["laser_power"] == 120.0
    assert (found.camera.model, found.camera.serial) == ("Intel RealSense D435I", "00123")
    assert found.camera.min_z == pytest.approx(50.0 * 0.05 / 126)  # f B / 126, D400 datasheet
    depths = found.bursts[0].read().depths
    assert np.array_equal(depths, np.stack([steps(k) for k in range(9)]) * np.float32(0.002))


def test_recorder_of_librealsense(tmp_path: Path):
    """The .db3 that librealsense's own recorder writes of its software device: depth, unit, device, options, times."""
    rs = pytest.importorskip("pyrealsense2")
    path = tmp_path / "a.db3"
    times = [1000.0 + 33 * k for k in range(6)]
    lens = Intrinsics(WIDTH, HEIGHT, 50.0, 51.0, 5.5, 3.5)
    record_software_device(rs, path, [steps(k) for k in range(6)], times, lens, 0.0005)
    with pytest.raises(RecordingError, match="does not say where the camera stood"):
        read_bag(path, CHOICES)
    (tmp_path / "p.txt").write_text("0.9 0 0 0.3 1 0 0 0\n1.0985 0.1 0 0.3 1 0 0 0\n")
    found = read_bag(path, BagChoices(n_frames=3, poses=tmp_path / "p.txt"))
    assert found.camera.intrinsics == Intrinsics(WIDTH, HEIGHT, 50.0, 51.0, 5.5, 3.5)
    assert (found.camera.model, found.camera.serial, found.camera.firmware) == ("D435I", "007", "5.16")
    assert found.options | {"exposure": 8000.0, "laser_power": 90.0, "depth_units": 0.0005} == found.options
    assert [burst.times_ns[0] for burst in found.bursts] == [1000 * SECOND // 1000, 1099 * SECOND // 1000]
    for k, burst in enumerate(found.bursts):
        expected = np.stack([steps(3 * k + i) for i in range(3)]) * np.float32(0.0005)
        assert np.array_equal(burst.read().depths, expected)


def test_run_recorded_by_librealsense_is_replayed_exactly(recorded, tmp_path: Path):
    """The run's frames go through librealsense's recorder as a camera would have sent them; depth from its .db3, poses
    and decisions from ours: the planner decides as it did, to the bit."""
    rs = pytest.importorskip("pyrealsense2")
    bursts = [a.burst for a in recorded.run.acquisitions]
    frames = [np.rint(depth / np.float32(UNIT)).astype(np.uint16) for burst in bursts for depth in burst.depths]
    times = [1000.0 + 33 * k for k in range(len(frames))]
    record_software_device(rs, tmp_path / "run.db3", frames, times, SENSOR, UNIT)
    ours = tmp_path / "ours.mcap"
    n = PARAMETERS.n_frames
    ms = 1_000_000
    with RecordingWriter(ours, RUN, CAMERA) as writer:

        def times_of(number: int) -> list[int]:
            return [round(time * ms) for time in times[number * n : (number + 1) * n]]

        watch = Watch(writer, times_of=times_of)
        loop = watch.camera(camera()), watch.arm(FreeArm()), fra(), PARAMETERS
        watch.stop(reconstruct(*loop, seed=SEED, observe=watch.observe).stop)
    recording = read_bag(tmp_path / "run.db3", BagChoices(n, poses=ours))
    for burst, expected in zip(recording.bursts, bursts, strict=True):
        assert burst.read().depths.tobytes() == expected.depths.tobytes()
    found = replay(recording, fra(), PARAMETERS, SEED)
    assert (found.mode, found.decisions_equal, found.n_decisions) == ("closed_loop", True, len(bursts))
    assert recording.options["exposure"] == 8000.0
    with pytest.raises(RecordingError, match="has 0 of the 3 frames of burst 0"):
        read_bag(tmp_path / "run.db3", BagChoices(n, poses=recorded.path))


def record_software_device(rs, path: Path, frames: Sequence[np.ndarray], times_ms, lens_of: Intrinsics, unit: float):
    """The frames, taken at these times, through librealsense's software device and recorder."""
    device = rs.software_device()
    device.register_info(rs.camera_info.name, "D435I")
    device.register_info(rs.camera_info.serial_number, "007")
    device.register_info(rs.camera_info.firmware_version, "5.16")
    sensor = device.add_sensor("Stereo Module")
    stream, lens = rs.video_stream(), rs.intrinsics()
    lens.width, lens.height, lens.fx, lens.fy = lens_of.width, lens_of.height, lens_of.fx, lens_of.fy
    lens.ppx, lens.ppy = lens_of.cx, lens_of.cy
    stream.type, stream.index, stream.uid, stream.fmt, stream.intrinsics = rs.stream.depth, 0, 0, rs.format.z16, lens
    stream.width, stream.height, stream.fps, stream.bpp = lens.width, lens.height, 30, 2
    profile = sensor.add_video_stream(stream).as_video_stream_profile()
    for option, value in [(rs.option.depth_units, unit), (rs.option.exposure, 8000), (rs.option.laser_power, 90)]:
        sensor.add_read_only_option(option, value)
    recorder = rs.recorder(str(path), device)
    recorded, arrived = recorder.query_sensors()[0], rs.frame_queue(20)
    recorded.open(recorded.get_stream_profiles()[0])
    recorded.start(arrived)
    for k, (pixels, time_ms) in enumerate(zip(frames, times_ms, strict=True)):
        frame = rs.software_video_frame()
        frame.pixels, frame.stride, frame.bpp, frame.profile = pixels, 2 * lens.width, 2, profile
        frame.timestamp, frame.domain = time_ms, rs.timestamp_domain.hardware_clock
        frame.frame_number, frame.depth_units = k, unit
        sensor.on_video_frame(frame)
        arrived.wait_for_frame(60_000)  # the recorder writes behind it, in the same order
    recorded.stop()
    recorded.close()
