"""The lay of machined faces: texture coordinates [m] whose u runs along the marks that a tool leaves.

Only brushed, ground and milled finishes need them: their roughness differs along and across the lay.
"""

import numpy as np
from jaxtyping import Float, Int

from scenes.scene import Mesh
from scenes.topology import connected, distinct_rows, shared_edges, unit_face_normals, welded

COPLANAR_ANGLE = np.deg2rad(1.0)
"""Neighbouring triangles whose normals differ by less belong to one flat [rad] (choice: finer than CAD facets)."""
EXTENT_DECIMALS = 9
"""Extents are compared to 1 nm, so that the first axis wins a tie whatever the rounding."""


def planar_lay(points: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Unit direction of the lay on a flat with unit `normal`; `points` are its corners."""
    return planar_lays(points, np.array([0, len(points)]), normal[None])[0]


def planar_lays(
    points: Float[np.ndarray, "n 3"], bounds: Int[np.ndarray, "b"], normals: Float[np.ndarray, "k 3"]
) -> Float[np.ndarray, "k 3"]:
    """Unit direction of the lay on each of k flats: along the world axis, laid into the flat, that spans it furthest.

    A flat is ground or milled lengthwise, which needs the fewest passes. The corners of flat i are
    points[bounds[i] : bounds[i + 1]].
    """
    axes = np.eye(3) - normals[:, :, None] * normals[:, None, :]  # (k, 3 axes, xyz)
    lengths = np.linalg.norm(axes, axis=2, keepdims=True)
    axes = axes / np.maximum(lengths, 1e-12)
    flat = np.repeat(np.arange(len(normals)), np.diff(bounds))
    along = np.einsum("nij,nj->ni", axes[flat], points)
    extents = np.maximum.reduceat(along, bounds[:-1]) - np.minimum.reduceat(along, bounds[:-1])
    extents = np.where(lengths[:, :, 0] > 0.1, extents, -1.0)  # an axis that stands on the flat has no direction in it
    return axes[np.arange(len(normals)), np.argmax(np.round(extents, EXTENT_DECIMALS), axis=1)]


def with_planar_charts(mesh: Mesh) -> Mesh:
    """The mesh with one chart per flat, u along its lay; vertices where flats meet are doubled, normals kept."""
    unit = unit_face_normals(mesh.vertices, mesh.faces)
    flats = _flats(mesh, unit)
    order = np.argsort(flats, kind="stable")
    starts = np.concatenate([[0], np.flatnonzero(np.diff(flats[order])) + 1, [len(order)]])
    normals = unit[order[starts[:-1]]]
    corners = mesh.vertices[mesh.faces]  # (m, 3 corners, xyz)
    lays = planar_lays(corners[order].reshape(-1, 3), 3 * starts, normals)
    frames = np.stack([lays, np.cross(normals, lays)], axis=1)  # (k, uv, xyz)
    uvs = np.einsum("mij,mcj->mci", frames[flats], corners)
    keys = np.column_stack([np.repeat(flats, 3), mesh.faces.reshape(-1)])
    first, faces = distinct_rows(keys)
    source = keys[first, 1]
    shading = None if mesh.normals is None else mesh.normals[source]
    return Mesh(mesh.vertices[source], faces.reshape(-1, 3), uvs.reshape(-1, 2)[first], shading)


def _flats(mesh: Mesh, unit_normals: Float[np.ndarray, "m 3"]) -> Int[np.ndarray, "m"]:
    """Which flat each triangle belongs to, 0 .. k-1: connected triangles with (almost) one normal."""
    shared = shared_edges(welded(mesh.vertices)[mesh.faces])
    a, b = shared.triangles.T
    coplanar = np.einsum("ij,ij->i", unit_normals[a], unit_normals[b]) > np.cos(COPLANAR_ANGLE)
    return connected(len(mesh.faces), shared.triangles[coplanar])
