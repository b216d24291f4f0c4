"""`python -m franbv.adapters`: cameras listed, a burst stored, and every fault in one line with exit status 2."""

import json
import os
from itertools import count
from threading import Event, Thread

import numpy as np
import pytest

from franbv.adapters.__main__ import run
from franbv.adapters.realsense import commands, source
from franbv.adapters.realsense.burst import DEPTH_STREAM, LEFT_INFRARED, RIGHT_INFRARED
from tests.franbv.adapters.realsense.software_camera import PERIOD_MS, QUICK, Bench, SoftwareCamera, Still, flat

GREY = np.full((360, 640), 90, np.uint8)


@pytest.fixture
def plugged(monkeypatch):
    """Cameras that the commands find; they run while the test does."""
    cameras: list[SoftwareCamera] = []
    found = lambda: [camera.device for camera in cameras]  # noqa: E731
    monkeypatch.setattr(commands, "connected_devices", found)
    monkeypatch.setattr(commands, "open_source", lambda settings: source.open_source(settings, found))
    stop = Event()

    def send():
        for k in count(1):
            if stop.wait(0.005):
                return
            for camera in cameras:
                camera.send(Still(flat(700), k, k * PERIOD_MS))

    thread = Thread(target=send)
    thread.start()
    yield cameras
    stop.set()
    thread.join()


def one_line(capsys) -> str:
    """What stands on standard error, which is one line; nothing is on standard output."""
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    return said.err


def test_cameras_are_listed(plugged, capsys):
    """Serial number, name, firmware, type of the port and temperature, in words and for machines."""
    plugged += [SoftwareCamera(serial="11"), SoftwareCamera(serial="22", name="Intel RealSense D415")]
    assert run(["cameras", "--json"]) == 0
    *rows, last = capsys.readouterr().out.splitlines()
    assert rows[0].split("  ") == ["11", "Intel RealSense D435I", "5.17.0.10", "3.2", "asic 41 deg C"]
    assert [row["serial"] for row in json.loads(last)["cameras"]] == ["11", "22"]


def test_no_camera_is_exit_1(plugged, capsys):
    """A check that failed, not bad input."""
    assert run(["cameras"]) == 1
    assert "plug one into a USB 3 port" in one_line(capsys)


def test_a_burst_is_stored(plugged, capsys, tmp_path):
    """Depth in metres and in the camera's units, and all that is known of the camera, in one archive."""
    plugged.append(SoftwareCamera())
    out = tmp_path / "burst.npz"
    args = ["--frames", "3", "--laser-power-mw", "90", "--crop", "40x30", "--warm-up-frames", "1", "--settle-s", "0"]
    assert run(["shoot", "--out", str(out), *args]) == 0
    assert "3 frames of 40x30, median depth 0.700 m, 100% valid, " in capsys.readouterr().out
    with np.load(out) as stored:
        assert stored["depths_m"].shape == (3, 30, 40)
        assert np.all(stored["z16"] == 700)
        assert np.all(np.diff(stored["frame_numbers"]) > 0)
        told = json.loads(str(stored["record"]))
    assert told["options"]["laser_power"] == 90
    assert told["intrinsics"]["width"] == 40
    assert os.listdir(tmp_path) == ["burst.npz"]
    assert not plugged[0].streams


def test_how_the_burst_came_about_is_stored(capsys, tmp_path, monkeypatch):
    """A frame and then silence, so that the burst is begun anew; in it depth 11 comes twice, 12 is missing, and the
    first infrared pair has no depth of its time."""

    def script():
        yield Still(flat(700), 1, PERIOD_MS)
        yield None
        for stream in (LEFT_INFRARED, RIGHT_INFRARED):
            yield Still(GREY, 10, 10 * PERIOD_MS, stream=stream)
        for k in (11, 13, 14):
            for stream, image in ((DEPTH_STREAM, flat(700)), (LEFT_INFRARED, GREY), (RIGHT_INFRARED, GREY)):
                for _ in range(1 + (k == 11 and stream == DEPTH_STREAM)):
                    yield Still(image, k, k * PERIOD_MS, stream=stream)

    bench = Bench([SoftwareCamera(infrared=True)], script())
    monkeypatch.setattr(commands, "open_source", bench.open)
    quick = [word for name, value in QUICK.items() for word in (f"--{name.replace('_', '-')}", str(value))]
    assert run(["shoot", "--out", str(tmp_path / "a.npz"), "--frames", "3", "--infrared", "true", *quick]) == 0
    with np.load(tmp_path / "a.npz") as stored:
        assert stored["frame_numbers"].tolist() == [11, 13, 14]
        told = json.loads(str(stored["record"]))
    counts = {name: told[name] for name in ("dropped", "discarded", "repeated", "unmatched", "restarts")}
    assert counts == {"dropped": 1, "discarded": 0, "repeated": 1, "unmatched": 2, "restarts": 1}


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["--laser-power-mw", "1000"], "--laser-power-mw: Input should be less than or equal to 360"),
        (["--gain", "16"], "gain without exposure_us"),
        (["--crop", "60"], "--crop: "),
        (["--serial", "9"], "RealSense 9: not connected"),
        (["--frames", "0"], "ask for 1 at least"),
    ],
)
def test_bad_input_is_one_line(plugged, capsys, tmp_path, args, words):
    """The flag or the camera, and what to do; no file is left."""
    plugged.append(SoftwareCamera())
    assert run(["shoot", "--out", str(tmp_path / "a.npz"), *args]) == 2
    assert words in one_line(capsys)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("name", ["there.npz", "nowhere/a.npz", "a.txt"])
def test_no_file_is_overwritten(plugged, capsys, tmp_path, name):
    """Said before the camera is opened."""
    (tmp_path / "there.npz").touch()
    assert run(["shoot", "--out", str(tmp_path / name)]) == 2
    assert "give the name of a new .npz file" in one_line(capsys)


def test_a_disk_that_is_full(plugged, capsys, tmp_path, monkeypatch):
    """What was begun is taken away again."""
    plugged.append(SoftwareCamera())

    def fail(*args, **kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", fail)
    assert run(["shoot", "--out", str(tmp_path / "a.npz"), "--warm-up-frames", "0", "--settle-s", "0"]) == 2
    assert "No space left on device" in one_line(capsys)
    assert os.listdir(tmp_path) == []
