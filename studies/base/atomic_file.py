"""Files and folders that are there whole or not at all, flushed to disk; locks on folders; hashes of files."""

import contextlib
import fcntl
import hashlib
import os
from collections.abc import Iterator
from pathlib import Path

DIGEST_BYTES = 8
"""Length of a hash that names a case or a file [bytes]. Choice: among a million cases two share a name with a chance of
3e-8."""


def file_digest(path: Path) -> str:
    """blake2b of a file's bytes in hexadecimal, so that a case depends on what an input file holds, not on its name."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=DIGEST_BYTES)).hexdigest()


def folder_digest(folder: Path) -> str:
    """The same of all files in a folder and below: of their names in it, in order, and of their bytes."""
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    whole = hashlib.blake2b(digest_size=DIGEST_BYTES)
    for name in names:
        whole.update(f"{name}\0{file_digest(folder / name)}\0".encode(errors="surrogateescape"))
    return whole.hexdigest()


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


def install(partial: Path, target: Path) -> None:
    """Flush a folder that is complete, rename it to its final name, and flush that it is there."""
    flush_tree(partial)
    os.rename(partial, target)
    flush(target.parent)


@contextlib.contextmanager
def folder_lock(folder: Path) -> Iterator[int | None]:
    """Hold a folder as long as the block runs: its descriptor, None where another process holds it.

    The lock goes with the process, whatever ends it. Where a file system cannot lock folders (some NFS) nobody can
    know, and it counts as held.
    """
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        yield descriptor if _locked(descriptor) else None
    finally:
        os.close(descriptor)


def _locked(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True
