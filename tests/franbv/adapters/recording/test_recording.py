"""What is written comes back to the bit, others read it, and what cuts a run off costs no whole burst."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader, breakup_chunk
from scipy.spatial.transform import RigidTransform

from franbv.adapters.recording.contents import RecordingError, RunFacts
from franbv.adapters.recording.decisions import decision_of
from franbv.adapters.recording.depth_codes import METRES_32, STEPS_16, coding_of
from franbv.adapters.recording.mcap_recording import read_recording
from franbv.adapters.recording.writer import RecordingWriter
from franbv.sensing import DepthBurst
from tests.conftest import ROOT
from tests.franbv.adapters.recording.recorded_run import CAMERA, RUN, infrared, record
from tests.franbv.analytic_camera import SENSOR, AnalyticCamera

FOXGLOVE = {"foxglove.RawImage", "foxglove.CameraCalibration", "foxglove.PoseInFrame", "foxglove.FrameTransform"}


def same_bits(one: np.ndarray, other: np.ndarray) -> bool:
    """Type, shape and every bit."""
    return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()


def test_everything_comes_back_to_the_bit(recorded):
    """Facts, depth, infrared, poses, answers of the arm, decisions and the stop are those of the run."""
    found = read_recording(recorded.path)
    assert (found.run, found.camera) == (RUN, CAMERA)
    assert found.notices == ()
    assert found.stop == recorded.run.stop
    assert list(found.decisions) == [json.loads(json.dumps(decision_of(a))) for a in recorded.run.acquisitions]
    for number, (burst, acquisition) in enumerate(zip(found.bursts, recorded.run.acquisitions, strict=True)):
        assert same_bits(burst.read().depths, acquisition.burst.depths)
        assert burst.read().intrinsics == SENSOR
        for pose in (burst.T_world_cam, burst.T_asked, burst.read().T_world_cam):
            assert same_bits(pose.as_matrix(), acquisition.burst.T_world_cam.as_matrix())
        assert burst.motion_s == acquisition.motion_s
        image, expected = burst.read_infrared(), infrared(number)
        assert (image is None) == (expected is None)
        assert image is None or same_bits(image, expected)
    kinds = [a.kind for a in recorded.run.acquisitions]
    assert "recovery" in kinds
    assert len(found.reachability.poses) == len(found.reachability.reachable) > 32 * kinds.count("nbv")


def test_depth_that_is_no_step_is_kept_whole(tmp_path: Path):
    """Noise in fractions of a step needs 32 bits, and comes back as it was; whole steps are kept in 16 bits."""
    run = record(tmp_path / "a.mcap", AnalyticCamera)
    found = read_recording(tmp_path / "a.mcap")
    assert all(same_bits(b.read().depths, a.burst.depths) for b, a in zip(found.bursts, run.acquisitions, strict=True))
    steps = np.arange(2**16, dtype=np.uint16).reshape(1, 256, 256)
    assert coding_of(run.acquisitions[0].burst.depths, None) == METRES_32
    for unit in (1e-3, 1e-4, 0.000999):
        assert coding_of(steps * np.float32(unit), unit) == STEPS_16


def test_others_read_it(recorded):
    """mcap's own readers, with every checksum compared: Foxglove's names, JSON that has the fields of its schema."""
    with recorded.path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        messages = [(schema, channel.topic, json.loads(m.data)) for schema, channel, m in reader.iter_messages()]
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == len(messages)
    assert {schema.name for schema, *_ in messages} >= FOXGLOVE
    for schema, topic, message in messages:
        form = json.loads(schema.data)
        assert schema.encoding == "jsonschema"
        assert set(message) == set(form["properties"]), topic
    with recorded.path.open("rb") as file:
        assert len(list(StreamReader(file, validate_crcs=True).records)) > len(messages)


def test_a_cut_recording_holds_its_whole_bursts(recorded, tmp_path: Path):
    """Cut anywhere, it has the bursts whose last chunk is there, to the bit, and says so; never part of another one.

    Where chunks end is told by mcap's own reader.
    """
    data = recorded.path.read_bytes()
    ends = ends_of_bursts(recorded.path)
    rng = np.random.default_rng(0)
    cuts = {*rng.integers(9, len(data) - 8, 8).tolist(), *(end + d for end in ends for d in (-1, 0))}
    whole = read_recording(recorded.path)
    for cut in sorted(cuts):
        path = tmp_path / "cut.mcap"
        path.write_bytes(data[:cut])
        n = sum(end <= cut for end in ends)
        if n == 0:
            with pytest.raises(RecordingError, match=r"holds no whole burst|ends before its header"):
                read_recording(path)
            continue
        found = read_recording(path)
        assert len(found.bursts) == n
        assert len(found.decisions) in (n, n - 1)
        assert "was cut off" in found.notices[0]
        for one, other in zip(found.bursts, whole.bursts, strict=False):
            assert same_bits(one.read().depths, other.read().depths)


def ends_of_bursts(path: Path) -> list[int]:
    """Where the chunk of each burst's last message ends [byte]."""
    ends, at = [], 0
    with path.open("rb") as file:
        reader = StreamReader(file, emit_chunks=True)
        channels = {}
        for record_found in reader.records:
            at = file.tell()
            if isinstance(record_found, Chunk):
                for inner in breakup_chunk(record_found):
                    if hasattr(inner, "topic"):
                        channels[inner.id] = inner.topic
                    elif hasattr(inner, "channel_id") and channels[inner.channel_id] == "/camera/burst":
                        ends.append(at)
    return ends


WRITE_UNTIL_KILLED = """
import os, signal, sys, threading
from pathlib import Path
import numpy as np
from scipy.spatial.transform import RigidTransform
from franbv.adapters.recording.contents import CameraFacts, RunFacts
from franbv.adapters.recording.writer import RecordingWriter
from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst

sensor = Intrinsics(60, 40, 40.0, 40.0, 29.5, 19.5)
writer = RecordingWriter(Path(sys.argv[1]), RunFacts(), CameraFacts(sensor, 0.1, 0.001))
killer = threading.Timer(float(sys.argv[2]), os.kill, (os.getpid(), signal.SIGKILL))
killer.daemon = True
killer.start()
for number in range(10**6):
    steps = np.random.default_rng(number).integers(0, 2000, (5, 40, 60)).astype(np.uint16)
    writer.burst(DepthBurst(steps * np.float32(0.001), sensor, RigidTransform.identity()), RigidTransform.identity())
"""


@pytest.mark.parametrize("after_s", [0.02, 0.05, 0.1])
def test_kill_minus_nine_leaves_whole_bursts(tmp_path: Path, after_s: float):
    """The writer is killed without warning, in the middle of whatever it does; all bursts before that are there."""
    path = tmp_path / "killed.mcap"
    command = [sys.executable, "-c", WRITE_UNTIL_KILLED, str(path), str(after_s)]
    assert subprocess.run(command, cwd=ROOT, check=False).returncode == -signal.SIGKILL
    found = read_recording(path)
    assert found.stop is None
    assert "was cut off" in found.notices[0]
    assert len(found.bursts) > 0
    for number, burst in enumerate(found.bursts):
        steps = np.random.default_rng(number).integers(0, 2000, (5, 40, 60)).astype(np.uint16)
        assert same_bits(burst.read().depths, steps * np.float32(0.001))


def test_a_full_disk_leaves_whole_bursts(tmp_path: Path):
    """The system takes no more than 60 kB of the file: one error of ours, and what was on disk can be read."""
    path = tmp_path / "full.mcap"
    limited = "import resource\nresource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))\n" + WRITE_UNTIL_KILLED
    command = [sys.executable, "-c", limited, str(path), "600"]
    done = subprocess.run(command, cwd=ROOT, check=False, capture_output=True, text=True)
    assert "RecordingError: " in done.stderr.splitlines()[-1]
    assert "File too large" in done.stderr.splitlines()[-1]
    assert path.stat().st_size <= 60_000
    assert len(read_recording(path).bursts) > 0


def test_an_interrupted_run_ends_its_file(tmp_path: Path):
    """An exception on the way out leaves a closed file without a stop."""
    path = tmp_path / "a.mcap"

    def interrupted() -> None:
        with RecordingWriter(path, RUN, CAMERA) as writer:
            writer.burst(_burst(), RigidTransform.identity())
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    found = read_recording(path)
    assert (len(found.bursts), found.stop, found.notices) == (1, None, ())


def test_nothing_is_written_over(recorded):
    """A file that is there is refused and stays."""
    before = recorded.path.read_bytes()
    with pytest.raises(RecordingError, match="is there already"):
        RecordingWriter(recorded.path, RunFacts(), CAMERA)
    assert recorded.path.read_bytes() == before


def test_what_cannot_be_kept_is_refused(tmp_path: Path):
    """Depth of other bits or another camera than the recording's, a folder that is not there."""
    with RecordingWriter(tmp_path / "a.mcap", RUN, CAMERA) as writer, pytest.raises(RecordingError, match="float64"):
        writer.burst(DepthBurst(np.ones((1, 40, 60)), SENSOR, RigidTransform.identity()), RigidTransform.identity())
    with pytest.raises(RecordingError, match="cannot be written"):
        RecordingWriter(tmp_path / "none" / "a.mcap", RUN, CAMERA)


def _burst() -> DepthBurst:
    return DepthBurst(np.full((2, 40, 60), 0.3, np.float32), SENSOR, RigidTransform.identity())
