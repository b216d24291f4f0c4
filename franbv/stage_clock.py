"""Time per stage of the loop: planning on one thread by that thread's processor time, all else by the wall.

On an idle machine the two are the same for planning. On a busy one, such as in a study with a worker for each
processor, wall time would charge the planner with the work of others.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from threadpoolctl import ThreadpoolController


class StageClock:
    """Adds up the time [s] spent in named stages until it is read.

    Planning counts the processor time of the thread that plans, all else counts wall time; why, stands at the head of
    the module. Time outside a stage is not counted, that of a stage inside another one twice.
    """

    def __init__(self) -> None:
        self._seconds: dict[str, float] = {}
        # Listing the loaded libraries takes milliseconds, so it is done once and not at every stage.
        self._threads = ThreadpoolController()

    @contextmanager
    def planning(self, stage: str) -> Iterator[None]:
        """Time a computation, on one BLAS and OpenMP thread: on small arrays two are up to 40 times slower."""
        with self._threads.limit(limits=1), self._timing(stage, time.thread_time):
            yield

    @contextmanager
    def timing(self, stage: str) -> Iterator[None]:
        """Time anything else, whose threads are its own affair."""
        with self._timing(stage, time.perf_counter):
            yield

    @contextmanager
    def _timing(self, stage: str, clock: Callable[[], float]) -> Iterator[None]:
        start = clock()
        try:
            yield
        finally:
            self._seconds[stage] = self._seconds.get(stage, 0.0) + clock() - start

    def read(self) -> dict[str, float]:
        """Seconds by stage since the last reading."""
        seconds, self._seconds = self._seconds, {}
        return seconds
