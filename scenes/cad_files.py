"""Read the triangles of a CAD file through trimesh, its scene graph flattened into named bodies."""

import importlib.util
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float, Int

from materials.input_error import InputError

FORMATS = (".stl", ".ply", ".obj", ".glb", ".gltf", ".step", ".stp")


@dataclass(frozen=True, eq=False)
class RawBody:
    """One body as the file has it."""

    name: str
    vertices: Float[np.ndarray, "n 3"]
    """In the file's unit."""
    faces: Int[np.ndarray, "m 3"]


def read_cad_file(path: Path) -> list[RawBody]:
    """All bodies of the file, placed as its scene graph says, with distinct names; at least one triangle in each."""
    _check_file(path)
    try:
        scene = trimesh.load_scene(path, process=False, split_objects=True, skip_materials=True)
    except Exception as error:  # trimesh raises whatever its parsers meet
        raise InputError(
            f"{path}: cannot be read as {_format(path)} ({_first_line(error)}); export it again"
        ) from error
    pieces: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {}
    for node in scene.graph.nodes_geometry:
        matrix, geometry_name = scene.graph[node]
        geometry = scene.geometry[geometry_name]
        if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
            used, faces = np.unique(geometry.faces, return_inverse=True)
            vertices = trimesh.transform_points(np.asarray(geometry.vertices, float)[used], matrix)
            pieces.setdefault(_body_name(scene, node, geometry), []).append((vertices, faces.reshape(-1, 3)))
    if not pieces:
        what = "points or curves but no triangles" if scene.geometry else "no geometry"
        raise InputError(f"{path}: the file is empty: it holds {what}; export the solid as a mesh")
    if len(pieces) == 1:
        pieces = {path.stem: next(iter(pieces.values()))}
    return [RawBody(name, *_together(pieces[name])) for name in sorted(pieces)]


def _body_name(scene: trimesh.Scene, node: str, geometry: trimesh.Trimesh) -> str:
    """Name of the node; glTF primitives of one mesh (CAD kernels write one per face) go by the node that they share."""
    shared = geometry.metadata.get("from_gltf_primitive", False)
    return str(scene.graph.transforms.parents[node] if shared else node)


def _together(pieces: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of several meshes as one."""
    offsets = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    faces = [faces + offset for (_, faces), offset in zip(pieces, offsets, strict=False)]
    return np.concatenate([vertices for vertices, _ in pieces]), np.concatenate(faces)


def _check_file(path: Path) -> None:
    if not path.exists():
        raise InputError(f"{path}: no such file; check the path")
    if not path.is_file():
        raise InputError(f"{path}: is a folder; give one mesh file")
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"{path}: not a mesh file; give {', '.join(f[1:].upper() for f in FORMATS[:-1])}")
    if path.stat().st_size == 0:
        raise InputError(f"{path}: the file is empty (0 bytes); export it again")
    if _format(path) == "STEP" and importlib.util.find_spec("cascadio") is None:
        raise InputError(f'{path}: STEP needs an extra; pip install "franbv[step]", or export STL')


def _format(path: Path) -> str:
    return {"STP": "STEP"}.get(path.suffix[1:].upper(), path.suffix[1:].upper())


def _first_line(error: Exception) -> str:
    text = str(error).strip().splitlines()
    return text[0][:80] if text else type(error).__name__
