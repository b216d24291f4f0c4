"""Independent jobs in worker processes: one display, a dead worker costs its job one more try, results as with one.

Every study hands its cases over as jobs that write their own folder, so nothing is sent back and nothing depends on who
does what when. A worker that dies, even of SIGABRT inside a compiler, takes down no other. Workers end with the process
that started them, however that ends, so that the same command can take the work up again at once.
"""

import os
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing import connection
from typing import Any

from materials.input_error import InputError
from studies.base.console import progress_bar
from studies.work.worker_process import Worker

MOST_JOBS = 64
"""Jobs after which a worker is replaced. Choice: a renderer's memory grows with every scene that it has seen, and a
new worker costs some seconds."""
MOST_TRIES = 2
"""How often a job is begun before it counts as failed. Choice: what a crowded machine broke is mended by a second try,
what the job itself breaks is not mended by a third."""


@dataclass(frozen=True)
class Job:
    """A call in another process; it leaves its result on disk."""

    name: str
    """For people."""
    work: Callable[[Any], None]
    """A function of a module, so that another process can import it."""
    argument: Any
    """Anything that can be pickled."""


@dataclass(frozen=True)
class Failure:
    """A job that was given up."""

    name: str
    reason: str
    """One line."""
    futile: bool = False
    """Every other job meets the same, until somebody mends it."""


def run_jobs(
    stages: Sequence[Sequence[Job]],
    workers: int,
    prepare: Callable[[int], None] | None = None,
    already_done: int = 0,
    tell: Callable[[Failure], None] = lambda _: None,
) -> list[Failure]:
    """Do all jobs, stage after stage, on this many processes; returns those that were given up.

    prepare: called first in every worker with the number of threads that it may use.
    already_done: jobs of an earlier run that the display counts as finished.
    tell: called with each job as soon as it is given up.
    """
    pool = _Pool(workers, prepare, tell)
    failures: list[Failure] = []
    with progress_bar() as progress:
        task = progress.add_task("starting", total=already_done + sum(map(len, stages)), completed=already_done)

        def show(name: str, finished: bool) -> None:
            progress.update(task, description=name, advance=int(finished))

        try:
            for jobs in stages:
                failures += pool.run(jobs, show)
        finally:
            pool.close()
    return failures


def thread_share(workers: int) -> int:
    """Threads for each of this many workers: the processors that this process may use, shared out, at least one."""
    return max(1, usable_processors() // workers)


def worker_count(wanted: int | None) -> int:
    """How many workers to use: as many as wanted, None = one for each processor; InputError below 1."""
    if wanted is not None and wanted < 1:
        raise InputError(f"--workers {wanted}: there must be someone to do the work; give 1 or more")
    return usable_processors() if wanted is None else wanted


def usable_processors() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def limit_renderer(threads: int) -> None:
    """Let Dr.Jit and OpenCV use this many threads; for `run_jobs`."""
    import cv2

    from render.world import backend

    cv2.setNumThreads(threads)
    backend.thread_count(threads)


class _Pool:
    """Workers that are started when they are needed and replaced when they die or have done enough."""

    def __init__(self, size: int, prepare: Callable[[int], None] | None, tell: Callable[[Failure], None]) -> None:
        self._size, self._prepare, self._tell = size, prepare, tell
        self._futile: str | None = None  # why no further job need be tried
        self._idle: list[Worker] = []
        self._busy: dict[Any, tuple[Worker, Job, int]] = {}  # by connection: worker, its job, how often it was begun

    def run(self, jobs: Sequence[Job], show: Callable[[str, bool], None]) -> list[Failure]:
        """Do one stage."""
        waiting = deque((job, 1) for job in jobs)
        failures: list[Failure] = []

        def give_up(job: Job, reason: str) -> None:
            failures.append(Failure(job.name, reason, self._futile is not None))
            self._tell(failures[-1])
            show(job.name, True)

        while waiting or self._busy:
            if waiting and self._futile:
                give_up(waiting.popleft()[0], self._futile)
                continue
            while waiting and len(self._busy) < self._size:
                job, tries = waiting.popleft()
                show(job.name, False)
                self._begin(job, tries)
            for ready in connection.wait(list(self._busy)):
                worker, job, tries = self._busy.pop(ready)
                fault = worker.outcome()
                if fault is None:
                    show(job.name, True)
                elif fault.futile or tries >= MOST_TRIES:
                    self._futile = fault.reason if fault.futile else self._futile
                    give_up(job, fault.reason)
                else:
                    waiting.append((job, tries + 1))
                self._keep_or_end(worker)
        return failures

    def _begin(self, job: Job, tries: int) -> None:
        worker = self._idle.pop() if self._idle else Worker.started(self._prepare, thread_share(self._size))
        self._busy[worker.connection] = (worker, job, tries)
        worker.begin(job.work, job.argument)

    def _keep_or_end(self, worker: Worker) -> None:
        if worker.dead or worker.calls >= MOST_JOBS:
            worker.end()
        else:
            self._idle.append(worker)

    def close(self) -> None:
        """Stop whatever still runs."""
        workers = [*self._idle, *(worker for worker, _, _ in self._busy.values())]
        for worker in workers:
            worker.stop()
        for worker in workers:
            worker.end()
