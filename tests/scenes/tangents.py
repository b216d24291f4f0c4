"""Independent look at texture coordinates: where u runs on each triangle."""

import numpy as np

from scenes.scene import Mesh


def u_directions(mesh: Mesh) -> np.ndarray:
    """Unit dp/du of every triangle, from the 2 x 2 system that a renderer solves (PBRT 4, section 6.5.1)."""
    assert mesh.uvs is not None
    p0, p1, p2 = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    t0, t1, t2 = (mesh.uvs[mesh.faces[:, i]] for i in range(3))
    (du1, dv1), (du2, dv2) = (t1 - t0).T, (t2 - t0).T
    along = dv2[:, None] * (p1 - p0) - dv1[:, None] * (p2 - p0)
    along = along / (du1 * dv2 - dv1 * du2)[:, None]
    return along / np.linalg.norm(along, axis=1, keepdims=True)


def centres(mesh: Mesh) -> np.ndarray:
    """Centroid of every triangle [m]."""
    return mesh.vertices[mesh.faces].mean(axis=1)


def unit_normals(mesh: Mesh) -> np.ndarray:
    """Geometric unit normal of every triangle."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)
