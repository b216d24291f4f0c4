"""Turn the triangles of a body outward: consistent with their neighbours, cavities inward."""

import numpy as np
from jaxtyping import Bool, Float, Int

from scenes.topology import connected, shared_edges, signed_volume, welded


def turned_outward(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> tuple[Int[np.ndarray, "m 3"], int]:
    """The same triangles with every connected surface wound consistently and outward, and how many were turned.

    vertices: corners [m]. A surface that lies wholly inside another one is a cavity and looks into itself.
    An open surface has no outside; it keeps the winding that most of its triangles have.
    """
    place = welded(vertices)[faces]
    points = np.zeros((place.max() + 1, 3))
    points[place] = vertices[faces]
    turned = _against_neighbours(place)
    place = np.where(turned[:, None], place[:, ::-1], place)
    shell = connected(len(place), shared_edges(place).triangles)
    members = np.split(np.argsort(shell, kind="stable"), np.cumsum(np.bincount(shell))[:-1])
    boxes = np.stack([_box(points, place[faces]) for faces in members])
    for own, box in zip(members, boxes, strict=True):
        around = (boxes[:, 0] < box[0]).all(axis=1) & (boxes[:, 1] > box[1]).all(axis=1)
        cavity = bool(around.any()) and _inside(points, place[own], place[around[shell]])
        if _is_closed(place[own]) and (signed_volume(points, place[own]) > 0) == cavity:
            turned[own] ^= True
    return np.where(turned[:, None], faces[:, ::-1], faces), int(turned.sum())


def _against_neighbours(faces: Int[np.ndarray, "m 3"]) -> Bool[np.ndarray, "m"]:
    """Triangles to turn so that neighbours agree, the lesser part of each connected surface.

    Every triangle is two nodes, as it is (i) and turned (i + m). Neighbours that agree link equal nodes, others
    opposite ones; the component of a surface's first triangle then holds the consistent state of all the others.
    """
    count = len(faces)
    shared = shared_edges(faces)
    a, b = shared.triangles.T
    swap = shared.same_sense * count
    label = connected(
        2 * count, np.concatenate([np.column_stack([a, b + swap]), np.column_stack([a + count, b + count - swap])])
    )
    shell = connected(count, shared.triangles)
    first = np.unique(shell, return_index=True)[1]
    turned = label[:count] != label[first][shell]
    mostly = np.bincount(shell, weights=turned) > 0.5 * np.bincount(shell)
    return turned ^ mostly[shell]


def _is_closed(faces: Int[np.ndarray, "m 3"]) -> bool:
    """Whether every edge of these triangles lies between two of them."""
    return 2 * len(shared_edges(faces).half_edges) == 3 * len(faces)


def _box(points: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> Float[np.ndarray, "2 3"]:
    corners = points[faces].reshape(-1, 3)
    return np.stack([corners.min(axis=0), corners.max(axis=0)])


def _inside(points: Float[np.ndarray, "n 3"], inner: Int[np.ndarray, "m 3"], outer: Int[np.ndarray, "k 3"]) -> bool:
    """Whether the six extreme corners of `inner` lie inside the surfaces `outer`.

    One corner would not do: a bolt drawn into its block starts inside the block, yet is no cavity.
    """
    corners = points[np.unique(inner)]
    extremes = corners[np.concatenate([corners.argmin(axis=0), corners.argmax(axis=0)])]
    return all(_crossings(corner, points, outer) % 2 == 1 for corner in extremes)


def _crossings(origin: Float[np.ndarray, "3"], points: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> int:
    """How many triangles a ray from `origin` in a fixed skew direction meets (Moeller and Trumbore 1997)."""
    direction = np.array([0.5377, 0.3183, 0.7807])  # skew: meets no edge of an axis-aligned block
    a, b, c = (points[faces[:, i]] for i in range(3))
    p = np.cross(direction, c - a)
    determinant = np.einsum("ij,ij->i", b - a, p)
    scale = np.where(determinant == 0, np.inf, determinant)
    q = np.cross(origin - a, b - a)
    u = np.einsum("ij,ij->i", origin - a, p) / scale
    v = q @ direction / scale
    distance = np.einsum("ij,ij->i", c - a, q) / scale
    return int(np.count_nonzero((u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 0)))
