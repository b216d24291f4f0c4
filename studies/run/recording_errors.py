"""What is wrong with a recording, told as bad input."""

from collections.abc import Iterator
from contextlib import contextmanager

from franbv.adapters.recording.contents import RecordingError
from materials.input_error import InputError


@contextmanager
def recording_errors() -> Iterator[None]:
    """InputError, with the same line, for a RecordingError."""
    try:
        yield
    except RecordingError as error:
        raise InputError(str(error)) from error
