"""Shading normals of a faceted mesh: corners are averaged across edges that bend little, kept sharp across others."""

import numpy as np
from jaxtyping import Float, Int

from scenes.scene import Mesh
from scenes.topology import connected, distinct_rows, shared_edges, unit_face_normals, welded

SMOOTH_ANGLE = np.deg2rad(30.0)
"""Edges that bend less are facets of one round surface; the default of common modellers, above the 10-20 deg facets
of usual STL exports and below the 45 deg of a chamfer [rad]."""


def with_smooth_normals(mesh: Mesh, smooth_angle: float = SMOOTH_ANGLE) -> Mesh:
    """The mesh with a unit normal at every vertex; vertices on sharp edges are doubled.

    Triangles count by the angle they fill at the corner (Thuermer and Wuethrich 1998), so the result does not depend
    on how a surface was cut into triangles.
    """
    normals = unit_face_normals(mesh.vertices, mesh.faces)
    group = _smooth_corners(welded(mesh.vertices)[mesh.faces], normals, smooth_angle)
    sums = np.zeros((group.max() + 1, 3))
    weights = _corner_angles(mesh).reshape(-1)
    np.add.at(sums, group, weights[:, None] * np.repeat(normals, 3, axis=0))
    keys = np.column_stack([group, mesh.faces.reshape(-1)])
    first, faces = distinct_rows(keys)
    group, source = keys[first].T
    uvs = None if mesh.uvs is None else mesh.uvs[source]
    smooth = sums[group] / np.linalg.norm(sums[group], axis=1, keepdims=True)
    return Mesh(mesh.vertices[source], faces.reshape(-1, 3), uvs, smooth)


def _smooth_corners(
    faces: Int[np.ndarray, "m 3"], normals: Float[np.ndarray, "m 3"], smooth_angle: float
) -> Int[np.ndarray, "h"]:
    """Group of each triangle corner; two corners at one point share a group if only smooth edges lie between them."""
    shared = shared_edges(faces)
    a, b = shared.triangles.T
    smooth = (np.einsum("ij,ij->i", normals[a], normals[b]) > np.cos(smooth_angle)) & ~shared.same_sense
    start_a, start_b = shared.half_edges[smooth].T  # a half-edge is named by its first corner
    end_a, end_b = (3 * (h // 3) + (h + 1) % 3 for h in (start_a, start_b))
    pairs = np.concatenate([np.column_stack([start_a, end_b]), np.column_stack([end_a, start_b])])
    return connected(3 * len(faces), pairs)


def _corner_angles(mesh: Mesh) -> Float[np.ndarray, "m 3"]:
    """Inner angle of every triangle at its three corners [rad]."""
    points = mesh.vertices[mesh.faces]
    ahead = np.roll(points, -1, axis=1) - points
    back = np.roll(points, 1, axis=1) - points
    cosines = np.einsum("ijk,ijk->ij", ahead, back)
    return np.arctan2(np.linalg.norm(np.cross(ahead, back), axis=2), cosines)
