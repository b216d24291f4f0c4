"""Where things are in a dataset, and folders that are there whole or not at all."""

import contextlib
import errno
import json
import os
import secrets
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from materials.input_error import InputError
from studies.base.atomic_file import file_digest, install
from studies.base.output_errors import output_errors

SPLIT = "train"
"""BOP's name for what may be trained on."""
DATASET, INDEX, CARD, CAMERA, MODELS = "dataset.json", "index.json", "README.md", "camera.json", "models"
MANIFEST, SCENE, STATISTICS = "manifest.json", "scene.json", "statistics.json"
WORK = ".work"
"""Unfinished folders and times, gone when the dataset is complete."""
LARGEST_FILE = 256 * 2**20
"""Nothing larger is read [bytes] (choice: a hundred times the largest image)."""


def scene_name(number: int) -> str:
    """Folder of a scene below SPLIT."""
    return f"{number:06d}"


def compact_json(values: Mapping[Any, Any]) -> bytes:
    """One top-level entry a line, keys in their order."""
    lines = (f"  {json.dumps(str(key))}: {json.dumps(value, allow_nan=False)}" for key, value in values.items())
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()


def read_json(path: Path) -> Any:
    """The content of a JSON file of bounded size; ValueError in one line otherwise."""
    return json.loads(bounded_bytes(path))


def bounded_bytes(path: Path) -> bytes:
    """A regular file's bytes, if it is no larger than LARGEST_FILE."""
    if path.is_symlink() or not path.is_file():
        raise ValueError(f"{path}: is missing, or no regular file")
    with path.open("rb") as file:
        data = file.read(LARGEST_FILE + 1)
    if len(data) > LARGEST_FILE:
        raise ValueError(f"{path}: is larger than {LARGEST_FILE >> 20} MiB")
    return data


def listed_files(folder: Path) -> dict[str, list]:
    """Size and hash of every file below a folder, by path in it."""
    paths = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): [path.stat().st_size, file_digest(path)] for path in paths}


@contextlib.contextmanager
def written_whole(root: Path, target: Path) -> Iterator[Path]:
    """A folder to fill; on leaving it is flushed to disk and renamed to `target`.

    Its name is used once, so that workers on many machines need no lock. If another process was faster its folder
    stays: both hold the same bytes.
    """
    partial = root / WORK / f"{target.name}-{secrets.token_hex(8)}"
    with output_errors(root):
        partial.mkdir(parents=True)
        try:
            yield partial
            target.parent.mkdir(parents=True, exist_ok=True)
            try:
                install(partial, target)
            except OSError as error:
                if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
                    raise
        finally:
            shutil.rmtree(partial, ignore_errors=True)


def removed_at_once(root: Path, path: Path) -> None:
    """Take a scene's folder, or whatever is in its place, away whole, then delete it.

    A process that still fills it finds it gone and fails; deleted file by file it could be filled on and be installed
    without what it had lost.
    """
    gone = root / WORK / f"gone-{secrets.token_hex(8)}"
    with contextlib.suppress(FileNotFoundError):  # it was finished or removed meanwhile
        os.rename(path, gone)
    if gone.is_dir() and not gone.is_symlink():
        shutil.rmtree(gone, ignore_errors=True)
    else:
        gone.unlink(missing_ok=True)


def existing_dataset(path: Path) -> Path:
    """The folder, if it holds a dataset; InputError otherwise."""
    if not path.is_dir():
        raise InputError(f"{path}: no such folder; give the one that `franbv dataset make` wrote")
    if not (path / DATASET).is_file():
        raise InputError(f"{path}: holds no {DATASET}, so it is no dataset; give the folder that `make` wrote")
    return path
