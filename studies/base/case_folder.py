"""Cases: one folder per resolved configuration, named by its hash, that either exists complete or does not exist.

A case is written under a temporary name beside its final one, flushed to disk and renamed. A process that dies leaves
at most the temporary folder, whose name starts with a dot; the same command takes it up, another one clears it away.
"""

import contextlib
import hashlib
import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel

from materials.input_error import InputError
from studies.base.atomic_file import DIGEST_BYTES, folder_lock, install
from studies.base.output_errors import output_errors, prepare_output

CASE_FORMAT = 1
"""Version of what a case folder holds; raising it makes every case a new one. Choice: a plain count."""

PARTIAL_PREFIX = ".partial-"
"""Start of the name of a folder that is still being written."""

PROGRESS = "captures"
"""The one sub-folder whose files outlive an interrupted process: each is complete in itself, so a run can go on."""


def canonical_json(config: BaseModel) -> str:
    """The configuration as JSON with sorted keys and no spaces: equal configurations give equal text."""
    return json.dumps(config.model_dump(mode="json"), sort_keys=True, separators=(",", ":"), allow_nan=False)


def case_digest(command: str, config: BaseModel) -> str:
    """Name of the case that `command` makes of `config`: blake2b in hexadecimal."""
    text = json.dumps({"command": command, "format": CASE_FORMAT}, sort_keys=True) + canonical_json(config)
    return hashlib.blake2b(text.encode(), digest_size=DIGEST_BYTES).hexdigest()


def finished_case(out: Path, digest: str) -> Path | None:
    """The folder of the case if it is complete, else None."""
    folder = out / digest
    return folder if folder.is_dir() else None


@contextlib.contextmanager
def writing(out: Path, digest: str) -> Iterator[Path]:
    """A folder to write the case in; on leaving it is flushed to disk and renamed to its final name.

    It may already hold PROGRESS files of an interrupted process. When the block raises, those are kept for the next
    one and all else is removed. InputError when another process is writing the same case.
    """
    prepare_output(out)
    _clear_abandoned(out, except_for=digest)
    partial = out / f"{PARTIAL_PREFIX}{digest}"
    with output_errors(out), _locked(partial):
        try:
            _keep_progress_only(partial)
            yield partial
            install(partial, out / digest)
        except BaseException:
            _keep_progress_only(partial)
            if not _has_progress(partial):
                shutil.rmtree(partial, ignore_errors=True)
            raise


def _has_progress(partial: Path) -> bool:
    return any((partial / PROGRESS).glob("[!.]*"))


def _keep_progress_only(partial: Path) -> None:
    """Remove everything in an unfinished case but its PROGRESS files."""
    for path in partial.glob("*"):
        if path.is_dir() and path.name != PROGRESS:
            shutil.rmtree(path)
        elif not path.is_dir():
            path.unlink()
    for path in (partial / PROGRESS).glob(".*"):
        path.unlink()


@contextlib.contextmanager
def _locked(partial: Path) -> Iterator[None]:
    """Create the folder if need be and hold it."""
    partial.mkdir(exist_ok=True)
    with folder_lock(partial) as descriptor:
        if descriptor is None:
            raise InputError(f"{partial.parent}: another process writes this very case; wait for it to end")
        # Between creating and locking the folder another process may have finished and renamed it.
        if not partial.is_dir() or not os.path.samestat(os.fstat(descriptor), partial.stat()):
            raise InputError(f"{partial.parent}: another process has just finished this case; give the command again")
        yield


def _clear_abandoned(out: Path, except_for: str) -> None:
    """Remove unfinished cases that nobody writes and that hold nothing worth going on from."""
    for partial in out.glob(f"{PARTIAL_PREFIX}*"):
        if partial.name == f"{PARTIAL_PREFIX}{except_for}" or not partial.is_dir() or _has_progress(partial):
            continue
        with folder_lock(partial) as held:
            if held is not None:
                shutil.rmtree(partial, ignore_errors=True)
