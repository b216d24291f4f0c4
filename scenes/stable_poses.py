"""How a part can lie on a level table: faces of its convex hull that have the centre of mass safely above them.

Source: K. Goldberg et al., Part pose statistics: estimators and experiments, IEEE Trans. Robotics Autom. 15 (1999): a
part that falls without bouncing comes to rest on a hull face with a chance near that face's share of the solid angle
seen from the centre of mass.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from scenes.scene import Mesh
from scenes.topology import connected, open_edge_count

SAME_FACE_COSINE = 1 - 1e-6
"""Hull triangles whose normals agree to 0.08 deg are one face (choice: meshes carry float32 corners)."""
STABLE_MARGIN = 0.002
"""Least distance of the centre of mass from the rim of what carries it [m] (choice: a nudge does not topple it; lying
round things, which would roll, are left out by it)."""
LEAST_POSE_CHANCE = 0.01
"""Rarer ways to lie are left out (choice)."""


@dataclass(frozen=True, eq=False)
class StablePose:
    """One way to lie."""

    rotation: Rotation
    """From the part's own frame to that of the table, z up."""
    chance: float
    """Among all of the part's stable poses [0, 1]."""


def stable_poses(mesh: Mesh) -> tuple[StablePose, ...]:
    """All of them, the likeliest first; none for a ball."""
    hull = ConvexHull(mesh.vertices)
    centre = centre_of_mass(mesh, hull)
    normals = hull.equations[:, :3]
    pairs = np.stack([np.repeat(np.arange(len(normals)), 3), hull.neighbors.ravel()], axis=1)
    alike = np.einsum("ij,ij->i", normals[pairs[:, 0]], normals[pairs[:, 1]]) > SAME_FACE_COSINE
    face = connected(len(normals), pairs[alike])
    # A face smaller than a disc of that radius cannot surround the centre by STABLE_MARGIN.
    areas = np.bincount(face, triangle_areas(hull.points[hull.simplices]))
    found = []
    for number in np.flatnonzero(areas >= np.pi * STABLE_MARGIN**2).tolist():
        members = np.flatnonzero(face == number)
        corners = hull.points[np.unique(hull.simplices[members])]
        rotation = _turned_down(normals[members[0]])
        if inside_by(rotation.apply(corners)[:, :2], rotation.apply(centre)[:2]) >= STABLE_MARGIN:
            found.append((rotation, _solid_angle(hull.points[hull.simplices[members]] - centre)))
    whole = sum(angle for _, angle in found)
    ordered = sorted(found, key=lambda pose: -pose[1])
    return tuple(StablePose(turn, angle / whole) for turn, angle in ordered if angle >= LEAST_POSE_CHANCE * whole)


def centre_of_mass(mesh: Mesh, hull: ConvexHull | None = None) -> Float[np.ndarray, "3"]:
    """Of the solid, of one density [m]; that of the convex hull where the surface is open and bounds no solid."""
    hull = hull or ConvexHull(mesh.vertices)
    middle = hull.points.mean(axis=0)
    corners = mesh.vertices[mesh.faces] - middle
    six_volumes = np.linalg.det(corners)
    if open_edge_count(mesh) or six_volumes.sum() <= 0:
        corners = hull.points[hull.simplices] - middle
        six_volumes = np.abs(np.linalg.det(corners))
    return middle + six_volumes @ (corners.sum(axis=1) / 4) / six_volumes.sum()


def inside_by(corners: Float[np.ndarray, "n 2"], point: Float[np.ndarray, "2"]) -> float:
    """Distance of the point from the rim of the corners' convex hull, negative outside it [m]."""
    spread = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False) if len(corners) > 2 else np.zeros(2)
    if spread[-1] < 1e-9:  # they lie on a line and carry nothing
        return -np.inf
    equations = ConvexHull(corners).equations
    return float(np.min(-(equations[:, :2] @ point + equations[:, 2])))


def triangle_areas(triangles: Float[np.ndarray, "m 3 3"]) -> Float[np.ndarray, "m"]:
    """[m^2]"""
    a, b, c = np.moveaxis(triangles, 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def _turned_down(normal: Float[np.ndarray, "3"]) -> Rotation:
    """A rotation that takes the outward normal of a face to -z."""
    helper = np.eye(3)[np.argmin(np.abs(normal))]
    x = np.cross(helper, normal)
    x /= np.linalg.norm(x)
    return Rotation.from_matrix(np.stack([x, np.cross(-normal, x), -normal]))


def _solid_angle(triangles: Float[np.ndarray, "m 3 3"]) -> float:
    """Of triangles seen from the origin [sr] (A. van Oosterom and J. Strackee, 1983)."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    na, nb, nc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    below = na * nb * nc + sum(np.einsum("ij,ij->i", u, v) * w for u, v, w in ((a, b, nc), (a, c, nb), (b, c, na)))
    return float(np.sum(np.abs(2 * np.arctan2(np.linalg.det(triangles), below))))
