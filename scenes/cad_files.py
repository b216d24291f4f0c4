"""Read the triangles of a CAD file: the file is checked, and the reader of its format makes named bodies of it."""

import importlib.util
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from materials.input_error import InputError
from scenes.cad.cad_file import CadFile, file_stem, format_name
from scenes.cad.gltf import read_gltf_file
from scenes.cad.obj import read_obj_file
from scenes.cad.ply import read_ply_file
from scenes.cad.step import read_step_file
from scenes.cad.stl import read_stl_file

READERS: dict[str, Callable[[Path, bytes], CadFile]] = {
    ".stl": read_stl_file,
    ".ply": read_ply_file,
    ".obj": read_obj_file,
    ".glb": read_gltf_file,
    ".gltf": read_gltf_file,
    ".step": read_step_file,
    ".stp": read_step_file,
}
"""Ending -> reader."""
MOST_BYTES = 2**30
"""Bytes (choice: the most triangles that are taken, as text; larger ones would fill the memory first)."""


def read_cad_file(path: Path) -> CadFile:
    """All bodies of the file, placed as it says, sorted by distinct names; at least one triangle in each."""
    _check_file(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror}); check its permissions") from error
    read = READERS[path.suffix.lower()](path, data)
    if not read.bodies:
        what = "points or curves but no triangles" if read.points else "no geometry"
        raise InputError(f"{path}: the file is empty: it holds {what}; export the solid as a mesh")
    if len(read.bodies) == 1:
        return replace(read, bodies=(replace(read.bodies[0], name=file_stem(path)),))
    return replace(read, bodies=tuple(sorted(read.bodies, key=lambda body: body.name)))


def _check_file(path: Path) -> None:
    if not path.exists():
        raise InputError(f"{path}: no such file; check the path")
    if not path.is_file():
        raise InputError(f"{path}: is a folder; give one mesh file")
    if path.suffix.lower() not in READERS:
        formats = ", ".join(ending[1:].upper() for ending in READERS if ending != ".stp")
        raise InputError(f"{path}: not a mesh file; give {formats}")
    if path.stat().st_size == 0:
        raise InputError(f"{path}: the file is empty (0 bytes); export it again")
    if path.stat().st_size > MOST_BYTES:
        raise InputError(f"{path}: the file has {path.stat().st_size} bytes; export it coarser, at most {MOST_BYTES}")
    if format_name(path) == "STEP" and importlib.util.find_spec("cascadio") is None:
        raise InputError(f'{path}: STEP needs an extra; pip install "franbv[step]", or export STL')
