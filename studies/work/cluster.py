"""The same scenes on Dask workers: each scene is one task, tried again elsewhere when it fails, then reported.

Every worker must reach the dataset's folder under the same path (a shared file system). `dask worker --nthreads 1`
wants no more threads: one process renders one scene at a time. `--lifetime 1h --lifetime-restart` recycles workers.
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
from studies.work.worker_process import THREAD_VARIABLES, one_line
from studies.work.workers import MOST_TRIES, Failure, Job, limit_renderer

CONNECT_S = 10
"""How long the scheduler may take to answer [s] (choice)."""
ANSWER_S = 120
"""How long workers may take to say what they are; busy ones say it later [s] (choice: a renderer starts in seconds)."""
_ONE_AT_A_TIME = threading.Lock()
"""A renderer has one state a process, whatever the number of its worker's threads."""


@dataclass(frozen=True)
class Cluster:
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
        token, path = secrets.token_hex(16), folder / f"token-{secrets.token_hex(8)}"
        path.write_text(token)
        try:
            seen = cast(dict[str, str | None], self.client.run(_read, str(path), workers=list(self.workers)))
        finally:
            path.unlink()
        if any(text != token for text in seen.values()):
            raise InputError(
                f"{folder.parent}: a worker of {self.address} does not see this folder; put it on a shared file system"
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
                raise InputError(f"worker {worker}: cannot render ({one_line(future.exception())})")
        self.client.cancel([future for future in futures.values() if future.status != "finished"])
        return {worker: future.result() for worker, future in futures.items() if future.status == "finished"}

    def run(self, jobs: Sequence[Job], tell: Callable[[Failure], None] = lambda _: None) -> list[Failure]:
        """Do the jobs; returns those that were given up, each of them told as soon as it is."""
        from distributed import as_completed

        names = {}
        for job in jobs:
            future = self.client.submit(
                _do, job.work, job.argument, key=f"{job.name}-{os.urandom(8).hex()}", pure=False,
                resources=self.limits, retries=MOST_TRIES - 1,
            )  # fmt: skip
            names[future] = job.name
        failures, waiting = [], dict.fromkeys(names)
        with progress_bar() as progress:
            task = progress.add_task("on the cluster", total=len(jobs))
            for future in as_completed(list(names), loop=self.client.loop):
                progress.update(task, advance=1)
                del waiting[future]
                if future.status == "finished":
                    continue
                error, futile = future.exception(), isinstance(future.exception(), FutileError)
                given_up = [future, *waiting] if futile else [future]
                reason = one_line(error) if error else f"the scheduler at {self.address} was lost"
                failures += [Failure(names[one], reason, futile) for one in given_up]
                for failure in failures[-len(given_up) :]:
                    tell(failure)
                if futile:
                    self.client.cancel(list(waiting))
                    break
        return failures


@contextlib.contextmanager
def connected(address: str, resource: str | None) -> Iterator[Cluster]:
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
        yield Cluster(client, address, resource, able)


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
