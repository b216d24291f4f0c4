"""Time per stage of the loop: planning on one thread by that thread's processor time, all else by the wall.

On an idle machine the two are the same for planning. On a busy one, such as in a study with a worker for each
processor, wall time would charge the planner with the work of others.
"""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

from threadpoolctl import ThreadpoolController


class Spent(NamedTuple):
    """What a stage took [s]."""

    wall_s: float
    """By the clock on the wall."""
    thread_s: float
    """Processor time of the thread that runs the stage."""
    process_s: float
    """Processor time of all threads of the process."""


class StageClock:
    """Adds up the time spent in named stages until it is read.

    Stages do not overlap and run on the thread that made the clock.
    Time outside a stage is not counted; that of a stage inside another one would count twice.
    """

    def __init__(self) -> None:
        self._spent: dict[str, Spent] = {}
        # Listing the loaded libraries takes milliseconds, so it is done once and not at every stage.
        self._threads = ThreadpoolController()

    @contextmanager
    def planning(self, stage: str) -> Iterator[None]:
        """Time a computation, on one BLAS and OpenMP thread: on small arrays two are up to 40 times slower."""
        with self._threads.limit(limits=1), self.timing(stage):
            yield

    @contextmanager
    def timing(self, stage: str) -> Iterator[None]:
        """Time anything else, whose threads are its own affair."""
        start = _now()
        try:
            yield
        finally:
            sums = zip(self._spent.get(stage, Spent(0.0, 0.0, 0.0)), _now(), start, strict=True)
            self._spent[stage] = Spent(*(so_far + end - began for so_far, end, began in sums))

    def read(self) -> dict[str, Spent]:
        """What each stage took since the last reading."""
        spent, self._spent = self._spent, {}
        return spent


def _now() -> Spent:
    return Spent(time.perf_counter(), time.thread_time(), time.process_time())
