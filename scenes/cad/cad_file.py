"""What a CAD file holds once it is read: named bodies in the file's unit, and what the reader had to say."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from materials.input_error import InputError

MAX_TRIANGLES = 2_000_000
"""Largest file that is taken [-] (choice: 300,000 load in 6 s, so this many in well under a minute)."""
SHOWN_NAME = 60
"""Characters of a name that a file gives, at most, in a message (choice: the line stays readable)."""


@dataclass(frozen=True, eq=False)
class RawBody:
    """One body as the file has it."""

    name: str
    vertices: Float[np.ndarray, "n 3"]
    """In the file's unit."""
    faces: Int[np.ndarray, "m 3"]


@dataclass(frozen=True)
class CadFile:
    """The content of a file."""

    bodies: tuple[RawBody, ...]
    notices: tuple[str, ...] = ()
    """One line each, without the file's name: what was left out or looks wrong."""
    points: bool = False
    """Whether it holds points or curves, of which no surface can be made."""
    unit: str | None = None
    """The unit that the file states for itself, in words; None where its format has no place for one."""


def damaged(path: Path, what: str) -> InputError:
    """The error for a file that breaks the rules of its format; `what` says which, and where."""
    return InputError(f"{path}: cannot be read as {format_name(path)} ({what}); export it again")


def format_name(path: Path) -> str:
    """The format that the file's name promises, in capitals."""
    return {"STP": "STEP"}.get(path.suffix[1:].upper(), path.suffix[1:].upper())


def shown(name: str) -> str:
    """A name or word from a file, short and printable, for a message."""
    printable = "".join(letter if letter.isprintable() else "?" for letter in name)
    return printable if len(printable) <= SHOWN_NAME else f"{printable[: SHOWN_NAME - 3]}..."


def plain_text(data: bytes) -> str:
    """The bytes as text: UTF-8, else Latin-1, in which every byte is a letter; no format here names its charset."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def file_name(path: Path) -> str:
    """Name of the file as text that can be written anywhere: bytes that are no UTF-8 are read as Latin-1."""
    return plain_text(os.fsencode(path.name))


def file_stem(path: Path) -> str:
    """The same without its ending."""
    return plain_text(os.fsencode(path.stem))


def distinct_names(names: Sequence[str]) -> list[str]:
    """The names with `_1`, `_2` ... behind those that are there already; nothing becomes `body`."""
    taken: set[str] = set()
    distinct = []
    for name in names:
        base = one_line(name) or "body"
        candidate, count = base, 0
        while candidate in taken:
            count += 1
            candidate = f"{base}_{count}"
        taken.add(candidate)
        distinct.append(candidate)
    return distinct


def one_line(name: str) -> str:
    """The name with every run of blanks and line breaks as one blank, control characters dropped."""
    return "".join(letter for letter in " ".join(name.split()) if letter.isprintable())


def used_only(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> tuple[np.ndarray, np.ndarray]:
    """The vertices that the faces use, and the faces on them."""
    used, faces = np.unique(faces, return_inverse=True)
    return vertices[used], faces.reshape(-1, 3)


def unused(vertex_count: int, corners: Sequence[int] | Int[np.ndarray, "c"]) -> tuple[str, ...]:
    """A notice where vertices belong to no face: numbers that are shifted, or faces that are missing."""
    left = vertex_count - len(np.unique(np.asarray(corners)))
    what = f"{left} of its {vertex_count} vertices belong to no face; if something looks wrong, export it again"
    return (what,) if left else ()


def check_triangle_count(path: Path, count: int) -> None:
    """InputError for more triangles than can be worked on."""
    if count > MAX_TRIANGLES:
        raise InputError(f"{path}: {count} triangles; export it coarser, at most {MAX_TRIANGLES}")
