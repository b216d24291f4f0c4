"""Scenes of one or two planes whose light has a closed form."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.frames import look_at
from materials.material import Material, Matte
from scenes.scene import Body, Lamp, Mesh, Scene


def rectangle(centre, normal_to, width: float, height: float) -> Mesh:
    """A rectangle at `centre` (3,) that faces the point `normal_to` (3,); its sides are `width` and `height` [m]."""
    pose = look_at(np.asarray(centre, float), np.asarray(normal_to, float))
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * [width / 2, height / 2, 0]
    return Mesh(pose.apply(corners), np.array([[0, 1, 2], [0, 2, 3]]))


def wall(distance: float, material: Material | None = None, lamps: tuple[Lamp, ...] = ()) -> Scene:
    """A wall of albedo 0.5 at x = `distance`, before a camera at the origin that looks along +x."""
    mesh = rectangle([distance, 0, 0], [0, 0, 0], 20 * distance, 20 * distance)
    return Scene("wall", (Body("wall", mesh, material or Matte("wall", 0.5), True),), lamps, 0.0)


def facing_x() -> RigidTransform:
    """Camera at the origin that looks along +x with world z up."""
    return look_at(np.zeros(3), np.array([1.0, 0.0, 0.0]))


def lamp_at(position, towards, side: float, radiance: float) -> Lamp:
    """A square lamp at `position` that shines towards a point."""
    rotation = look_at(np.asarray(position, float), np.asarray(towards, float)).rotation
    return Lamp(
        "lamp",
        RigidTransform.from_components(position, Rotation.from_matrix(rotation.as_matrix())),
        side,
        side,
        radiance,
    )
