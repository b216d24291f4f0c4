"""External pipe threads to ISO 228-1 as one closed mesh with exact normals.

The diameters come from bd_warehouse's ISO 228-1 table. Its own swept solid is not used: it arrives as ten solids with
150,000 facets, while a thread is a plain height field over its cylinder.
"""

# pyright: reportMissingImports=false
import numpy as np
from bd_warehouse.thread import BSPPThread
from jaxtyping import Bool, Float

from scenes.primitives import joined, sheet
from scenes.scene import Mesh
from scenes.topology import face_normals

AROUND = 48
"""Facets around the thread (choice: as other round surfaces here)."""
PER_PITCH = 16
"""Rows per pitch (choice): six on each flank, two on crest and root."""
FLANK = np.deg2rad(27.5)
"""Half of the 55 deg Whitworth angle [rad], ISO 228-1."""

Grid = Float[np.ndarray, "rows columns"]


def pipe_thread(size: str, length: float, bore: float) -> Mesh:
    """Male thread `size` ("G1/2") from z = 0 to `length`, far end led in at 45 deg, bored [mm]; mesh in metres."""
    data = BSPPThread(size, length, simple=True)
    pitch, major, minor = 25.4 / data.tpi, data.basic_major_diameter / 2, data.basic_minor_diameter / 2
    rows = int(np.ceil(length / pitch * PER_PITCH)) + 1
    height, angle = np.meshgrid(np.linspace(0, length, rows), np.linspace(0, 2 * np.pi, AROUND + 1), indexing="ij")
    phase = (height - pitch * angle / (2 * np.pi) + pitch / 2) % pitch - pitch / 2
    radius, slope = _whitworth(phase, pitch, major)
    cone = minor - 0.5 + length - height
    cut = cone < radius
    side = _wall(
        np.where(cut, cone, radius),
        angle,
        height,
        slope=np.where(cut, -1.0, slope),
        helix=np.where(cut, 0.0, -slope * pitch / (2 * np.pi)),
    )
    side = _averaged_at(side, _crease(cut))
    rims = np.full((2, AROUND + 1), float(bore))
    inner = _wall(rims, angle[[0, -1]], height[[0, -1]], outward=-1.0)
    foot = _annulus(np.stack([rims[0], radius[0]]), angle[:2], 0.0, facing=-1.0)
    head = _annulus(np.stack([rims[0], np.where(cut, cone, radius)[-1]]), angle[:2], length, facing=1.0)
    return joined([side, inner, foot, head])


def _whitworth(phase: Grid, pitch: float, major: float) -> tuple[Grid, Grid]:
    """Radius [mm] and its slope along the axis [-], `phase` mm from the crest; crest and root are arcs of 0.1373 P."""
    arc = 0.137329 * pitch
    depth = 0.640327 * pitch
    reach = arc * np.cos(FLANK)  # where the arc meets the flank
    from_crest, from_root = np.abs(phase), pitch / 2 - np.abs(phase)
    crest = np.sqrt(np.maximum(arc**2 - from_crest**2, 1e-9))
    root = np.sqrt(np.maximum(arc**2 - from_root**2, 1e-9))
    steepness = 1 / np.tan(FLANK)
    on_crest, on_root = from_crest < reach, from_root < reach
    flank = major - depth / 2 + (pitch / 4 - from_crest) * steepness
    radius = np.select([on_crest, on_root], [major - arc + crest, major - depth + arc - root], flank)
    fall = np.select([on_crest, on_root], [from_crest / crest, from_root / root], steepness)
    return radius, -np.sign(phase) * fall


def _crease(cut: Bool[np.ndarray, "rows columns"]) -> Bool[np.ndarray, "rows columns"]:
    """Nodes next to the edge where the lead-in cone cuts the thread."""
    ring = cut[:, :-1]
    near = (ring != np.roll(ring, 1, axis=1)) | (ring != np.roll(ring, -1, axis=1))
    near[1:] |= ring[1:] != ring[:-1]
    near[:-1] |= ring[1:] != ring[:-1]
    return np.concatenate([near, near[:, :1]], axis=1)


def _averaged_at(mesh: Mesh, nodes: Bool[np.ndarray, "rows columns"]) -> Mesh:
    """The mesh with the mean normal of the adjoining triangles at some nodes, which lie on an edge too fine to draw."""
    assert mesh.normals is not None
    sums = np.zeros((*nodes.shape, 3))
    for corner in range(3):
        np.add.at(sums.reshape(-1, 3), mesh.faces[:, corner], face_normals(mesh.vertices, mesh.faces))
    sums[:, [0, -1]] = (sums[:, 0] + sums[:, -1])[:, None]  # both sides of the seam
    mean = sums.reshape(-1, 3) / np.linalg.norm(sums.reshape(-1, 3), axis=1, keepdims=True)
    return Mesh(mesh.vertices, mesh.faces, mesh.uvs, np.where(nodes.reshape(-1, 1), mean, mesh.normals))


def _wall(
    radius: Grid, angle: Grid, height: Grid, slope: Grid | float = 0.0, helix: Grid | float = 0.0, outward: float = 1.0
) -> Mesh:
    """The surface radius(angle, height) [mm] as a mesh [m]; `slope` = dr/dz, `helix` = dr/dangle; u runs around."""
    cos, sin = _closed_circle(angle)
    points = np.stack([radius * cos, radius * sin, height], axis=-1)
    turn = helix / radius
    normals = np.stack([cos + turn * sin, sin - turn * cos, -slope + 0 * radius], axis=-1)
    normals = outward * normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    uvs = np.stack([angle * radius.mean(), height], axis=-1)
    return sheet(points / 1000, normals, uvs / 1000, reverse=outward < 0)


def _annulus(radii: Grid, angle: Grid, height: float, facing: float) -> Mesh:
    """Flat ring [m] between an inner and an outer outline [mm] that looks along +z or -z."""
    cos, sin = _closed_circle(angle)
    points = np.stack([radii * cos, radii * sin, np.full_like(radii, height)], axis=-1)
    normals = np.tile([0.0, 0.0, facing], (*radii.shape, 1))
    uvs = np.stack([angle * radii.mean(), radii], axis=-1)
    return sheet(points / 1000, normals, uvs / 1000, reverse=facing > 0)


def _closed_circle(angle: Grid) -> tuple[Grid, Grid]:
    """Cosine and sine whose last column equals the first to the last bit."""
    cos, sin = np.cos(angle), np.sin(angle)
    cos[:, -1], sin[:, -1] = cos[:, 0], sin[:, 0]
    return cos, sin
