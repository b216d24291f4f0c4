"""Bursts of librealsense's software device: as the simulator reduces them, to the bit, and newer than the call."""

import threading
import time
from itertools import count

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.burst import HOST_CLOCK, LEFT_INFRARED, RIGHT_INFRARED
from franbv.adapters.realsense.camera import RealSenseCamera
from franbv.adapters.realsense.settings import RealSenseSettings
from franbv.adapters.realsense.source import open_source
from franbv.frames import look_at
from franbv.sensing import DepthCamera
from materials.catalog import material
from render.d435i import SimulatedD435i
from render.depth.coding import metres_from_z16
from render.matcher.interface import N_DISPARITIES
from render.sensor import SensorSettings
from render.world.rig import FOCAL_LENGTHS_PX
from scenes.coupons import wall
from tests.franbv.adapters.realsense.software_camera import PERIOD_MS, Bench, SoftwareCamera, Still, flat, stills

HERE = RigidTransform.identity()


def holey(k: int, size: tuple[int, int]) -> np.ndarray:
    """Frame k: all depths below 65 m, four of ten pixels holes, in blobs that fill whole blocks here and there."""
    rng = np.random.default_rng(k)
    z16 = rng.integers(1, 2**16 - 1, (size[1], size[0])).astype(np.uint16)
    z16[rng.random(z16.shape) < 0.3] = 0
    z16[
        np.kron(rng.random((size[1] // 20 + 1, size[0] // 20 + 1)) < 0.15, np.ones((20, 20), bool))[
            : size[1], : size[0]
        ]
    ] = 0
    return z16


def simulated(**settings) -> SimulatedD435i:
    """The simulated camera of the same settings."""
    return SimulatedD435i(wall(0.4, material("stainless_austenitic:bright")), SensorSettings(**settings))


@pytest.mark.parametrize("decimation", range(1, 9))
@pytest.mark.parametrize("size", [(640, 360), (480, 270)])
def test_a_burst_is_the_simulators_to_the_bit(decimation, size):
    """The same full-resolution frames through librealsense's filter and through `SimulatedD435i.reduced`: depth,
    intrinsics and Min-Z are equal, not just near; 270 rows are divided by few factors."""
    profile, crop = f"{size[0]}x{size[1]}", None if decimation in (3, 7) else (48, 32)
    bench = Bench([SoftwareCamera(size=size, focal_px=FOCAL_LENGTHS_PX[size])], stills(lambda k: holey(k, size)))
    sim = simulated(profile=profile, decimation=decimation, crop=crop)
    with bench.camera(profile=size, decimation=decimation, crop=crop) as camera:
        assert isinstance(camera, DepthCamera)
        shot = camera.shoot(HERE, 3)
        assert camera.intrinsics == shot.burst.intrinsics == sim.intrinsics
        assert camera.min_z == sim.min_z
    expected = sim.reduced(np.stack([holey(k, size) for k in (1, 2, 3)]))
    np.testing.assert_array_equal(shot.burst.depths, metres_from_z16(expected))
    assert shot.burst.depths.dtype == np.float32
    np.testing.assert_array_equal(shot.taken.numbers, [1, 2, 3])


@pytest.mark.slow
def test_rendered_frames_give_the_simulators_burst():
    """What the renderer measured, sent through librealsense, is what the simulated camera hands to the planner."""
    sim = simulated()
    pose = look_at(np.zeros(3), np.array([1.0, 0.0, 0.0]))
    seen = sim.measure(pose, 2)
    assert 0 < np.count_nonzero(seen.burst.depths) < seen.burst.depths.size
    with Bench([SoftwareCamera()], stills(lambda k: seen.z16[k - 1], count=2)).camera() as camera:
        burst = camera.capture(pose, 2)
    np.testing.assert_array_equal(burst.depths, seen.burst.depths)
    assert burst.intrinsics == seen.burst.intrinsics


def test_min_z_is_the_matchers_range():
    """Min-Z = f B / 126 for the very number of disparities that the simulated matcher searches, of this camera's own
    calibration: 425.5 px and 49.9 mm."""
    with Bench([SoftwareCamera(size=(848, 480), focal_px=425.5, baseline_mm=49.9)]).camera(profile="848x480") as camera:
        assert camera.min_z == pytest.approx(425.5 * 0.0499 / N_DISPARITIES, rel=1e-7)  # of 32-bit floats


def test_depth_is_in_the_cameras_unit():
    """A camera that counts tenths of a millimetre says so; 5000 of them are 0.5 m."""
    with Bench([SoftwareCamera(unit=1e-4)], stills(lambda k: flat(5000))).camera() as camera:
        assert camera.capture(HERE, 1).depths == pytest.approx(0.5, rel=1e-6)
        assert camera.record()["depth_unit_m"] == pytest.approx(1e-4)


def test_the_queue_and_frames_in_flight_are_left_out():
    """What lay in the queue when the arm stopped, and the next frames, are of another pose: none is in the burst."""
    camera_ = SoftwareCamera()
    bench = Bench([camera_], stills(flat, first=4))
    with bench.camera(settle_frames=5) as camera:
        for k in (1, 2, 3):
            camera_.send(Still(flat(k), k, k * PERIOD_MS))
        shot = camera.shoot(HERE, 4)
        np.testing.assert_array_equal(shot.taken.numbers, [9, 10, 11, 12])  # 3 queued, 5 in flight
        np.testing.assert_array_equal(shot.burst.depths[:, 0, 0], np.float32([9, 10, 11, 12]) * np.float32(1e-3))
        assert (shot.taken.discarded, shot.taken.dropped, shot.restarts) == (8, 0, 0)


def test_warm_up_is_once():
    """Thirty frames after the start, the settling alone before the next burst."""
    with Bench([SoftwareCamera()], stills(flat)).camera(warm_up_frames=30, settle_frames=2) as camera:
        assert camera.shoot(HERE, 1).taken.numbers[0] == 31
        assert camera.shoot(HERE, 1).taken.numbers[0] == 31 + 3


def test_frames_older_than_the_call_by_their_time_are_left_out():
    """By this computer's clock a frame of a second ago was exposed before the arm stopped, however late it arrives."""

    def late():
        now = time.time() * 1e3
        for k in range(1, 6):
            yield Still(flat(k), k, now - 1000 + k, HOST_CLOCK)
        for k in range(6, 9):
            yield Still(flat(k), k, now + 1000 + k, HOST_CLOCK)

    with Bench([SoftwareCamera()], late()).camera() as camera:
        np.testing.assert_array_equal(camera.shoot(HERE, 2).taken.numbers, [6, 7])


def test_nothing_counts_while_the_camera_settles():
    """Frames that arrive within the settling time are none of the burst, whatever their number."""

    def paced():
        for k in count(1):
            time.sleep(0.03)
            yield Still(flat(k), k, k * 10.0)

    with Bench([SoftwareCamera()], paced()).camera(settle_s=0.1) as camera:
        began = time.monotonic()
        shot = camera.shoot(HERE, 1)
        assert time.monotonic() - began >= 0.1
        assert shot.taken.discarded >= 1


def test_a_change_of_clock_begins_the_burst_anew():
    """librealsense may go over to the computer's clock after the start: times before and after do not compare."""
    later = time.time() * 1e3 + 60_000

    def script():
        yield from (Still(flat(k), k, k * PERIOD_MS) for k in (1, 2))
        yield from (Still(flat(k), k, later + k * PERIOD_MS, HOST_CLOCK) for k in (3, 4, 5))

    with Bench([SoftwareCamera()], script()).camera() as camera:
        shot = camera.shoot(HERE, 3)
    np.testing.assert_array_equal(shot.taken.numbers, [3, 4, 5])
    assert (shot.taken.clock, shot.taken.discarded) == (HOST_CLOCK, 2)


def test_infrared_images_are_those_of_the_depth():
    """Of three streams, of which each loses a frame, a burst holds what was exposed together."""

    def script():
        for k in range(1, 8):
            for stream, lost, image in (
                (LEFT_INFRARED, 2, np.uint8),
                (RIGHT_INFRARED, 3, np.uint8),
                ("depth", 5, np.uint16),
            ):
                if k != lost:
                    yield Still(
                        np.full((360, 640), k, image), k, k * PERIOD_MS + (stream == RIGHT_INFRARED), stream=stream
                    )

    with Bench([SoftwareCamera(infrared=True)], script()).camera(infrared=True) as camera:
        shot = camera.shoot(HERE, 4)
    assert shot.lefts is not None
    assert shot.rights is not None
    assert shot.lefts.shape == (4, 360, 640)
    for images in (shot.lefts, shot.rights, np.rint(shot.burst.depths * 1e3)):
        np.testing.assert_array_equal(images[:, 0, 0], [1, 4, 6, 7])
    assert shot.taken.unmatched == 6  # two partners of each lost frame
    assert shot.taken.dropped == 3


def test_a_running_camera():
    """A thread sends 200 frames a second without regard to bursts: each burst is of consecutive new frames."""
    device, stop, sent = SoftwareCamera(), threading.Event(), [0]

    def run():
        for k in count(1):
            if stop.wait(0.005):
                return
            device.send(Still(flat(k), k, k * 5.0))
            sent[0] = k

    settings = RealSenseSettings(warm_up_frames=3, settle_frames=4, settle_s=0.0)
    with RealSenseCamera(settings, lambda s: open_source(s, lambda: [device.device])) as camera:
        thread = threading.Thread(target=run)
        thread.start()
        try:
            for _ in range(3):
                before = sent[0]
                shot = camera.shoot(HERE, 5)
                assert shot.taken.numbers[0] > before + 3
                assert np.all(np.diff(shot.taken.numbers) > 0)
                np.testing.assert_array_equal(np.rint(shot.burst.depths[:, 0, 0] * 1e3), shot.taken.numbers)
        finally:
            stop.set()
            thread.join()
    assert not device.streams


def test_a_closed_camera_says_so():
    """After the `with` nothing streams, and closing again does no harm."""
    device = SoftwareCamera()
    with Bench([device]).camera() as camera:
        assert device.streams
    assert not device.streams
    camera.close()
    with pytest.raises(CameraError, match="closed; open a new"):
        camera.capture(HERE, 1)


def test_the_stream_stops_when_the_caller_fails():
    """Whatever is raised inside the `with`, the camera is let go."""
    device = SoftwareCamera()
    with pytest.raises(ZeroDivisionError), Bench([device]).camera():
        raise ZeroDivisionError
    assert not device.streams


def test_no_frames_are_no_burst():
    """The planner's burst has at least one."""
    with Bench([SoftwareCamera()]).camera() as camera, pytest.raises(CameraError, match="ask for 1 at least"):
        camera.capture(HERE, 0)
