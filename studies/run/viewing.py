"""A run in the viewer while it lasts (`franbv.adapters.view`), and what the commands say of that."""

import contextlib
import sys
from collections.abc import Iterator

from franbv.adapters.view.opening import live_page
from franbv.adapters.view.sight import ViewError, ViewSink
from materials.input_error import InputError
from studies.base.console import warn


@contextlib.contextmanager
def view_errors() -> Iterator[None]:
    """What is wrong with a view, as bad input."""
    try:
        yield
    except ViewError as error:
        raise InputError(str(error)) from error


@contextlib.contextmanager
def shown_live(wanted: bool, title: str, invalid_share: float) -> Iterator[ViewSink | None]:
    """What shows a run on a page, whose address goes to stderr; None where none is wanted.

    The page lasts as long as the block. At its end it stays for whoever sits before it, until Enter is pressed: a
    replay is over before a browser has opened. Where nobody can press it, it ends.
    """
    if not wanted:
        yield None
        return
    with view_errors(), live_page(title, invalid_share, _say_where) as view:
        yield view
        if sys.stdin.isatty():
            warn("The page stays until Enter is pressed.")
            sys.stdin.readline()


def _say_where(url: str) -> None:
    warn(f"Watch it at {url}")
