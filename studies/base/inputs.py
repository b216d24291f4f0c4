"""No command may overwrite what it reads: a file is told by what it is, not by the path that leads to it."""

from collections.abc import Iterable
from pathlib import Path

from materials.input_error import InputError


def check_not_overwritten(inputs: Iterable[Path | None], outputs: Iterable[Path]) -> None:
    """InputError where a file that would be written is one that is read, by whatever path, symbolic or hard link."""
    read = [path for path in inputs if path is not None]
    for output in outputs:
        for path in read:
            if is_same_file(output, path):
                raise InputError(f"{output}: is the input {path}, which would be lost; choose another --out")


def check_outside(inputs: Iterable[Path | None], folder: Path) -> None:
    """InputError where an input lies in a folder whose files a command writes, renews and removes."""
    for path in inputs:
        if path is not None and path.resolve().is_relative_to(folder.resolve()):
            raise InputError(f"{path}: lies in {folder}, where files are written and removed; move it out of there")


def is_same_file(one: Path, other: Path) -> bool:
    """Whether two paths lead to one file; False where either leads to none."""
    try:
        return one.samefile(other)
    except OSError:
        return False
