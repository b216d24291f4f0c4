"""Files that are there whole or not at all, flushed to disk, and the hash of what they hold."""

import hashlib
import os
from pathlib import Path

DIGEST_BYTES = 8
"""Length of a hash that names a case or a file [bytes]. Choice: among a million cases two share a name with a chance of
3e-8."""


def file_digest(path: Path) -> str:
    """blake2b of a file's bytes in hexadecimal, so that a case depends on what an input file holds, not on its name."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=DIGEST_BYTES)).hexdigest()


def write_atomically(path: Path, data: bytes) -> None:
    """Write a file under a temporary name, flush it to disk and rename it."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        with temporary.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
        flush(path.parent)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def flush_tree(folder: Path) -> None:
    """fsync every file and folder below `folder`, and itself."""
    for path in sorted(folder.rglob("*")):
        flush(path)
    flush(folder)


def flush(path: Path) -> None:
    """fsync a file, or a folder so that a rename in it is on disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
