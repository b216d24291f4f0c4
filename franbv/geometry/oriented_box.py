"""Oriented bounding boxes of point sets: the object's box B_t and the boxes B_r of reflective regions.

The box is the smallest in volume among those with one face flush with a face of the convex hull. (The true optimum has
two adjacent faces flush with hull *edges*, O'Rourke 1985; demanding a flush face is the usual close substitute.) For a
given face direction the best turn about it is flush with a silhouette edge (rotating calipers), so the search is exact
within that family. Flat, line-like and single-point sets get the same treatment in fewer dimensions.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import ConvexHull

FLAT_SPREAD = 1e-6
"""Spread below this share of the largest spread counts as none: a choice far above rounding, far below a voxel."""

CHUNK = 2_000_000
"""Most projections held at once: a choice that keeps memory below about 50 MB for hulls of any size."""


@dataclass(frozen=True, eq=False)
class OrientedBox:
    """A box with its own axes: all centre + axes @ s with |s_i| <= half_extents_i.

    It stands for B_t, the object (paper, section III-A), and for B_r, the reflective regions (section V-A).
    `oriented_box` finds it around points, not always the smallest of all: see the head of the module. Sides may be 0.
    """

    centre: Float[np.ndarray, "3"]
    """Centre, world frame [m]."""
    axes: Float[np.ndarray, "3 3"]
    """Columns are the unit axes in the world frame, right-handed, longest side first."""
    half_extents: Float[np.ndarray, "3"]
    """Half of each side, along the columns of `axes` [m]."""

    def corners(self) -> Float[np.ndarray, "8 3"]:
        """The eight corners, world frame [m]."""
        signs = np.stack(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0], indexing="ij"), axis=-1).reshape(8, 3)
        return self.centre + (signs * self.half_extents) @ self.axes.T

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return float(8.0 * np.prod(self.half_extents))

    @property
    def half_diagonal(self) -> float:
        """Distance from the centre to a corner [m]."""
        return float(np.linalg.norm(self.half_extents))

    def contains(self, points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, "n"]:
        """Which points lie inside or on the surface (to 1 nm)."""
        return np.all(np.abs((points - self.centre) @ self.axes) <= self.half_extents + 1e-9, axis=1)

    def grown(self, margin: float) -> "OrientedBox":
        """The box with every face moved outwards by `margin` [m]."""
        return replace(self, half_extents=self.half_extents + margin)


def axis_aligned_box(lower: Float[np.ndarray, "3"], upper: Float[np.ndarray, "3"]) -> OrientedBox:
    """The box between two opposite corners, its axes along the world's, longest side first."""
    lower, upper = np.asarray(lower, float), np.asarray(upper, float)
    return _box(np.eye(3), lower, upper)


def oriented_box(points: Float[np.ndarray, "n 3"], minimum_side: float = 0.0) -> OrientedBox:
    """Smallest box around the points, no side shorter than `minimum_side` [m] (so that flat regions have a volume)."""
    if len(points) == 0:
        raise ValueError("a box around no points is undefined")
    points = np.asarray(points, float)
    _, spread, principal = np.linalg.svd(np.linalg.qr(points - points.mean(axis=0), mode="r"))
    rank = int(np.sum(spread > max(FLAT_SPREAD * spread[0], 1e-12)))
    if rank == 3:
        vertices, frames = _flush_frames_of_solid(points)
    elif rank == 2:
        vertices, frames = _flush_frames_of_sheet(points, principal)
    else:
        # Only the direction of a line matters, and nothing of a point: world axes are as good as any.
        vertices, frames = points, (_frame_around(principal[0]) if rank == 1 else np.eye(3))[None]
    axes = _smallest(vertices, frames, minimum_side)
    along = points @ axes
    lower, upper = along.min(axis=0), along.max(axis=0)
    missing = np.maximum(minimum_side - (upper - lower), 0.0) / 2
    return _box(axes, lower - missing, upper + missing)


def _flush_frames_of_solid(points):
    """Hull vertices (v, 3) and the frames (c, 3, 3) flush with a hull face and an edge of its silhouette."""
    hull = ConvexHull(points)
    normals = hull.equations[:, :3]  # (f, 3)
    # Each triangle's neighbour k lies across the edge opposite to its vertex k: every hull edge, each twice.
    edge_faces = np.stack([np.repeat(np.arange(len(normals)), 3), hull.neighbors.ravel()], axis=1)
    ends = hull.simplices[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)
    once = edge_faces[:, 0] < edge_faces[:, 1]
    edge_faces, ends = edge_faces[once], ends[once]
    edges = points[ends[:, 1]] - points[ends[:, 0]]  # (e, 3)
    directions = _distinct_directions(normals)  # (n, 3)
    front = directions @ normals.T > 0  # (n, f)
    on_silhouette = front[:, edge_faces[:, 0]] != front[:, edge_faces[:, 1]]  # (n, e)
    direction, edge = np.nonzero(on_silhouette)
    return points[hull.vertices], _frames(directions[direction], edges[edge])


def _flush_frames_of_sheet(points, principal):
    """Hull vertices (v, 3) of a flat set and the frames (c, 3, 3) flush with its plane and an edge of its outline."""
    flat = points @ principal[:2].T
    outline = ConvexHull(flat).vertices  # counter-clockwise
    edges = points[np.roll(outline, -1)] - points[outline]
    return points[outline], _frames(np.tile(principal[2], (len(edges), 1)), edges)


def _distinct_directions(normals):
    """Unit vectors without repeats, opposite ones counted once: coplanar triangles of a voxel hull are many."""
    rounded = np.round(normals, 6) + 0.0
    first = np.take_along_axis(rounded, np.argmax(rounded != 0, axis=1)[:, None], axis=1)
    _, index = np.unique(rounded * np.sign(first), axis=0, return_index=True)
    return normals[index]


def _frames(normals, edges):
    """Frames (c, 3, 3), columns (edge within the plane, third, normal); edges along the normal are dropped."""
    within = edges - np.sum(edges * normals, axis=1, keepdims=True) * normals
    length = np.linalg.norm(within, axis=1)
    usable = length > 1e-6 * np.linalg.norm(edges, axis=1)
    u, n = within[usable] / length[usable, None], normals[usable]
    return np.stack([u, np.cross(n, u), n], axis=-1)


def _frame_around(axis):
    """Some right-handed frame (3, 3) whose first column is `axis`."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    second = np.cross(axis, helper)
    second /= np.linalg.norm(second)
    return np.column_stack([axis, second, np.cross(axis, second)])


def _smallest(vertices, frames, minimum_side):
    """The frame (3, 3) whose box around the vertices has the least volume."""
    step = max(1, CHUNK // (3 * len(vertices)))
    volumes = []
    for start in range(0, len(frames), step):
        axes = frames[start : start + step].transpose(0, 2, 1).reshape(-1, 3)
        along = axes @ vertices.T  # (3c, v), one matrix product and contiguous rows: six times faster than per frame
        sides = (along.max(axis=1) - along.min(axis=1)).reshape(-1, 3)
        volumes.append(np.prod(np.maximum(sides, max(minimum_side, 1e-12)), axis=1))
    return frames[np.argmin(np.concatenate(volumes))]


def _box(axes, lower, upper):
    """The box between `lower` and `upper` along `axes`: longest side first, an axis' largest component positive."""
    order = np.argsort(-(upper - lower), kind="stable")
    first, second = (_pointing_up(axes[:, k]) for k in order[:2])
    return OrientedBox(
        axes @ ((lower + upper) / 2),
        np.column_stack([first, second, np.cross(first, second)]),
        (upper - lower)[order] / 2,
    )


def _pointing_up(axis):
    return axis * (1.0 if axis[np.argmax(np.abs(axis))] > 0 else -1.0)
