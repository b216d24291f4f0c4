"""Coupons for studies: plate on a tilt stage, cylinder, sphere, inside corner, wall, ball on a metal table [m]."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from materials.catalog import material as named
from materials.input_error import InputError
from materials.material import Material
from scenes.primitives import box, cylinder, joined, moved, rectangle, sphere
from scenes.scene import Body, Scene

STAGE_CLEARANCE = 0.03
"""Gap between the table and the lowest edge of an upright plate [m] (choice: room for the stage's base)."""
KNUCKLE_RADIUS = 0.012
POST_RADIUS = 0.008
BASE_SIZE = (0.09, 0.09, 0.015)
"""Stage hardware, as of common optical posts [m] (choice)."""


def plate(
    material: Material,
    tilt: float = 0.0,
    axis: float = 0.0,
    size: float = 0.1,
    thickness: float = 0.004,
    lay: float = 0.0,
) -> tuple[Body, ...]:
    """Square plate on a tilt stage: the plate, which is the part, and the matt black stage, which is not.

    tilt: angle of the plate from level, about a level axis, 0 to pi/2 [rad]. axis: azimuth of that axis from x [rad].
    lay: direction of the lay on the plate, from the tilt axis [rad]. size, thickness: [m].
    The centre of the front face stays at (0, 0, `plate_centre_height(size)`) for every tilt.
    """
    _check_size("plate", size=size, thickness=thickness)
    if not 0 <= tilt <= np.pi / 2:
        raise InputError(f"plate: tilt is {np.rad2deg(tilt):.4g} deg; give 0 (face up) to 90 (upright)")
    turn = Rotation.from_euler("z", axis) * Rotation.from_euler("x", tilt)
    centre = np.array([0.0, 0.0, plate_centre_height(size)])
    body = box((size, size, thickness), lay)
    pose = RigidTransform.from_components(centre - turn.apply([0, 0, thickness / 2]), turn)
    knuckle = centre - turn.apply([0, 0, thickness + 0.9 * KNUCKLE_RADIUS])
    return (Body("plate", moved(body, pose), material, is_part=True), _stage(knuckle))


def plate_centre_height(size: float) -> float:
    """Height of the centre of the plate's front face above the table [m]."""
    return size / 2 + STAGE_CLEARANCE


def plate_normal(tilt: float, axis: float = 0.0) -> np.ndarray:
    """Unit normal of the plate's front face, world frame."""
    return (Rotation.from_euler("z", axis) * Rotation.from_euler("x", tilt)).apply([0.0, 0.0, 1.0])


def _stage(knuckle: np.ndarray) -> Body:
    """Base, post and ball joint under the plate; they stay behind its front face at every tilt."""
    x, y, z = knuckle
    base = moved(box(BASE_SIZE), RigidTransform.from_translation([x, y, BASE_SIZE[2] / 2]))
    post = moved(cylinder(POST_RADIUS, z, 48), RigidTransform.from_translation([x, y, z / 2]))
    ball = moved(sphere(KNUCKLE_RADIUS, 48), RigidTransform.from_translation(knuckle))
    return Body("stage", joined([base, post, ball]), named("rubber"), is_part=False)


def upright_cylinder(material: Material, radius: float = 0.03, length: float = 0.1) -> tuple[Body, ...]:
    """Cylinder standing on the table."""
    _check_size("cylinder", radius=radius, length=length)
    pose = RigidTransform.from_translation([0, 0, length / 2])
    return (Body("cylinder", moved(cylinder(radius, length), pose), material, is_part=True),)


def lying_cylinder(material: Material, radius: float = 0.03, length: float = 0.1) -> tuple[Body, ...]:
    """Cylinder lying on the table along x."""
    _check_size("cylinder", radius=radius, length=length)
    pose = RigidTransform.from_components([0, 0, radius], Rotation.from_euler("y", 90, degrees=True))
    return (Body("cylinder", moved(cylinder(radius, length), pose), material, is_part=True),)


def ball(material: Material, radius: float = 0.03) -> tuple[Body, ...]:
    """Sphere lying on the table."""
    _check_size("ball", radius=radius)
    pose = RigidTransform.from_translation([0, 0, radius])
    return (Body("ball", moved(sphere(radius), pose), material, is_part=True),)


def inside_corner(material: Material, faces: int = 2, size: float = 0.1, thickness: float = 0.006) -> tuple[Body, ...]:
    """Square plates that meet at right angles and mirror each other.

    A floor plate, an upright one at its far edge (+y) and, with three faces, another at its left edge (-x). The inner
    corner line runs along x at y = size / 2; cameras look in from -y (and +x).
    """
    _check_size("corner", size=size, thickness=thickness)
    if faces not in (2, 3):
        raise InputError(f"corner: {faces} faces; give 2 or 3")
    outer = (size + thickness) / 2
    plates = {
        "floor": ((size, size, thickness), (0.0, 0.0, thickness / 2)),
        "back": ((size, thickness, size + thickness), (0.0, outer, outer)),
        "left": ((thickness, size + thickness, size + thickness), (-outer, thickness / 2, outer)),
    }
    return tuple(
        Body(name, moved(box(sides), RigidTransform.from_translation(centre)), material, is_part=True)
        for name, (sides, centre) in list(plates.items())[:faces]
    )


def wall(distance: float, material: Material, size: float | None = None) -> Scene:
    """A bare wall across the x axis at x = `distance` [m], square, facing the origin; no lamps, no table.

    The camera belongs at the origin and looks along +x. The default size, three times the distance, fills the 87 deg
    field of view of a D435i and its projector's.
    """
    _check_size("wall", distance=distance, size=size if size is not None else distance)
    side = 3 * distance if size is None else size
    turn = Rotation.from_matrix([[0, 0, -1], [-1, 0, 0], [0, 1, 0]])  # local z to -x, local y to world z
    mesh = moved(rectangle(side, side), RigidTransform.from_components([distance, 0, 0], turn))
    return Scene(f"wall at {distance:g} m", (Body("wall", mesh, material, is_part=True),), (), 0.0)


def ball_on_metal_table(
    ball_material: Material, table_material: Material, radius: float = 0.0435, table_size: float = 1.5
) -> Scene:
    """A ball on a square metal table top, as in published frames of a polished ball (R 43.5 mm); no lamps."""
    table = moved(box((table_size, table_size, 0.01)), RigidTransform.from_translation([0, 0, -0.005]))
    fixture = Body("table", table, table_material, is_part=False)
    return Scene("ball on metal table", (*ball(ball_material, radius), fixture), (), 0.0)


def _check_size(thing: str, **lengths: float) -> None:
    for name, length in lengths.items():
        if not (np.isfinite(length) and length > 0):
            raise InputError(f"{thing}: {name} is {length:g} m; give a positive length")
