"""Wall time per stage of the loop, each stage on one thread where threads would slow it down."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import ThreadpoolController


class StageClock:
    """Adds up the time spent in named stages until it is read."""

    def __init__(self) -> None:
        self._seconds: dict[str, float] = {}
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
        start = time.perf_counter()
        try:
            yield
        finally:
            self._seconds[stage] = self._seconds.get(stage, 0.0) + time.perf_counter() - start

    def read(self) -> dict[str, float]:
        """Seconds by stage since the last reading."""
        seconds, self._seconds = self._seconds, {}
        return seconds
