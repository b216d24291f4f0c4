"""A part from a CAD file: STL, PLY, OBJ, GLB or STEP to bodies in metres, at rest on the table, checked and named."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.transform import Rotation

from materials.input_error import InputError
from scenes.cad_files import RawBody, read_cad_file
from scenes.cad_units import metres_per_unit
from scenes.lay import with_planar_charts
from scenes.part_materials import PartMaterials
from scenes.scene import Body, Mesh
from scenes.shading_normals import with_smooth_normals
from scenes.topology import face_normals, open_edge_count, welded
from scenes.winding import turned_outward

MAX_TRIANGLES = 2_000_000
"""Largest file that is taken [-] (choice: 300,000 load in 6 s, so this many in well under a minute)."""
UPRIGHT = {"x": ("y", -90), "y": ("x", 90), "z": ("z", 0)}
"""Rotation [axis, deg] that turns the file's up axis to world z."""


@dataclass(frozen=True)
class UserPart:
    """A part that a user brought."""

    name: str
    bodies: tuple[Body, ...]
    notices: tuple[str, ...]
    """One line each: what was mended, and what may go wrong."""


def load_user_part(
    path: Path,
    units: str | None,
    materials: PartMaterials,
    up: Literal["x", "y", "z"] | None = None,
) -> UserPart:
    """The part in the file, bounding box centred over the origin and resting on z = 0 [m].

    units: what one unit of the file is, `mm`, `cm`, `m` or `in`; None only for GLB and STEP, whose formats fix it.
    up: the file's upward axis; None = z, but y for GLB, as glTF 2.0 lays down.
    """
    path = Path(path)
    raw = read_cad_file(path)
    materials.check_names(str(path), [body.name for body in raw])
    _check_numbers(path, raw)
    scale = metres_per_unit(path, units, max(np.ptp(np.concatenate([b.vertices for b in raw]), axis=0)))
    y_up = up is None and path.suffix.lower() in (".glb", ".gltf")
    axis, angle = UPRIGHT["y" if y_up else up or "z"]
    upright = Rotation.from_euler(axis, angle, degrees=True)
    vertices = [upright.apply(body.vertices * scale) for body in raw]
    foot = _foot(np.concatenate(vertices))
    notices = [f"{path}: taken as y-up, as glTF lays down, and turned upright"] if y_up else []
    bodies = []
    for body, points in zip(raw, vertices, strict=True):
        material = materials.of(body.name)
        if material is None:
            raise InputError(f"{path}: body {body.name} has no material; pass --material {body.name}=metal:finish")
        mesh, mended = _finished(f"{path}: body {body.name}", points - foot, body.faces)
        notices += mended
        bodies.append(Body(body.name, mesh, material, is_part=True))
    return UserPart(path.stem, tuple(bodies), tuple(notices))


def _check_numbers(path: Path, raw: list[RawBody]) -> None:
    for body in raw:
        bad = np.count_nonzero(~np.isfinite(body.vertices).all(axis=1))
        if bad:
            raise InputError(
                f"{path}: body {body.name} has {bad} vertices that are not finite numbers; export it again"
            )
    triangles = sum(len(body.faces) for body in raw)
    if triangles > MAX_TRIANGLES:
        raise InputError(f"{path}: {triangles} triangles; export it coarser, at most {MAX_TRIANGLES}")


def _foot(points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "3"]:
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])


def _finished(label: str, vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> tuple[Mesh, list[str]]:
    """Mesh with outward faces, shading normals and lay, and what had to be mended."""
    vertices, faces = _merged(vertices, faces)
    if not np.any(face_normals(vertices, faces)):
        raise InputError(f"{label}: every triangle is degenerate (no area); export it again")
    notices = []
    faces, turned = turned_outward(vertices, faces)
    if turned:
        notices.append(f"{label}: {turned} of {len(faces)} triangles looked inward and were turned")
    holes = open_edge_count(Mesh(vertices, faces))
    if holes:
        notices.append(
            f"{label}: the surface is open ({holes} edges without a partner), so its inside may show; close it in CAD"
        )
    faces = faces[np.any(face_normals(vertices, faces) != 0, axis=1)]  # slivers close the surface but have no normal
    return with_planar_charts(with_smooth_normals(Mesh(vertices, faces))), notices


def _merged(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> tuple[Float[np.ndarray, "k 3"], Int[np.ndarray, "l 3"]]:
    """One vertex per point (STL repeats each corner for every triangle), without triangles that collapse."""
    place = welded(vertices)
    first = np.unique(place, return_index=True)[1]
    merged = place[faces]
    a, b, c = merged.T
    return vertices[first], merged[(a != b) & (b != c) & (c != a)]
