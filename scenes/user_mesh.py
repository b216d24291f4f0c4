"""A part from a CAD file: STL, PLY, OBJ, GLB or STEP to bodies in metres, at rest on the table, checked and named."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.transform import Rotation

from materials.input_error import InputError
from scenes.cad.cad_file import RawBody, file_stem
from scenes.cad_files import read_cad_file
from scenes.cad_units import metres_per_unit, unheeded_unit
from scenes.lay import with_planar_charts
from scenes.part_materials import PartMaterials
from scenes.scene import Body, Mesh
from scenes.shading_normals import with_smooth_normals
from scenes.topology import face_normals, open_edge_count, welded
from scenes.winding import turned_outward

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
    read = read_cad_file(path)
    raw = read.bodies
    chosen = materials.for_bodies(str(path), [body.name for body in raw])
    _check_numbers(path, raw)
    scale = metres_per_unit(path, units, _longest_side(raw), read.unit)
    y_up = up is None and path.suffix.lower() in (".glb", ".gltf")
    axis, angle = UPRIGHT["y" if y_up else up or "z"]
    upright = Rotation.from_euler(axis, angle, degrees=True)
    vertices = [upright.apply(body.vertices * scale) for body in raw]
    foot = _foot(np.concatenate(vertices))
    notices = [f"{path}: {notice}" for notice in (*read.notices, *unheeded_unit(units, read.unit), *_doubled(raw))]
    if y_up:
        notices.append(f"{path}: taken as y-up, as glTF lays down, and turned upright")
    bodies = []
    for body, points, material in zip(raw, vertices, chosen, strict=True):
        mesh, mended = _finished(f"{path}: body {body.name}", points - foot, body.faces)
        notices += mended
        bodies.append(Body(body.name, mesh, material, is_part=True))
    return UserPart(file_stem(path), tuple(bodies), tuple(notices))


def _check_numbers(path: Path, raw: tuple[RawBody, ...]) -> None:
    for body in raw:
        bad = np.count_nonzero(~np.isfinite(body.vertices).all(axis=1))
        if bad:
            raise InputError(
                f"{path}: body {body.name} has {bad} vertices that are not finite numbers; export it again"
            )


@np.errstate(over="ignore")  # what overflows is refused as too large
def _longest_side(raw: tuple[RawBody, ...]) -> float:
    """Of the bounding box, in the file's unit."""
    return float(np.ptp(np.concatenate([body.vertices for body in raw]), axis=0).max())


def _doubled(raw: tuple[RawBody, ...]) -> list[str]:
    """Notices for bodies that are the same surface in the same place, where the renderer sees either by chance."""
    first: dict[bytes, str] = {}
    notices = []
    for body in raw:
        name = first.setdefault(body.vertices.tobytes() + body.faces.tobytes(), body.name)
        if name != body.name:
            notices.append(f"bodies {name} and {body.name} are one surface twice in one place; leave one out in CAD")
    return notices


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
