"""Faults by script on librealsense's software device: one clear line or the burst anew, never a mixed burst.

Each run draws anew where in the burst the fault comes; a few runs are quick, fifty of each are slow.
"""

from collections.abc import Iterator

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.burst import LEFT_INFRARED
from franbv.adapters.realsense.devices import NotConnectedError
from franbv.adapters.realsense.settings import RealSenseSettings
from franbv.adapters.realsense.source import open_source
from tests.franbv.adapters.realsense.software_camera import PERIOD_MS, Bench, SoftwareCamera, Still, flat, stills

HERE = RigidTransform.identity()
N = 6
"""Frames of a burst."""
RUNS = [*range(3), *(pytest.param(run, marks=pytest.mark.slow) for run in range(3, 50))]
runs = pytest.mark.parametrize("run", RUNS)


def place(run: int) -> int:
    """After how many frames of the burst the fault comes."""
    return int(np.random.default_rng(run).integers(1, N))


def told(bench: Bench, **changes) -> str:
    """The one line that a burst ends with; afterwards nothing streams."""
    with pytest.raises(CameraError) as caught, bench.camera(**changes) as camera:
        camera.shoot(HERE, N)
    assert not any(camera.streams for camera in bench.cameras)
    line = str(caught.value)
    assert "\n" not in line
    assert ";" in line  # what is the matter; what to do
    return line


@runs
def test_a_silent_camera_is_named(run):
    """Silence twice over, before and after the stream was begun anew: the run stops, and says what to look at."""
    bench = Bench([SoftwareCamera()], stills(flat, count=place(run)))
    assert "no frame for 0.3 s; check cable and port" in told(bench)
    assert bench.opened == 2


@runs
def test_dropped_frames_are_counted(run):
    """The burst has its N frames, distinct and in order; what is missing between them is counted, not hidden."""
    numbers = np.cumsum(np.random.default_rng(run).integers(1, 4, N + 2))
    sent = (Still(flat(int(k)), int(k), k * PERIOD_MS) for k in numbers)
    with Bench([SoftwareCamera()], sent).camera() as camera:
        shot = camera.shoot(HERE, N)
    np.testing.assert_array_equal(shot.taken.numbers, numbers[:N])
    np.testing.assert_array_equal(np.rint(shot.burst.depths[:, 0, 0] * 1e3), numbers[:N])
    assert shot.taken.dropped == np.sum(np.diff(numbers[:N]) - 1)


@runs
def test_a_frame_that_comes_twice_counts_once(run):
    """By its number, whatever is in it."""
    twice = place(run)
    sent = [k for k in range(1, N + 1) for _ in range(1 + (k == twice))]
    with Bench([SoftwareCamera()], (Still(flat(k), k, k * PERIOD_MS) for k in sent)).camera() as camera:
        shot = camera.shoot(HERE, N)
    np.testing.assert_array_equal(shot.taken.numbers, range(1, N + 1))
    assert shot.taken.repeated == 1


@runs
@pytest.mark.parametrize("what", ["timestamps", "frame numbers"])
def test_running_backwards_is_refused(run, what):
    """When time or count step back, which frame is newer than the call cannot be told any more."""
    at = place(run) + 1

    def script():
        for k in range(1, N + 1):
            back = k == at
            yield Still(
                flat(k),
                k - 2 * (back and what == "frame numbers"),
                (k - 3 * (back and what == "timestamps")) * PERIOD_MS,
            )

    line = told(Bench([SoftwareCamera()], script()))
    assert f"depth: {what} run backwards" in line


@runs
def test_unplugged_for_good(run):
    """The camera is waited for as long as the settings say, and no longer; what became of it is told."""

    def script(bench: Bench) -> Iterator[Still | None]:
        yield from stills(flat, count=place(run))
        bench.cameras.clear()
        yield None

    bench = Bench([SoftwareCamera()])
    bench.script = script(bench)
    line = told(bench)
    assert "RealSense D435I 1: unplugged, and not back within 0.6 s" in line
    assert "check cable and port" in line


@runs
def test_plugged_in_again(run):
    """The same serial number comes back: it is set up as before, and no frame from before is in the burst."""
    again, before = SoftwareCamera(), place(run)

    def script(bench: Bench) -> Iterator[Still | None]:
        yield from stills(flat, count=before)
        bench.cameras[:] = [again]
        yield None
        yield from stills(lambda k: flat(1000 + k))

    bench = Bench([SoftwareCamera(), SoftwareCamera(serial="2")])
    bench.script = script(bench)
    wishes = {"laser_power_mw": 90, "exposure_us": 5000, "gain": 32, "preset": "high_density", "warm_up_frames": 4}
    with bench.camera(serial="1", **wishes | {"warm_up_frames": 0}) as camera:
        shot = camera.shoot(HERE, N)
        assert {name: again.option(name) for name in ("laser_power", "exposure", "gain", "visual_preset")} == {
            "laser_power": 90, "exposure": 5000, "gain": 32, "visual_preset": 4,
        }  # fmt: skip
        assert again.option("enable_auto_exposure") == 0
    np.testing.assert_array_equal(np.rint(shot.burst.depths[:, 0, 0] * 1e3), 1001 + np.arange(N))
    assert shot.restarts == 1
    assert not again.streams


@runs
def test_plugged_in_again_at_once(run):
    """Too quick for the bus to be seen without it: the old stream is silent, and the burst begins anew all the same."""

    def script():
        yield from stills(flat, count=place(run))
        yield None
        yield from stills(lambda k: flat(1000 + k))

    bench = Bench([SoftwareCamera()], script())
    with bench.camera() as camera:
        shot = camera.shoot(HERE, N)
    assert np.all(shot.burst.depths[:, 0, 0] > 1.0)
    assert (shot.restarts, bench.opened) == (1, 2)


@runs
def test_another_camera_is_not_taken_for_it(run):
    """With or without a serial number in the settings, the camera that was opened is the one that is waited for."""

    def script(bench: Bench) -> Iterator[Still | None]:
        yield from stills(flat, count=place(run))
        bench.cameras[:] = [SoftwareCamera(serial="777")]
        yield None
        yield from stills(flat)

    bench = Bench([SoftwareCamera()])
    bench.script = script(bench)
    line = told(bench)
    assert "not back within 0.6 s" in line
    assert "RealSense 1: not connected" in line
    assert "777" in line
    assert bench.opened == 1


def test_back_after_a_while():
    """A camera that starts slowly is found at a later look."""
    again, looks = SoftwareCamera(), [0]
    bench = Bench([SoftwareCamera()])

    def find():
        looks[0] += 1
        if looks[0] == 5:
            bench.cameras.append(again)
        return [camera.device for camera in bench.cameras]

    def script():
        yield from stills(flat, count=2)
        bench.cameras.clear()
        looks[0] = 0
        yield None
        yield from stills(flat)

    bench.script, bench.find = script(), find
    with bench.camera(reconnect_s=60.0) as camera:
        assert camera.shoot(HERE, N).restarts == 1
    assert looks[0] >= 5


def test_the_next_burst_warms_up_again():
    """After the camera was away, exposure begins anew as after every start."""

    def script():
        yield from stills(flat, count=4)
        yield None
        yield from stills(flat, first=101)

    with Bench([SoftwareCamera()], script()).camera(warm_up_frames=3) as camera:
        assert camera.shoot(HERE, 1).taken.numbers[0] == 4  # warm
        shot = camera.shoot(HERE, 2)
    np.testing.assert_array_equal(shot.taken.numbers, [104, 105])


def test_calibrated_anew_while_it_was_away():
    """The planner was told intrinsics at the start: bursts of others are not passed to it."""

    def script(bench: Bench) -> Iterator[Still | None]:
        yield Still(flat(1), 1, 1.0)
        bench.cameras[:] = [SoftwareCamera(focal_px=322.0)]
        yield None

    bench = Bench([SoftwareCamera()])
    bench.script = script(bench)
    assert "calibrated anew" in told(bench)


def test_an_error_of_the_sdk_is_a_loss():
    """librealsense raises when a device dies under it; that is no traceback here, and the burst begins anew."""

    class Dead:
        def try_wait_for_frame(self, timeout_ms):
            raise RuntimeError("No device connected\nxioctl(VIDIOC_DQBUF) failed")

        def poll_for_frame(self):
            return None

    bench = Bench([SoftwareCamera()], stills(flat))
    with bench.camera() as camera:
        camera._source._queue = Dead()
        assert camera.shoot(HERE, 2).restarts == 1


def test_a_bus_that_cannot_be_read_is_one_line():
    """What librealsense raises while devices come and go is quoted, and names what to do."""

    def find():
        raise RuntimeError("failed to claim\nusb interface")

    with pytest.raises(NotConnectedError, match="does not answer \\(failed to claim usb interface\\); plug it in anew"):
        open_source(RealSenseSettings(), find)


def test_frames_of_which_none_can_be_used():
    """A stream whose partner never comes is no silence, and yet no burst: the missing one is named."""
    bench = Bench([SoftwareCamera(infrared=True)], stills(flat))
    line = told(bench, infrared=True)
    assert LEFT_INFRARED in line
    assert "USB 3" in line


def test_a_clock_that_is_wrong_is_named():
    """Frames that claim to be of yesterday cannot be told from frames of another pose: better none than those."""
    bench = Bench([SoftwareCamera()], (Still(flat(k), k, k * PERIOD_MS, "global_time") for k in range(1, 1000)))
    assert "older than the call" in told(bench)


def test_a_clock_that_comes_and_goes_is_named():
    """Two clocks in turn would begin the burst anew for ever."""
    ahead = 1e13  # [ms], beyond any now
    clocks = ("hardware_clock", "global_time")
    bench = Bench([SoftwareCamera()], (Still(flat(k), k, ahead + k, clocks[k % 2]) for k in range(1, 1000)))
    assert "back and forth" in told(bench)
