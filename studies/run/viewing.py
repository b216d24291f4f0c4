"""A run in the viewer while it lasts (`franbv.adapters.view`), with what is wrong told as bad input."""

import contextlib
from collections.abc import Iterator

from franbv.adapters.view import opening
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
def shown_in_browser(wanted: bool, title: str, invalid_share: float) -> Iterator[ViewSink | None]:
    """`franbv.adapters.view.opening.shown_live`, whose words go to stderr."""
    with view_errors(), opening.shown_live(wanted, title, invalid_share, warn) as view:
        yield view
