"""Files that may be damaged: what is wrong with them is said in one line, and our own faults stay our own.

Only the reading itself stands inside `reading`; what is computed from a file that was read may raise what it will.
"""

import contextlib
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

import cv2

from materials.input_error import InputError

MALFORMED = (
    OSError,
    ValueError,  # of JSON, YAML, models, tables, text in another coding
    KeyError,
    IndexError,
    TypeError,
    AttributeError,
    OverflowError,
    RecursionError,
    EOFError,
    zipfile.BadZipFile,
    zlib.error,
    cv2.error,
)
"""What taking a damaged or malicious file apart can raise. A name that does not exist, a failed assertion, a missing
module are none of these: they are faults of this tool, whatever the file holds."""


@contextlib.contextmanager
def reading(path: Path, mend: str) -> Iterator[None]:
    """InputError with the file, the reason and the mend for whatever reading it raises; the cause is kept."""
    try:
        yield
    except InputError:
        raise
    except MALFORMED as error:
        words = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(f"{path}: cannot be read ({words}); {mend}") from error
