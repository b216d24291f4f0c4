"""The same scenes on Dask workers: each scene is one task, tried again elsewhere when it fails, then reported.

Every worker must reach the dataset's folder under the same path (a shared file system). `dask worker --nthreads 1`
wants no more threads: one process renders one scene at a time.
"""

import os
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

from materials.input_error import InputError
from studies.console import progress_bar
from studies.worker_process import THREAD_VARIABLES
from studies.workers import MOST_TRIES, Failure, Job, limit_renderer

CONNECT_S = 10
"""How long the scheduler may take to answer [s] (choice)."""
_ONE_AT_A_TIME = threading.Lock()
"""A renderer has one state a process, whatever the number of its worker's threads."""


def run_on_cluster(jobs: Sequence[Job], address: str, resource: str | None, root: Path) -> list[Failure]:
    """Do the jobs on the workers of the scheduler at `address`; returns those that were given up.

    resource: name of the Dask resource that a worker must have, such as GPU; None = any worker.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError("--scheduler needs Dask; pip install 'franbv[cluster]'") from None
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {address}: no scheduler answers there ({error}); check the address") from None
    with client:
        _check_workers(client.scheduler_info(n_workers=-1)["workers"].values(), address, resource)
        seen = cast(dict[str, bool], client.run(_sees, str(root)))
        if not all(seen.values()):
            raise InputError(f"{root}: a worker of {address} does not see this folder; put it on a shared file system")
        limits = {resource: 1} if resource else None
        names = {}
        for job in jobs:
            future = client.submit(
                _do, job.work, job.argument, key=f"{job.name}-{os.urandom(8).hex()}", pure=False, resources=limits,
                retries=MOST_TRIES - 1,
            )  # fmt: skip
            names[future] = job.name
        failures = []
        with progress_bar() as progress:
            task = progress.add_task("on the cluster", total=len(jobs))
            for future in as_completed(list(names), loop=client.loop):
                if future.status != "finished":
                    failures.append(Failure(names[future], _reason(future)))
                progress.update(task, advance=1)
    return failures


def _check_workers(workers: Any, address: str, resource: str | None) -> None:
    if not workers:
        raise InputError(f"--scheduler {address}: has no workers; start some with `dask worker {address}`")
    if resource and not any(resource in worker.get("resources", {}) for worker in workers):
        raise InputError(
            f"--resource {resource}: no worker of {address} has it; start one with `--resources {resource}=1`"
        )


def _reason(future: Any) -> str:
    error = future.exception()
    return " ".join(f"{type(error).__name__}: {error}".split())


def _sees(root: str) -> bool:
    return os.path.isdir(root)


def _do(work: Any, argument: Any) -> None:
    """On the worker: one thread, one scene at a time, as in the local pool with one worker for each processor."""
    with _ONE_AT_A_TIME:
        _prepare()
        work(argument)


def _prepare() -> None:
    from threadpoolctl import threadpool_limits

    os.environ.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    threadpool_limits(1)
    limit_renderer(1)
