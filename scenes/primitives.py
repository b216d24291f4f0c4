"""Rectangle, box, cylinder and sphere with exact normals and texture coordinates along the lay. In metres."""

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.scene import Mesh

FACETS = 192
"""Facets around a round coupon (choice): at 50 mm radius they stay within 7 um of the surface."""


def rectangle(width: float, height: float, lay: float = 0.0) -> Mesh:
    """Rectangle in the plane z = 0 that looks along +z, centred; the lay is `lay` [rad] from x towards y."""
    x, y = width / 2, height / 2
    corners = np.array([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]])
    along = np.array([np.cos(lay), np.sin(lay)])
    uvs = corners[:, :2] @ np.column_stack([along, [-along[1], along[0]]])
    return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), uvs, np.tile([0.0, 0.0, 1.0], (4, 1)))


def box(size: tuple[float, float, float], lay: float = 0.0) -> Mesh:
    """Box of the given sides, centred. Lay on top and bottom: `lay` [rad] from x towards y; on upright faces level."""
    x, y, z = size
    faces = [  # width, height, lay, rotation about z after tipping it up about x, distance from the centre
        (x, y, lay, Rotation.identity(), z),
        (x, y, -lay, Rotation.from_euler("x", 180, degrees=True), z),
        *(
            (width, z, 0.0, Rotation.from_euler("xz", [90, turn], degrees=True), depth)
            for width, turn, depth in ((x, 0, y), (y, 90, x), (x, 180, y), (y, 270, x))
        ),
    ]
    return joined(
        [
            moved(rectangle(w, h, a), RigidTransform.from_components(turn.apply([0, 0, depth / 2]), turn))
            for w, h, a, turn, depth in faces
        ]
    )


def cylinder(radius: float, length: float, facets: int = FACETS) -> Mesh:
    """Closed cylinder along z, centred; turned, so the lay runs around the axis on the side and on both ends."""
    angle = np.linspace(0, 2 * np.pi, facets + 1)
    circle = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    circle[-1] = circle[0]  # the seam closes to the last bit
    up = np.array([0.0, 0.0, length / 2])
    rim, centre = radius * circle, 0 * circle
    around = radius * angle
    half_step = np.pi * radius / facets  # a centre's texture corner lies half-way along its triangle
    side = np.stack([circle, circle])
    top = np.broadcast_to([0.0, 0.0, 1.0], side.shape)
    straight = np.stack(np.broadcast_arrays(around, [[0.0], [length]]), axis=-1)
    inward = np.stack([np.stack([around, around + half_step]), np.stack([0 * around, 0 * around + radius])], axis=-1)
    return joined(
        [
            sheet(np.stack([rim - up, rim + up]), side, straight),
            sheet(np.stack([rim + up, centre + up]), top, inward),
            sheet(np.stack([rim - up, centre - up]), -top, inward, reverse=True),
        ]
    )


def sphere(radius: float, facets: int = FACETS) -> Mesh:
    """Sphere, centred; turned about z, so the lay runs along the parallels."""
    latitude = np.linspace(-np.pi / 2, np.pi / 2, facets // 2 + 1)[:, None]
    angle = np.linspace(0, 2 * np.pi, facets + 1)[None, :]
    ring, cos, sin = np.cos(latitude), np.cos(angle), np.sin(angle)
    ring[[0, -1]] = 0.0  # poles and seam close to the last bit
    cos[:, -1], sin[:, -1] = cos[:, 0], sin[:, 0]
    normals = np.stack(np.broadcast_arrays(ring * cos, ring * sin, np.sin(latitude)), axis=-1)
    u, v = (radius * a.copy() for a in np.broadcast_arrays(angle, latitude))
    u[0] -= np.pi * radius / facets  # each pole's texture corner lies half-way along its triangle
    u[-1] += np.pi * radius / facets
    return sheet(radius * normals, normals, np.stack([u, v], axis=-1))


def sheet(
    points: Float[np.ndarray, "rows columns 3"],
    normals: Float[np.ndarray, "rows columns 3"],
    uvs: Float[np.ndarray, "rows columns 2"],
    reverse: bool = False,
) -> Mesh:
    """Grid of points as triangles that look along columns x rows, or the other way; collapsed triangles left out."""
    rows, columns = points.shape[:2]
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    below = np.column_stack([corner, corner + 1, corner + columns + 1])
    above = np.column_stack([corner, corner + columns + 1, corner + columns])
    faces = np.concatenate([below, above])
    positions = points.reshape(-1, 3)
    a, b, c = (positions[faces[:, i]] for i in range(3))
    whole: Bool[np.ndarray, "m"] = (a != b).any(axis=1) & (b != c).any(axis=1) & (c != a).any(axis=1)
    faces = faces[whole, ::-1] if reverse else faces[whole]
    return Mesh(positions, faces, uvs.reshape(-1, 2), np.ascontiguousarray(normals).reshape(-1, 3))


def moved(mesh: Mesh, transform: RigidTransform) -> Mesh:
    """The mesh at `transform`."""
    normals = None if mesh.normals is None else transform.rotation.apply(mesh.normals)
    return Mesh(transform.apply(mesh.vertices), mesh.faces, mesh.uvs, normals)


def joined(meshes: list[Mesh]) -> Mesh:
    """Several meshes that have normals and texture coordinates, as one."""
    offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=False)]),
        np.concatenate([mesh.uvs for mesh in meshes if mesh.uvs is not None]),
        np.concatenate([mesh.normals for mesh in meshes if mesh.normals is not None]),
    )
