"""One worker process, seen from both sides: the handle that the pool holds, and the life of the process itself.

Functions travel pickled and are unpickled only when the process has limited its threads, because the numerical
libraries read those limits while they are imported.
"""

import contextlib
import os
import pickle
import signal
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

from materials.input_error import InputError
from studies.base.output_errors import FutileError

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Read by the numerical libraries when they are loaded."""
GRACE_S = 5.0
"""Time that a stopped worker gets to put its work away [s]. Choice: longer than any one rendering."""

_SPAWN = get_context("spawn")  # a fork would copy the renderer's threads in mid-flight


@dataclass(frozen=True)
class Fault:
    """Why a call failed."""

    reason: str
    """One line."""
    futile: bool = False
    """Whether all other calls would fail of the same."""


@dataclass
class Worker:
    """A process that makes the calls it is given, one after the other."""

    process: Any
    connection: Connection
    """Readable as soon as a call has ended, or the process has."""
    lifeline: Connection
    """Nothing is ever sent here: that it closes tells the worker that we are gone."""
    calls: int = 0
    dead: bool = False

    @classmethod
    def started(cls, prepare: Callable[[int], None] | None, threads: int) -> "Worker":
        """A new process; `prepare` is its first call, with the number of threads that it may use."""
        ours, theirs = _SPAWN.Pipe()
        watched, lifeline = _SPAWN.Pipe(duplex=False)
        process = _SPAWN.Process(target=_serve, args=(theirs, watched, pickle.dumps(prepare), threads), daemon=True)
        process.start()
        theirs.close()  # or we would not notice that the worker is dead
        watched.close()
        return cls(process, ours, lifeline)

    def begin(self, work: Callable[[Any], None], argument: Any) -> None:
        """Let the process call `work(argument)`."""
        self.calls += 1
        with contextlib.suppress(OSError):  # it died between two calls; `outcome` finds out
            self.connection.send_bytes(pickle.dumps((work, argument)))

    def outcome(self) -> Fault | None:
        """Why the last call failed; None if it did not. Waits for its end."""
        try:
            return self.connection.recv()
        except (EOFError, OSError):
            self.dead = True
            self.process.join()
            return Fault(_death(self.process.exitcode))

    def stop(self) -> None:
        """Ask the process to put its work away and go."""
        self.process.terminate()

    def end(self) -> None:
        """Let the process go, by force if it does not go by itself."""
        self.connection.close()
        self.process.join(GRACE_S)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
        self.lifeline.close()


def _death(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        return f"its process was ended by {signal.Signals(-exit_code).name}"
    return f"its process ended with exit status {exit_code}"


def _serve(calls: Connection, lifeline: Connection, prepare: bytes, threads: int) -> None:
    """The life of the process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; our parent decides
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # unwinds the case that is being written
    os.environ.update(dict.fromkeys(THREAD_VARIABLES, str(threads)))
    threading.Thread(target=_end_with_parent, args=(lifeline,), daemon=True).start()
    unprepared = _attempt(lambda: _prepare(prepare, threads))
    with contextlib.suppress(EOFError):  # the pool has let us go
        while True:
            call = calls.recv_bytes()
            calls.send(unprepared or _attempt(lambda pickled=call: _make(pickled)))


def _prepare(pickled: bytes, threads: int) -> None:
    prepare = pickle.loads(pickled)
    if prepare is not None:
        prepare(threads)


def _make(call: bytes) -> None:
    work, argument = pickle.loads(call)
    work(argument)


def _attempt(call: Callable[[], None]) -> Fault | None:
    """What went wrong; None if nothing did."""
    try:
        call()
    except Exception as error:
        return Fault(exception_line(error), isinstance(error, FutileError))
    return None


def exception_line(error: BaseException) -> str:
    """An exception's type and message without line breaks; the message alone where it is for people."""
    return " ".join((str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}").split())


def _end_with_parent(lifeline: Connection) -> None:
    with contextlib.suppress(EOFError, OSError):
        lifeline.recv_bytes()
    os._exit(1)
