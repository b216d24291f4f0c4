"""The stopwatch itself, with steps whose cost is known."""

import numpy as np
import pytest

from tests.benchmarks.stopwatch import Stopwatch, Timing, reset_peak_memory

MIB = 2**20


def test_median_and_ratio_are_those_of_the_times():
    """Times 0.011, 2, 9 s: median 2 s; against a goal of 4 s that is 0.50; median CPU 3 s; 3 MiB of memory."""
    row = Timing("step", (9.0, 0.011, 2.0), (4.0, 2.0, 3.0), 3 * MIB, goal=4.0).row()
    assert row == ("step", "2000", "11-9000", "3000", "3", "4000", "0.50", "3")


def test_steps_are_warmed_up_and_counted():
    """Two runs for the caches, three against the clock: five calls, three times."""
    calls = []

    def step() -> None:
        calls.append(None)

    stopwatch = Stopwatch()
    timing = stopwatch.time("count", step, n=3, warm_up=2)
    assert len(calls) == 5
    assert len(timing.seconds) == 3
    assert len(stopwatch.table()) == 2


def test_peak_memory_sees_what_a_step_holds_and_forgets_it():
    """A step that fills 200 MiB raises the peak by that, within a tenth; the next step's peak is low again."""
    if not reset_peak_memory():
        pytest.skip("this system does not let a process forget its peak memory")
    stopwatch = Stopwatch()
    idle = stopwatch.time("nothing", lambda: None, n=1)
    full = stopwatch.time("200 MiB", lambda: np.ones(200 * MIB, np.uint8).sum(), n=1)
    after = stopwatch.time("nothing again", lambda: None, n=1)
    assert 180 * MIB < full.peak_bytes - idle.peak_bytes < 220 * MIB
    assert after.peak_bytes - idle.peak_bytes < 20 * MIB
