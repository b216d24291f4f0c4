"""glTF 2.0 and GLB: the triangles of every mesh, placed as the scene graph says; a node with a mesh is a body.

CAD kernels write one primitive per face, or per colour; the primitives of a mesh are one body.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.transform import Rotation

from materials.input_error import InputError
from scenes.cad.cad_file import (
    CadFile,
    RawBody,
    check_triangle_count,
    damaged,
    distinct_names,
    shown,
    used_only,
)
from scenes.cad.gltf_buffers import COMPONENTS, FULL_SCALE, Buffers
from scenes.cad.gltf_extensions import check_required, check_stored
from scenes.cad.gltf_tree import GltfMesh, Node, Primitive

TRIANGLES, STRIP, FAN = 4, 5, 6
"""Modes of a primitive; those below are points and lines (3.7.2.1)."""
OUT_OF_BOUNDS = 1e-3
"""Share of a mesh's extent by which positions may leave their stated bounds without a word (choice: writers round)."""
MOST_UNKNOWN = 5
"""Unknown properties that are named (choice: one is enough to see that something is wrong)."""

Triangles = tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "m 3"]]


def read_gltf_file(path: Path, data: bytes) -> CadFile:
    """The bodies of a glTF file, in metres if its writer heeds the format."""
    reader = _Reader(Buffers(path, data))
    placed = list(reader.placed(reader.roots(), np.eye(4)))
    check_triangle_count(path, sum(reader.triangle_count(node.mesh or 0) for node, _ in placed))
    names, bodies = [], []
    for node, place in placed:
        vertices, faces = reader.triangles(node.mesh or 0)
        if len(faces):
            names.append(node.name or reader.mesh(node.mesh or 0).name)
            bodies.append(_moved(vertices, faces, place))
    named = zip(distinct_names(names), bodies, strict=True)
    return CadFile(
        tuple(RawBody(name, *used_only(vertices, faces)) for name, (vertices, faces) in named),
        tuple(reader.notices),
        points=bool(placed),
    )


def _moved(vertices: np.ndarray, faces: np.ndarray, place: Float[np.ndarray, "4 4"]) -> Triangles:
    """At its place; a mirror turns the winding over (3.7.4)."""
    with np.errstate(all="ignore"):  # numbers that overflow are reported later, by body
        moved = vertices @ place[:3, :3].T + place[:3, 3]
        mirrored = np.linalg.det(place[:3, :3]) < 0
    return moved, faces[:, ::-1] if mirrored else faces


class _Reader:
    """Reads every mesh of a file once."""

    def __init__(self, buffers: Buffers) -> None:
        self.buffers = buffers
        self.path, self.tree = buffers.path, buffers.tree
        unknown = sorted(set(self.tree.unknown()))
        self.notices = [f"glTF has no property `{shown(name)}`; it is left out" for name in unknown[:MOST_UNKNOWN]]
        self._meshes: dict[int, Triangles] = {}
        check_required(self.path, self.tree.extensionsRequired)

    def roots(self) -> list[int]:
        """The nodes of the scene that is shown; without scenes, those that are nobody's child."""
        if self.tree.scenes:
            return self.buffers.entry("scenes", self.tree.scene or 0).nodes
        children = {child for node in self.tree.nodes for child in node.children}
        return [i for i in range(len(self.tree.nodes)) if i not in children]

    def placed(self, roots: list[int], place: Float[np.ndarray, "4 4"]) -> Iterator[tuple[Node, np.ndarray]]:
        """Nodes with a mesh and their places, depth first; InputError where the graph is no tree (3.5.2)."""
        seen: set[int] = set()
        stack = [(index, place) for index in reversed(roots)]
        while stack:
            index, parent = stack.pop()
            node: Node = self.buffers.entry("nodes", index)
            if index in seen:
                raise damaged(self.path, f"node {index} {shown(node.name)} stands in its scene twice")
            seen.add(index)
            with np.errstate(all="ignore"):
                own = parent @ self._matrix(index, node)
            if node.mesh is not None:
                self._check(index, node)
                yield node, own
            stack += [(child, own) for child in reversed(node.children)]
        shown_meshes = {self.tree.nodes[i].mesh for i in seen}
        hidden = sum(i not in seen and node.mesh is not None for i, node in enumerate(self.tree.nodes))
        unused = len(set(range(len(self.tree.meshes))) - shown_meshes)
        if hidden or unused:
            self.notices.append(f"{max(hidden, unused)} meshes are in no scene that is shown, and left out")

    def _matrix(self, index: int, node: Node) -> Float[np.ndarray, "4 4"]:
        """From the node to its parent."""
        if node.matrix is not None:
            return np.array(node.matrix).reshape(4, 4).T
        if not any(node.rotation):
            raise damaged(self.path, f"node {index} {shown(node.name)} has a rotation of four zeros")
        matrix = np.eye(4)
        matrix[:3, :3] = Rotation.from_quat(node.rotation).as_matrix() * node.scale
        matrix[:3, 3] = node.translation
        return matrix

    def _check(self, index: int, node: Node) -> None:
        check_stored(self.path, node.extensions)
        mesh = self.mesh(node.mesh or 0)
        if node.skin is not None or any(node.weights or mesh.weights):
            raise InputError(
                f"{self.path}: node {index} {shown(node.name)} is bent by a skin or by morph targets, which are not "
                "read; export it at rest, as a rigid mesh"
            )

    def mesh(self, index: int) -> GltfMesh:
        """Mesh of the tree."""
        return self.buffers.entry("meshes", index)

    def triangle_count(self, index: int) -> int:
        """Triangles of a mesh."""
        return len(self.triangles(index)[1])

    def triangles(self, index: int) -> Triangles:
        """All primitives of a mesh as one."""
        if index not in self._meshes:
            pieces = [self._primitive(f"mesh {index}", item) for item in self.mesh(index).primitives]
            offsets = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
            self._meshes[index] = (
                np.concatenate([vertices for vertices, _ in pieces]),
                np.concatenate([faces + offset for (_, faces), offset in zip(pieces, offsets, strict=False)]),
            )
        return self._meshes[index]

    def _primitive(self, what: str, item: Primitive) -> Triangles:
        check_stored(self.path, item.extensions)
        nothing = np.zeros((0, 3)), np.zeros((0, 3), np.int64)
        if item.mode < TRIANGLES:
            return nothing
        if "POSITION" not in item.attributes:
            raise damaged(self.path, f"{what} has no positions")
        positions = self.buffers.numbers(item.attributes["POSITION"])
        if positions.shape[1] != 3:
            raise damaged(self.path, f"the positions of {what} are not of three numbers")
        self._compare_bounds(what, item.attributes["POSITION"], positions)
        corners = self._corners(what, item, len(positions))
        return positions.astype(float), corners[_triangles(item.mode, len(corners))]

    def _corners(self, what: str, item: Primitive, known: int) -> Int[np.ndarray, "c"]:
        if item.indices is None:
            corners = np.arange(known)
        else:
            table = self.buffers.numbers(item.indices)
            if table.dtype.kind != "u" or table.shape[1] != 1:
                raise damaged(self.path, f"the indices of {what} are no whole numbers")
            corners = table[:, 0].astype(np.int64)
        if len(corners) < 3 or (item.mode == TRIANGLES and len(corners) % 3):
            raise damaged(self.path, f"{what} has {len(corners)} corners, which make no whole triangles")
        if corners.max() >= known:
            raise damaged(self.path, f"{what} names vertex {corners.max()}, but there are {known}, from 0 on")
        return corners

    def _compare_bounds(self, what: str, index: int, positions: np.ndarray) -> None:
        """A notice where positions leave the box that the file states for them (3.6.2.5): one of both is damaged."""
        accessor = self.buffers.entry("accessors", index)
        if accessor.min is None or accessor.max is None or len(accessor.min) != 3 or len(accessor.max) != 3:
            return
        kind = COMPONENTS[accessor.componentType][1:]
        unit = FULL_SCALE.get(kind, 1) if accessor.normalized else 1
        stated = np.array([accessor.min, accessor.max]) / unit
        with np.errstate(all="ignore"):
            found = np.stack([positions.min(axis=0), positions.max(axis=0)]).astype(float)
            apart = np.abs(found - stated).max()
            if not apart <= OUT_OF_BOUNDS * np.ptp(found, axis=0).max():
                self.notices.append(f"{what} does not fill the bounds that the file states for it; is it damaged?")


def _triangles(mode: int, count: int) -> Int[np.ndarray, "m 3"]:
    """Which corners make each triangle (3.7.2.1); every second one of a strip is wound the other way."""
    if mode == TRIANGLES:
        return np.arange(count).reshape(-1, 3)
    first = np.arange(count - 2)
    if mode == FAN:
        return np.column_stack([first + 1, first + 2, np.zeros_like(first)])
    odd = first % 2
    return np.column_stack([first, first + 1 + odd, first + 2 - odd])
