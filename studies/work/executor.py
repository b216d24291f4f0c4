"""Who does a study's jobs: processes of this machine, or Dask workers; the same bytes from both.

Everything that is made of cases hands its jobs over here. A job writes its own folder, whole or not at all, so nothing
is sent back, nothing depends on who did what when, and the same command takes up what is missing.
"""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Protocol, runtime_checkable

import tyro

from materials.input_error import InputError
from studies.base.console import warn
from studies.work.dask_executor import dask_executor
from studies.work.maker import Maker, agreed_maker, versions
from studies.work.workers import Failure, Job, limit_renderer, run_jobs, worker_count


@dataclass(frozen=True)
class WorkFlags:
    """The flags of every command that hands jobs over."""

    workers: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Worker processes on this machine; the default is one for each processor."""
    scheduler: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None
    """Dask scheduler whose workers do it instead, such as tcp://host:8786."""
    resource: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None
    """Only on Dask workers with this resource, such as GPU."""


@runtime_checkable
class Executor(Protocol):
    """Does jobs."""

    def run(
        self,
        stages: Sequence[Sequence[Job]],
        already_done: int = 0,
        tell: Callable[[Failure], None] = lambda _: None,
    ) -> list[Failure]:
        """Do all jobs, stage after stage; returns those that were given up.

        already_done: jobs of an earlier run that the display counts as finished.
        tell: called with each job as soon as it is given up.
        """
        ...

    def check_folder(self, folder: Path) -> None:
        """InputError unless everyone who does jobs sees what is written into this folder here."""
        ...

    def makers(self) -> dict[str, Maker]:
        """What makes results elsewhere, by who it is, as far as they answer; nothing of this machine."""
        ...


@dataclass(frozen=True)
class LocalExecutor:
    """Processes of this machine."""

    workers: int

    def run(
        self,
        stages: Sequence[Sequence[Job]],
        already_done: int = 0,
        tell: Callable[[Failure], None] = lambda _: None,
    ) -> list[Failure]:
        """As `Executor.run`."""
        return run_jobs(stages, self.workers, limit_renderer, already_done, tell)

    def check_folder(self, folder: Path) -> None:
        """They see what we see."""

    def makers(self) -> dict[str, Maker]:
        """Nobody is elsewhere."""
        return {}


@contextlib.contextmanager
def executor_of(flags: WorkFlags) -> Iterator[Executor]:
    """The executor that the flags ask for; InputError where they contradict each other or no scheduler answers."""
    workers = worker_count(flags.workers)
    if flags.resource and not flags.scheduler:
        raise InputError("--resource is for --scheduler; leave it out")
    if flags.workers is not None and flags.scheduler:
        raise InputError("--workers is for this machine; leave it out, since the scheduler has workers of its own")
    if not flags.scheduler:
        yield LocalExecutor(workers)
        return
    with dask_executor(flags.scheduler, flags.resource) as dask:
        yield dask


def check_alike(executor: Executor, folder: Path, finished: Sequence[tuple[str, Maker]] = ()) -> None:
    """InputError unless all who work on the study see its folder, and are alike in what decides results.

    finished: what made the cases that are there, by their name. Where this machine differs from those it is said and
    not refused: cases that are finished stay as they are.
    """
    executor.check_folder(folder)
    elsewhere = executor.makers()
    renderers = {who: {"renderer": maker["renderer"]} for who, maker in elsewhere.items()}
    agreed_maker([("this machine", versions()), *((who, without_renderer(one)) for who, one in elsewhere.items())])
    agreed_maker(list(renderers.items()))
    try:
        agreed_maker([("this machine", versions()), *finished])
    except InputError as error:
        warn(f"{folder}: {str(error).partition(';')[0]}; tables and report will mix the two")


def without_renderer(maker: Maker) -> Maker:
    """Its versions and instruction set: what must agree between a machine with a GPU and one without."""
    return {name: value for name, value in maker.items() if name != "renderer"}


def reasons_once(program: str) -> Callable[[Failure], None]:
    """Says why a job was given up as soon as it is, once for each reason: a full disk fails every job alike."""
    told: set[str] = set()

    def tell(failure: Failure) -> None:
        if failure.reason not in told:
            told.add(failure.reason)
            warn(f"{program}: {failure.name}: {failure.reason}")

    return tell


def exit_status(failures: Sequence[Failure]) -> int:
    """Of a study: 0 done, 1 jobs were given up, 2 all would have been for one reason that a person can mend."""
    return 2 if any(failure.futile for failure in failures) else 1 if failures else 0
