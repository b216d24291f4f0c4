"""Parts A-D from the committed meshes, each body with the material that the real thing has."""

import functools
import json
from pathlib import Path
from typing import Any

from materials.catalog import material
from materials.input_error import InputError
from scenes.mesh_files import read_mesh
from scenes.scene import Body, Mesh

MESH_FOLDER = Path(__file__).parent / "meshes"
PART_NAMES = ("A", "B", "C", "D")


def part_bodies(name: str) -> tuple[Body, ...]:
    """The bodies of part A, B, C or D: resting on the table (lowest z = 0), bounding box over the origin [m]."""
    bodies = _part(name)["bodies"]
    return tuple(
        Body(entry["name"], _mesh(entry["file"]), material(entry["material"]), is_part=True) for entry in bodies
    )


def part_description(name: str) -> str:
    """What the part is, in a few words."""
    return _part(name)["description"]


def _part(name: str) -> dict[str, Any]:
    if name not in PART_NAMES:
        raise InputError(f"part {name}: there is none; choose {', '.join(PART_NAMES[:-1])} or {PART_NAMES[-1]}")
    return manifest()["parts"][name]


@functools.cache
def manifest() -> dict[str, Any]:
    """What `scenes/meshes/manifest.json` says: units, licence, authoring versions, bodies with material and hash."""
    return json.loads((MESH_FOLDER / "manifest.json").read_text())


@functools.cache
def _mesh(file: str) -> Mesh:
    """Read once a process; meshes are never changed in place."""
    return read_mesh(MESH_FOLDER / file)
