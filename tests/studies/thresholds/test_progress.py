"""Reconstructions as they go on: coverage and gains by hand, seconds from what a case's files say."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from studies.run.stored_run import TIMINGS, StoredRun
from studies.thresholds.report.progress import (
    RunProgress,
    by_acquisition,
    by_second,
    gains,
    longest,
    read_progress,
    times_until,
)
from studies.thresholds.report.progress_figure import ShownRuns, progress_figures
from studies.thresholds.report.setting_words import told_apart
from tests.studies.thresholds.ball_runs import BallRun

SHORT = RunProgress(np.array([0.1, 0.4, 0.3]), np.array([2.0, 5.0, 100.0]))
"""Ends after three acquisitions; the third takes away."""
LONG = RunProgress(np.arange(1, 8) / 10, 30.0 * np.arange(1, 8))
"""Seven acquisitions, a tenth and half a minute each."""


def test_one_run():
    """A step at each acquisition's end; nothing before the first and nothing new after the last."""
    assert [SHORT.after(n) for n in (1, 2, 3, 4, 99)] == [0.1, 0.4, 0.3, 0.3, 0.3]
    assert [SHORT.at(s) for s in (0, 1.9, 2, 4.9, 5, 99, 100, 1e6)] == [0, 0, 0.1, 0.1, 0.4, 0.4, 0.3, 0.3]
    assert [SHORT.next_gain(n) for n in (1, 2, 3)] == pytest.approx([0.3, -0.1, 0])
    # A minute after the first, at 62 s, the second is there; after the second, at 65 s, the third is not.
    assert [SHORT.minute_gain(n) for n in (1, 2, 3, 9)] == pytest.approx([0.3, 0, 0, 0])
    assert LONG.minute_gain(2) == pytest.approx(0.2)


def test_means():
    """Over runs, those that have ended included; the band of three runs is their range, and of one its value."""
    runs = [SHORT, LONG, RunProgress(np.array([0.7]), np.array([1.0]))]
    curve = by_acquisition(runs, longest(runs))
    assert [n for n, _ in curve] == [1, 2, 3, 4, 5, 6, 7]
    assert [i.mean for _, i in curve] == pytest.approx([0.3, 1.3 / 3, 1.3 / 3, 1.4 / 3, 0.5, 1.6 / 3, 1.7 / 3])
    first = curve[0][1]
    assert (first.low, first.high, first.count) == (pytest.approx(0.1), pytest.approx(0.7), 3)
    assert [i.mean for _, i in by_second(runs, [0, 1, 2, 30, 1000])] == pytest.approx(
        [0, 0.7 / 3, 0.8 / 3, 0.4, 1.7 / 3]
    )
    ((_, alone),) = by_second([LONG], [60.0])
    assert (alone.low, alone.mean, alone.high) == (0.2, 0.2, 0.2)


def test_gains():
    """After five acquisitions the long run alone goes on: a tenth by the next, two by the minute, over two runs."""
    (found,) = gains([SHORT, LONG])
    assert (found.acquisitions, found.going_on) == (5, 1)
    assert found.coverage.mean == pytest.approx((0.3 + 0.5) / 2)
    assert found.next_acquisition.mean == pytest.approx(0.05)
    assert found.next_minute.mean == pytest.approx(0.1)
    assert gains([SHORT]) == ()


@pytest.mark.parametrize("end_s", [0.03, 7.0, 100.0, 1234.5])
def test_times(end_s: float):
    """From 0, evenly, until the end is within, and not many."""
    times = times_until(end_s)
    assert times[0] == 0
    assert times[-2] < end_s <= times[-1]
    np.testing.assert_allclose(np.diff(times), times[1])
    assert 15 < len(times) <= 42


def test_seconds_of_a_case(run: BallRun, tmp_path: Path):
    """Two seconds of motion (the ball's arm), three frames at 30 Hz and the planner's stages; the sensing that was
    simulated is not counted."""
    case = tmp_path / "case"
    shutil.copytree(run.case, case)
    rows = StoredRun(case).rows
    timings = json.loads((case / TIMINGS).read_text())
    timings["acquisitions"] = [{"sensing": 99.0, "map": 0.5, "score": 0.25} for _ in rows]
    (case / TIMINGS).write_text(json.dumps(timings))
    found = read_progress(case)
    np.testing.assert_allclose(found.ends_s, (2 + 3 / 30 + 0.75) * np.arange(1, len(rows) + 1))
    np.testing.assert_array_equal(found.coverage, [row["coverage_map_5mm"] for row in rows])


def test_words():
    """What is the same in all settings tells none from another; of one alone all is said."""
    two = [{"n_frames": 3, "recovered_share": 0.3}, {"n_frames": 3, "recovered_share": 0.5}]
    assert told_apart(two) == ["recovered_share 0.3", "recovered_share 0.5"]
    assert told_apart(two[:1]) == ["n_frames 3, recovered_share 0.3"]
    assert told_apart([{}]) == ["as it is"]


def test_figures():
    """Both charts have a dot for each value of each setting; the chosen one is drawn last; short runs say so."""
    shown = progress_figures([ShownRuns("a 1", True, (LONG, LONG)), ShownRuns("a 2", False, (SHORT, SHORT))])
    by_number, by_time = map(str, shown.charts)
    assert by_number.count("<circle") == 2 * 7
    assert by_number.rindex("series-1") < by_number.index("series-chosen")
    assert "a 1, 3 acquisitions: 30.0 % (30.0 to 30.0, n = 2)" in by_number
    assert "a 2, 210 seconds since the start: 30.0 % (30.0 to 30.0, n = 2)" in by_time
    assert shown.key == (("series-chosen", "a 1, chosen"), ("series-1", "a 2"))
    assert [(row["words"], row["taken"], row["going_on"]) for row in shown.rows] == [
        ("a 1", 5, "2 of 2"),
        ("a 2", 5, "none"),
    ]
    assert shown.count == 2
