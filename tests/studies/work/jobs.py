"""What the workers of the tests do. They are given a folder and leave files there, as cases do."""

import errno
import os
import signal
import time
from pathlib import Path

from studies.base.case_folder import writing
from studies.base.output_errors import output_errors


def note(path: Path) -> None:
    """Write which process this is."""
    path.write_text(str(os.getpid()))


def note_threads(path: Path) -> None:
    """Write what the numerical libraries of this process will read."""
    path.write_text(os.environ["OMP_NUM_THREADS"])


def prepare_by_variable(threads: int) -> None:
    """Leave a mark that later jobs of the same process find."""
    os.environ["PREPARED_WITH"] = str(threads)


def note_preparation(path: Path) -> None:
    """Write the mark."""
    path.write_text(os.environ.get("PREPARED_WITH", "nothing"))


def refuse_to_prepare(threads: int) -> None:
    """Fail as a machine without a renderer does."""
    raise RuntimeError("no renderer here")


def abort_once(path: Path) -> None:
    """Die as LLVM does when it is too old, the first time."""
    tried = path.with_suffix(".tried")
    if not tried.exists():
        tried.touch()
        os.abort()
    note(path)


def abort(path: Path) -> None:
    """Die whenever it is tried, and count."""
    with path.open("a") as file:
        file.write("x")
    os.abort()


def complain(path: Path) -> None:
    """Fail in Python, and count."""
    with path.open("a") as file:
        file.write("x")
    raise ValueError("no such\nthing")


def meet_a_full_disk(path: Path) -> None:
    """Fail as every write to a full disk does, and count."""
    with path.open("a") as file:
        file.write("x")
    with output_errors(path.parent):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def linger_in_a_case(out: Path) -> None:
    """Write half a case and stay there."""
    with writing(out, "abc") as folder:
        (folder / "half.txt").write_text("h")
        (out / "pid").write_text(str(os.getpid()))
        time.sleep(60)


def linger_deaf(out: Path) -> None:
    """The same, deaf to polite requests."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    linger_in_a_case(out)
