"""The same jobs on Dask workers: each is one task, tried again elsewhere when it fails, then reported.

Every worker must reach the study's folder under the same path (a shared file system). `dask worker --nthreads 1` wants
no more threads: one process does one job at a time. `--lifetime 1h --lifetime-restart` recycles workers.
"""

import contextlib
import os
import secrets
import socket
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from materials.input_error import InputError
from studies.base.console import progress_bar
from studies.base.output_errors import FutileError
from studies.work.maker import Maker, maker
from studies.work.worker_process import THREAD_VARIABLES, exception_line
from studies.work.workers import MOST_TRIES, Failure, Job, limit_renderer

CONNECT_S = 10
"""How long the scheduler may take to answer [s] (choice)."""
ANSWER_S = 120
"""How long workers may take to say what they are; busy ones say it later [s] (choice: a renderer starts in seconds)."""
_ONE_AT_A_TIME = threading.Lock()
"""A renderer has one state a process, whatever the number of its worker's threads."""


@dataclass(frozen=True)
class DaskExecutor:
    """Workers of a scheduler that answers."""

    client: Any
    address: str
    """Of the scheduler."""
    resource: str | None
    """Name of the Dask resource that a worker must have, such as GPU; None = any worker."""
    workers: tuple[str, ...]
    """Addresses of those that have it."""

    @property
    def limits(self) -> dict[str, int] | None:
        """What a task takes of its worker."""
        return {self.resource: 1} if self.resource else None

    def check_folder(self, folder: Path) -> None:
        """InputError unless every worker reads in this folder what is written here."""
        token, path = secrets.token_hex(16), folder / f".token-{secrets.token_hex(8)}"
        path.write_text(token)
        try:
            seen = cast(dict[str, str | None], self.client.run(_read, str(path), workers=list(self.workers)))
        finally:
            path.unlink()
        if any(text != token for text in seen.values()):
            raise InputError(
                f"{folder}: a worker of {self.address} does not see this folder; put it on a shared file system"
            )

    def answers(self, question: Callable[[], Any]) -> dict[str, Any]:
        """What the workers say to it, by their address, each on the thread that renders; busy ones are left out."""
        from distributed import wait

        futures = {
            worker: self.client.submit(_do, _asked, question, pure=False, workers=[worker], resources=self.limits)
            for worker in self.workers
        }
        with self.client.as_current(), contextlib.suppress(TimeoutError):
            wait(list(futures.values()), timeout=ANSWER_S)
        for worker, future in futures.items():
            if future.status == "error":
                raise InputError(f"worker {worker}: cannot render ({exception_line(future.exception())})")
        self.client.cancel([future for future in futures.values() if future.status != "finished"])
        return {worker: future.result() for worker, future in futures.items() if future.status == "finished"}

    def makers(self) -> dict[str, Maker]:
        """What makes results on the workers that answer, by their address."""
        return {f"worker {address}": found for address, found in self.answers(maker).items()}

    def run(
        self,
        stages: Sequence[Sequence[Job]],
        already_done: int = 0,
        tell: Callable[[Failure], None] = lambda _: None,
    ) -> list[Failure]:
        """Do the jobs, stage after stage; returns those that were given up, each of them told as soon as it is."""
        failures: list[Failure] = []
        with progress_bar() as progress:
            task = progress.add_task("on Dask", total=already_done + sum(map(len, stages)), completed=already_done)

            def show(name: str) -> None:
                progress.update(task, description=name, advance=1)

            for jobs in stages:
                for failure in self._stage(jobs, show):
                    failures.append(failure)
                    tell(failure)
                if any(failure.futile for failure in failures):
                    break
        return failures

    def _stage(self, jobs: Sequence[Job], show: Callable[[str], None]) -> Iterator[Failure]:
        """Do the jobs of one stage; yields those that are given up. A futile one takes all that wait with it."""
        from distributed import as_completed

        names = {
            self.client.submit(
                _do, job.work, job.argument, key=f"{job.name}-{os.urandom(8).hex()}", pure=False,
                resources=self.limits, retries=MOST_TRIES - 1,
            ): job.name
            for job in jobs
        }  # fmt: skip
        waiting = dict.fromkeys(names)
        for future in as_completed(list(names), loop=self.client.loop):
            show(names[future])
            del waiting[future]
            if future.status == "finished":
                continue
            error = future.exception()
            futile = isinstance(error, FutileError)
            reason = exception_line(error) if error else f"the scheduler at {self.address} was lost"
            yield from (Failure(names[one], reason, futile) for one in ([future, *waiting] if futile else [future]))
            if futile:
                self.client.cancel(list(waiting))
                return


@contextlib.contextmanager
def dask_executor(address: str, resource: str | None) -> Iterator[DaskExecutor]:
    """The workers of the scheduler at `address`; InputError where none answers or none has the resource."""
    try:
        from distributed import Client
        from distributed.comm.addressing import parse_address, parse_host_port
        from distributed.comm.registry import get_backend
    except ImportError:
        raise InputError("--scheduler needs Dask; pip install 'franbv[cluster]'") from None
    try:
        scheme, place = parse_address(address)
        get_backend(scheme)  # a client that cannot connect complains when it is collected, so ask before
        if scheme in ("tcp", "tls"):
            socket.create_connection(parse_host_port(place), CONNECT_S).close()
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {address}: no scheduler answers there ({error}); check the address") from None
    with client:
        workers = client.scheduler_info(n_workers=-1)["workers"]
        if not workers:
            raise InputError(f"--scheduler {address}: has no workers; start some with `dask worker {address}`")
        able = tuple(name for name, one in workers.items() if not resource or resource in one.get("resources", {}))
        if not able:
            raise InputError(
                f"--resource {resource}: no worker of {address} has it; start one with `--resources {resource}=1`"
            )
        yield DaskExecutor(client, address, resource, able)


def _read(path: str) -> str | None:
    try:
        return Path(path).read_text()
    except OSError:
        return None


def _asked(question: Callable[[], Any]) -> Any:
    return question()


def _do(work: Any, argument: Any) -> Any:
    """On the worker: one thread, one scene at a time, as in the local pool with one worker for each processor."""
    with _ONE_AT_A_TIME:
        _prepare()
        return work(argument)


def _prepare() -> None:
    from threadpoolctl import threadpool_limits

    os.environ.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    threadpool_limits(1)
    limit_renderer(1)
