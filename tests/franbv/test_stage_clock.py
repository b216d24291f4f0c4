"""The stage clock: names, resets and threads. How long anything takes is not tested."""

import time

import pytest
from threadpoolctl import threadpool_info

from franbv.stage_clock import StageClock


def test_stages_add_up_until_read():
    """Each stage has one positive entry however often it ran, and reading starts anew."""
    clock = StageClock()
    for stage in ("map", "map", "score"):
        with clock.planning(stage):
            sum(range(1000))
    with clock.timing("sensing"):
        sum(range(1000))
    spent = clock.read()
    assert set(spent) == {"map", "score", "sensing"}
    assert all(min(times) > 0 for times in spent.values())
    assert clock.read() == {}


def test_planning_runs_on_one_thread_and_sensing_does_not():
    """Inside a planning stage every BLAS and OpenMP pool has one thread; afterwards, and while sensing, as before."""
    clock, before = StageClock(), [pool["num_threads"] for pool in threadpool_info()]
    with clock.planning("map"):
        assert {pool["num_threads"] for pool in threadpool_info()} <= {1}
    with clock.timing("sensing"):
        assert [pool["num_threads"] for pool in threadpool_info()] == before


def test_a_stage_that_fails_is_still_counted():
    """An interrupted stage leaves its time and the thread limits behind in order."""
    clock, before = StageClock(), [pool["num_threads"] for pool in threadpool_info()]
    with pytest.raises(KeyboardInterrupt), clock.planning("map"):
        raise KeyboardInterrupt
    assert set(clock.read()) == {"map"}
    assert [pool["num_threads"] for pool in threadpool_info()] == before


def test_planning_is_not_charged_with_the_work_of_others():
    """A planning stage that waits (here: sleeps) costs next to nothing; sensing is timed by the wall."""
    clock, pause = StageClock(), 0.1
    with clock.planning("map"):
        time.sleep(pause)
    with clock.timing("sensing"):
        time.sleep(pause)
    spent = clock.read()
    assert spent["map"].thread_s < pause / 2 < pause <= spent["sensing"].wall_s
