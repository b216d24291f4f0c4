"""Parts from the committed meshes, each body with the material that the real thing has.

A-D are the paper's objects, as its authors photographed them; A1-D1 are an earlier set of parts of those
kinds; E1-E4 are what the paper shows without numbers, right in kind and not in every detail.
"""

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
"""The paper's own objects."""
EARLIER_PARTS = ("A1", "B1", "C1", "D1")
"""An earlier set, with which datasets are balanced and the sensor's figures made."""
EXTRA_PARTS = ("E1", "E2", "E3", "E4")
"""Concave things that the paper shows pictures of, and no numbers."""
ALL_PARTS = (*PART_NAMES, *EARLIER_PARTS, *EXTRA_PARTS)
"""Whatever `--part` finds here."""


def part_bodies(name: str) -> tuple[Body, ...]:
    """The bodies of one of `ALL_PARTS`: resting on the table (lowest z = 0), bounding box over the origin [m]."""
    bodies = _part(name)["bodies"]
    return tuple(
        Body(entry["name"], _mesh(entry["file"]), material(entry["material"]), is_part=True) for entry in bodies
    )


def part_description(name: str) -> str:
    """What the part is, in a few words."""
    return _part(name)["description"]


def _part(name: str) -> dict[str, Any]:
    if name not in ALL_PARTS:
        raise InputError(f"part {name}: there is none; choose {', '.join(ALL_PARTS[:-1])} or {ALL_PARTS[-1]}")
    return manifest()["parts"][name]


@functools.cache
def manifest() -> dict[str, Any]:
    """What `scenes/meshes/manifest.json` says: units, licence, authoring versions, bodies with material and hash."""
    return json.loads((MESH_FOLDER / "manifest.json").read_text())


@functools.cache
def _mesh(file: str) -> Mesh:
    """Read once a process; meshes are never changed in place."""
    return read_mesh(MESH_FOLDER / file)
