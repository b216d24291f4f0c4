"""Opens a view of a run, as a file or as a page, and says which extra is missing where one is.

with rrd_file(path, "Part D", parameters.invalid_share) as view:
    reconstruct(camera, arm, planner, parameters, seed, observe=view.observe)
"""

import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from franbv.adapters.view.entities import APPLICATION
from franbv.adapters.view.sight import ViewError, ViewSink

RRD = ".rrd"
"""Suffix by which the viewer knows its files."""
PACKAGES_OF_VIEW = ("rerun", "rerun_bindings", "rerun_cli")
"""What the extra `view` brings."""


@contextlib.contextmanager
def view_extra() -> Iterator[None]:
    """ViewError where the package of the extra is asked for and not installed."""
    try:
        yield
    except ImportError as error:
        if (error.name or "").split(".")[0] not in PACKAGES_OF_VIEW:
            raise
        raise ViewError("views need the package rerun-sdk; pip install 'franbv[view]'") from error


def check_rrd(path: Path) -> None:
    """ViewError for a file that could not be written in the end: another kind, one that is there, a missing package."""
    if path.suffix != RRD:
        raise ViewError(f"{path}: the viewer knows its files by {RRD}; give a file FILE{RRD}")
    if path.exists():
        raise ViewError(f"{path}: is there already, and is never written over; name another file")
    if not path.parent.is_dir():
        raise ViewError(f"{path}: there is no folder {path.parent}; make it, or name another file")
    with view_extra():
        import rerun  # noqa: F401


@contextlib.contextmanager
def rrd_file(path: Path, title: str, invalid_share: float) -> Iterator[ViewSink]:
    """A view that becomes a file when the block ends, whole or, if the block raises, not at all.

    title: what the viewer calls the run; invalid_share: as in `Parameters`. The view is held in memory until then: a
    run's is some megabytes, and what the disk says of them is heard. ViewError as `check_rrd` has it.
    """
    check_rrd(path)
    stream = _stream(title)
    memory = stream.memory_recording()
    yield _view(stream, invalid_share)
    data = memory.drain_as_bytes()
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        _write(temporary, data)
        check_rrd(path)  # it may have come while the run lasted
        os.replace(temporary, path)
    except OSError as error:
        raise ViewError(f"{path}: cannot be written ({error.strerror}); name another file") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def live_page(title: str, invalid_share: float, say: Callable[[str], None]) -> Iterator[ViewSink]:
    """A view that a browser on this computer shows while the block lasts; `say` is given its address.

    The arguments are those of `rrd_file`.
    """
    with view_extra():
        from franbv.adapters.view.server import serving
    stream = _stream(title)
    with serving() as page:
        stream.connect_grpc(page.data_url)
        view = _view(stream, invalid_share)
        say(page.url)
        try:
            yield view
        finally:
            page.hand_over(stream)


@contextlib.contextmanager
def shown_live(wanted: bool, title: str, invalid_share: float, say: Callable[[str], None]) -> Iterator[ViewSink | None]:
    """What shows a run on a page, for a command; None where none is wanted. What people must know goes to `say`.

    The page lasts as long as the block. At its end it stays for whoever sits before it, until Enter is pressed: a
    replay is over before a browser has opened. Where nobody can press it, it ends.
    """
    if not wanted:
        yield None
        return
    with live_page(title, invalid_share, lambda url: say(f"Watch it at {url}")) as view:
        yield view
        if sys.stdin.isatty():
            say("The page stays until Enter is pressed.")
            sys.stdin.readline()


def _stream(title: str) -> Any:
    """One that keeps no clock times, so that acquisitions are the only timeline."""
    with view_extra():
        import rerun as rr
    stream = rr.RecordingStream(APPLICATION)
    if not rr.is_enabled(recording=stream):
        raise ViewError("RERUN in the environment turns the viewer off; unset it")
    stream.set_log_time_enabled(False)
    stream.send_recording_name(title)
    return stream


def _view(stream: Any, invalid_share: float) -> ViewSink:
    from franbv.adapters.view.run_view import RunView

    return RunView(stream, invalid_share)


def _write(path: Path, data: bytes) -> None:
    with path.open("xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
