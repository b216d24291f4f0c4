"""What a triangle mesh encloses: welded corners, open edges, signed volume, connected surfaces."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, Num
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from scenes.scene import Mesh

WELD_TOLERANCE = 1e-7
"""Corners within this distance are one point; STL repeats each corner per triangle [m] (choice: a hundredth of the
0.01 mm to which text files are often rounded, and more than the rounding of 32-bit numbers at 1 m)."""


@dataclass(frozen=True, eq=False)
class SharedEdges:
    """Edges that exactly two triangles share, as pairs of half-edges.

    Half-edge 3 f + i runs from corner i of triangle f to its next corner.
    """

    half_edges: Int[np.ndarray, "k 2"]
    same_sense: Bool[np.ndarray, "k"]
    """True where both triangles run the edge in the same sense: one of them is wound the wrong way."""

    @property
    def triangles(self) -> Int[np.ndarray, "k 2"]:
        """The two triangles at each edge."""
        return self.half_edges // 3


def welded(vertices: Float[np.ndarray, "n 3"], tolerance: float = WELD_TOLERANCE) -> Int[np.ndarray, "n"]:
    """Index of the point that each vertex stands on: vertices within `tolerance` share it, however they are stored.

    By distance, not by the cells of a grid, whose borders part what is near. A chain of near points is one point.
    """
    first, place = distinct_rows(vertices)
    near = KDTree(vertices[first]).query_pairs(tolerance, output_type="ndarray")
    return connected(len(first), near)[place] if len(near) else place


def distinct_rows(rows: Num[np.ndarray, "n k"]) -> tuple[Int[np.ndarray, "d"], Int[np.ndarray, "n"]]:
    """First index of each distinct row, and which of them each row is; ten times faster than numpy's unique rows."""
    group = np.zeros(len(rows), np.int64)
    for column in rows.T:
        _, value = np.unique(column, return_inverse=True)
        _, group = np.unique(group * (value.max(initial=0) + 1) + value, return_inverse=True)
    return np.unique(group, return_index=True)[1], group


def face_normals(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> Float[np.ndarray, "m 3"]:
    """Normal of every triangle, counter-clockwise outward, with twice the triangle's area as length [m^2]."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def unit_face_normals(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> Float[np.ndarray, "m 3"]:
    """Unit normal of every triangle, counter-clockwise outward [-]; zero for triangles without area."""
    normals = face_normals(vertices, faces)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)


def signed_volume(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> float:
    """Enclosed volume [m^3] by the divergence theorem, positive if the faces look outward."""
    centred = vertices - vertices[faces].mean(axis=(0, 1))  # keeps the digits of a part far from the origin
    a, b, c = (centred[faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def open_edge_count(mesh: Mesh) -> int:
    """Number of edges that are not run exactly once each way; 0 means that the mesh is watertight."""
    edges = half_edges(welded(mesh.vertices)[mesh.faces])
    base = edges.max() + 1
    forward, counts = np.unique(edges @ [base, 1], return_counts=True)
    return int(np.count_nonzero(counts > 1) + np.count_nonzero(~np.isin(forward, edges @ [1, base])))


def half_edges(faces: Int[np.ndarray, "m 3"]) -> Int[np.ndarray, "h 2"]:
    """Start and end corner of every half-edge, three a triangle."""
    return faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)


def shared_edges(faces: Int[np.ndarray, "m 3"]) -> SharedEdges:
    """The edges between two triangles; `faces` holds welded indices."""
    edges = half_edges(faces)
    _, edge, counts = np.unique(np.sort(edges, axis=1) @ [edges.max() + 1, 1], return_inverse=True, return_counts=True)
    order = np.argsort(edge, kind="stable")
    pairs = order[counts[edge[order]] == 2].reshape(-1, 2)
    return SharedEdges(pairs, edges[pairs[:, 0], 0] == edges[pairs[:, 1], 0])


def connected(count: int, pairs: Int[np.ndarray, "k 2"]) -> Int[np.ndarray, "n"]:
    """Label of the connected component of each of `count` nodes, given the pairs that are linked."""
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return connected_components(graph, directed=False)[1]
