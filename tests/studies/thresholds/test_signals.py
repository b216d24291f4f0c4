"""What a cell observes of a run: numbers against closed forms, and the same numbers from all ways of keeping a run."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from franbv.adapters.recording.contents import CameraFacts, NothingRecordedError, RecordingError, RunFacts
from franbv.adapters.recording.mcap_records import messages_of
from franbv.adapters.recording.opening import open_recording
from franbv.adapters.recording.topics import BURST_TOPIC
from franbv.adapters.recording.writer import RecordingWriter
from franbv.stopping import StopReason
from materials.input_error import InputError
from studies.run.recording import run_facts
from studies.run.stored_run import StoredRun
from studies.store.views import read_arrays
from studies.thresholds.signals import (
    Observed,
    RecoveryStep,
    depth_spread,
    last_gammas,
    observed_in,
    observed_of_recording,
    observed_of_stored,
    share_in,
)
from studies.thresholds.watched_runs import watched_runs
from tests.studies.run.analytic_ball import CAMERA
from tests.studies.thresholds.ball_runs import SHORT, BallRun, noisy_copy

SPREAD = 1e-3
"""Standard deviation over Z^2 of the bursts below [1/m]: 0.25 mm at half a metre."""


def two_frames(z: np.ndarray, off: np.ndarray) -> np.ndarray:
    """Frames that lie so far off z, one before and one behind [m]."""
    return np.stack([z - off, z + off])


def test_the_spread_of_two_frames():
    """Values z - d and z + d have the standard deviation sqrt(2) d; where d grows with z^2, every pixel says the same,
    however far it is. A pixel that is invalid in one frame is not asked."""
    z = np.array([[0.3, 0.5, 0.8, 1.3]])
    depths = two_frames(z, SPREAD * z**2)
    assert depth_spread(depths) == pytest.approx(np.sqrt(2) * SPREAD, rel=1e-12)
    depths[1, 0, 0] = 0
    assert depth_spread(depths) == pytest.approx(np.sqrt(2) * SPREAD, rel=1e-12)
    other = two_frames(z, np.array([[1.0, 2.0, 4.0, 50.0]]) * SPREAD * z**2)
    assert depth_spread(other) == pytest.approx(3 * np.sqrt(2) * SPREAD, rel=1e-12)  # the median of 1, 2, 4, 50


def test_the_spread_of_stereo_noise_is_that_of_its_law():
    """Normal noise: the median of a standard deviation of n values is sigma sqrt(median of chi^2 / (n - 1))."""
    rng, n = np.random.default_rng(0), 5
    z = rng.uniform(0.3, 1.2, (100, 100))
    found = depth_spread(z + rng.normal(size=(n, 100, 100)) * SPREAD * z**2)
    assert found == pytest.approx(SPREAD * np.sqrt(chi2.median(n - 1) / (n - 1)), rel=0.02)  # 10^4 pixels: 0.5 %


def test_bursts_that_say_nothing_of_spread():
    """One frame, and frames of which every pixel is invalid once."""
    assert depth_spread(np.ones((1, 2, 2))) is None
    assert depth_spread(np.eye(2)[:, :, None]) is None


def test_the_share_of_a_silhouette():
    """Three of four pixels within; what is invalid outside does not count. Without a silhouette an object that should
    have been looked for is missing whole."""
    silhouette = np.array([[1, 1, 1, 1, 0, 0]], bool)
    invalid = np.array([[1, 0, 1, 1, 1, 1]], bool)
    assert share_in(silhouette, invalid, detects=True) == 0.75
    nothing = np.zeros_like(silhouette)
    assert share_in(nothing, invalid, detects=True) == 1
    assert share_in(nothing, invalid, detects=False) is None


def test_each_recovery_ends_with_its_last_gamma():
    """Views in a row belong to one recovery until another view comes, or until one of them sets off the next."""
    view, begins = RecoveryStep(False, False, None), RecoveryStep(False, True, None)

    def recovers(gamma: float, activates: bool = False) -> RecoveryStep:
        return RecoveryStep(True, activates, gamma)

    assert last_gammas([view, view]) == []
    assert last_gammas([begins]) == []  # cut off before its first view
    assert last_gammas([begins, recovers(0.3), recovers(0.0), view]) == [0.0]
    assert last_gammas([begins, recovers(0.1), recovers(0.4), begins, recovers(0.2)]) == [0.4, 0.2]
    assert last_gammas([begins, recovers(0.1), recovers(0.2, activates=True), recovers(0.5), view]) == [0.2, 0.5]


def test_all_ways_of_keeping_a_run_say_the_same(run: BallRun):
    """Folder, recording and acquisitions: equal to the last bit, and what the run's table tells by hand."""
    stored = StoredRun(run.case)
    found = observed_of_stored(stored)
    assert found == observed_of_recording(open_recording(run.recording))
    assert found == observed_in(run.seen, SHORT.parameters, StopReason(stored.run["summary"]["stop"]))
    gammas = [row["gamma"] for row in stored.rows]
    ends = [k for k, gamma in enumerate(gammas) if gamma is not None and [*gammas, None][k + 1] is None]
    assert found.recoveries == len(ends) == stored.run["summary"]["recovery_activations"] > 0
    assert found.least_gain == min(gammas[k] for k in ends)
    first = stored.view(0)
    assert found.invalid_share == (first.invalid & first.silhouette).sum() / first.silhouette.sum() > 0


def test_the_balls_noise_is_found(run: BallRun, tmp_path: Path):
    """Noise of a known law in the stored burst, three frames."""
    copied = noisy_copy(run.case, tmp_path / "case", SPREAD, seed=1, finished_s=0)
    found = observed_of_stored(StoredRun(copied)).burst_spread
    assert found == pytest.approx(SPREAD * np.sqrt(chi2.median(2) / 2), rel=0.05)  # some 2000 pixels: 1.5 %


def test_a_run_that_lasts_says_nothing_of_recoveries(run: BallRun):
    """It may begin further ones; the first burst is there."""
    whole = observed_in(run.seen, SHORT.parameters, StopReason.MAX_ITERATIONS)
    for stop in (None, StopReason.RECORDING_ENDED):
        found = observed_in(run.seen[:1], SHORT.parameters, stop)
        assert found == Observed(None, None, whole.invalid_share, whole.burst_spread)


def bursts_end(path: Path) -> list[int]:
    """Where the chunk of each burst's last message begins [byte]."""
    return [found.place.chunk for found in messages_of(path) if found.topic == BURST_TOPIC.name]


@pytest.mark.parametrize("kept", ["two bursts", "no burst"])
def test_a_recording_that_was_cut_off(run: BallRun, tmp_path: Path, kept: str):
    """Is read up to its last whole burst, of which the first is enough for two signals; without one it says nothing
    yet, in one line."""
    cut, data = tmp_path / "cut.mcap", run.recording.read_bytes()
    begins = bursts_end(run.recording)
    cut.write_bytes(data[: begins[2 if kept == "two bursts" else 0] + 100])
    found = watched_runs([cut])
    if kept == "no burst":
        with pytest.raises(NothingRecordedError):
            open_recording(cut)
        assert found.runs == ()
        assert found.notices == (f"{cut}: holds no whole burst yet, and says nothing",)
        return
    whole = observed_of_stored(StoredRun(run.case))
    assert len(open_recording(cut).bursts) == 2
    assert found.runs[0].observed == Observed(None, None, whole.invalid_share, whole.burst_spread)


def test_a_recording_that_is_being_written(run: BallRun, tmp_path: Path):
    """The run is there as soon as its first burst is, and whole once it has ended."""
    path, whole = tmp_path / "live.mcap", observed_of_stored(StoredRun(run.case))
    facts = CameraFacts(CAMERA, 0.128, 0.001)
    recorded = open_recording(run.recording)
    with RecordingWriter(path, run_facts(SHORT, "Ball", {}), facts) as writer:
        assert watched_runs([path]).runs == ()
        for k, burst in enumerate(recorded.bursts):
            writer.burst(burst.read(), burst.T_asked)
            (found,) = watched_runs([path]).runs if k < 2 else [None]
            assert found is None or found.observed == Observed(None, None, whole.invalid_share, whole.burst_spread)
            writer.decision(recorded.decisions[k], {}, 0.0)
        writer.stop("max_iterations")
    assert watched_runs([path]).runs[0].observed == whole


def test_what_no_planner_recorded_is_refused(run: BallRun, tmp_path: Path):
    """By hand, or by a planner of another version: one line each."""
    burst = open_recording(run.recording).bursts[0].read()
    facts = CameraFacts(CAMERA, 0.128, 0.001)
    for name, words in ((None, "was not made by a planner"), ("tomorrow", "planned by tomorrow, which this version")):
        path = tmp_path / f"{name}.mcap"
        with RecordingWriter(path, RunFacts(planner=name), facts) as writer:
            writer.burst(burst, burst.T_world_cam)
        with pytest.raises(RecordingError, match=words):
            observed_of_recording(open_recording(path))
        with pytest.raises(InputError, match=words):
            watched_runs([path])


def test_a_run_counts_once(run: BallRun, tmp_path: Path):
    """Folder, recording, a copy of either, the recording of its beginning: one run, told by what says most of it."""
    cell = tmp_path / "cell"
    shutil.copytree(run.case, cell / "case")
    shutil.copytree(run.case, cell / "latest")
    (cell / "recording-2.mcap").write_bytes(run.recording.read_bytes())
    data, begins = run.recording.read_bytes(), bursts_end(run.recording)
    (cell / "recording-1.mcap").write_bytes(data[: begins[1]])
    found = watched_runs([cell, run.recording])
    (one,) = found.runs
    assert one.observed == observed_of_stored(StoredRun(run.case))
    assert len(found.notices) == 4
    assert all("is the same run as" in line for line in found.notices)


def test_runs_are_in_the_order_of_time_inside_a_folder_and_as_given_outside(run: BallRun, tmp_path: Path):
    """Names do not count, nor does what is hidden."""
    for folder, times in {"a": [30.0, 10.0, 20.0], "b": [5.0]}.items():
        for k, time in enumerate(times):
            noisy_copy(run.case, tmp_path / folder / f"{k}", SPREAD, seed=int(time), finished_s=time)
    noisy_copy(run.case, tmp_path / "a" / ".partial", SPREAD, seed=99, finished_s=1)
    found = watched_runs([tmp_path / "a", tmp_path / "b"])
    assert [str(one.path.relative_to(tmp_path)) for one in found.runs] == ["a/1", "a/2", "a/0", "b/0"]


def test_depth_that_was_not_kept(run: BallRun, tmp_path: Path):
    """Leaves the other signals."""
    case = noisy_copy(run.case, tmp_path / "case", SPREAD, seed=1, finished_s=0)
    shutil.rmtree(case / "captures")
    found = observed_of_stored(StoredRun(case))
    whole = observed_of_stored(StoredRun(run.case))
    assert found == Observed(whole.recoveries, whole.least_gain, whole.invalid_share, None)


def test_a_burst_of_the_recording_is_that_of_the_folder(run: BallRun):
    """What the hashes go by."""
    stored = read_arrays(run.case / "captures" / "000.npz")["depths"]
    recorded = open_recording(run.recording).bursts[0].read().depths
    assert stored.dtype == recorded.dtype
    assert np.array_equal(stored, recorded)


def test_paths_that_lead_nowhere(tmp_path: Path):
    """One line with the mend."""
    (tmp_path / "empty").mkdir()
    (tmp_path / "words.txt").write_text("no run")
    (tmp_path / "damaged.mcap").write_bytes(b"no recording")
    for name, words in {
        "none": "no such file or folder",
        "empty": "holds neither a finished run",
        "words.txt": "is no recording of franbv",
        "damaged.mcap": "is no MCAP file",
    }.items():
        with pytest.raises(InputError, match=words) as error:
            watched_runs([tmp_path / name])
        assert str(tmp_path / name) in str(error.value)
