"""System errors of the output folder that a person can mend, as one line."""

import contextlib
import errno
import os
from collections.abc import Iterator
from pathlib import Path

from materials.input_error import InputError

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)
"""Errors that every other case would meet as well."""

REASONS = {
    errno.ENOSPC: "the disk is full; free some space",
    errno.EDQUOT: "the disk quota is used up; free some space",
    errno.EROFS: "the file system is read-only; choose another folder",
    errno.EACCES: "no permission to write there; choose another folder",
    errno.EPERM: "no permission to write there; choose another folder",
    errno.ENOTDIR: "a part of this path is a file, not a folder; choose another folder",
    errno.EEXIST: "this is a file, not a folder; choose another folder",
    errno.ENAMETOOLONG: "the path is too long; choose a shorter --out",
}


class FutileError(InputError):
    """What every other case of the same command would fail of as well, so that none need be tried."""


def prepare_output(out: Path) -> None:
    """Create the output folder and prove that it can be written; InputError with the mend when it cannot."""
    with output_errors(out):
        out.mkdir(parents=True, exist_ok=True)
        probe = out / f".write-test-{os.getpid()}"
        probe.touch()
        probe.unlink()


@contextlib.contextmanager
def output_errors(out: Path) -> Iterator[None]:
    """Turn the system errors that a person can mend into one line; FutileError for those that every case would meet."""
    try:
        yield
    except OSError as error:
        elsewhere = error.filename is not None and not Path(os.fsdecode(error.filename)).is_relative_to(out)
        if out.is_dir() and (elsewhere or error.errno not in REASONS):
            raise
        reason = REASONS.get(error.errno or 0, f"{error.strerror or error}; choose another folder")
        kind = FutileError if error.errno in FULL else InputError
        raise kind(f"{out}: cannot write the output folder: {reason}") from error
