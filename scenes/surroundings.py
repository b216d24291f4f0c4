"""What stands around the part: a table, and a room behind it so that views across the table end on something."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from materials.catalog import material
from materials.material import Material
from scenes.primitives import box, joined, moved, rectangle
from scenes.scene import Body, Mesh

TABLE_SIZE = (1.2, 0.8, 0.03)
"""Top of a common workbench [m] (choice)."""
TABLE_HEIGHT = 0.85
"""Height of the table top above the floor [m] (choice: workbenches are 0.8 to 1.0 m high)."""
ROOM_SIZE = (4.4, 3.8, 2.85)
"""Length, depth and height of the room [m] (choice: a robot cell in a laboratory; all walls within 2.5 m range)."""

_FURNITURE = (
    # name, material, centre (x, y) [m], size (x, y, z) [m]; all on the floor, most against a wall
    ("cabinet_left", "primer", (-1.95, 0.55), (0.5, 1.0, 1.9)),
    ("rack_left", "dark_paint", (-2.0, -0.9), (0.4, 0.8, 1.6)),
    ("bench_back", "wood_table", (0.7, 1.55), (1.8, 0.6, 0.9)),
    ("locker_back", "dark_paint", (-0.9, 1.7), (0.7, 0.4, 2.0)),
    ("controller_right", "matte_paint", (1.9, 0.35), (0.6, 0.7, 1.2)),
    ("shelf_right", "wood_table", (2.0, -1.0), (0.4, 1.1, 1.8)),
    ("drawers_front", "matte_paint", (-0.7, -1.65), (0.9, 0.5, 1.0)),
    ("door_front", "primer", (0.9, -1.88), (0.95, 0.04, 2.1)),
    ("pillar_back", "concrete", (2.05, 1.75), (0.3, 0.3, 2.85)),
)
"""Boxes of different albedo: the low-frequency structure of a real background (choice)."""


def table(top: Material | None = None) -> Body:
    """The table top, its upper face at z = 0, centred [m]; pine by default, as the catalogue's `wood_table`."""
    mesh = moved(box(TABLE_SIZE), RigidTransform.from_translation([0, 0, -TABLE_SIZE[2] / 2]))
    return Body("table", mesh, top or material("wood_table"), is_part=False)


def room() -> tuple[Body, ...]:
    """Floor, walls, ceiling and furniture around the table, closed on all sides and looking inward."""
    materials = material("concrete"), material("white_paint"), material("white_paint")
    return (
        *shell(ROOM_SIZE, (0.0, 0.0), -TABLE_HEIGHT, materials),
        *(box_on_floor(*entry, -TABLE_HEIGHT) for entry in _FURNITURE),
    )


def shell(
    size: tuple[float, float, float],
    centre: tuple[float, float],
    floor_z: float,
    materials: tuple[Material, Material, Material],
) -> tuple[Body, ...]:
    """Floor, walls and ceiling of a room of length, depth and height `size` around x, y `centre` [m], looking inward.

    floor_z: world z of the floor [m]. materials: of floor, walls, ceiling.
    """
    (length, depth, height), (x, y) = size, centre
    middle = floor_z + height / 2
    walls = [
        _upright(width, height, (x + dx, y + dy, middle), turn)
        for width, dx, dy, turn in (
            (length, 0, depth / 2, 0),
            (depth, -length / 2, 0, 90),
            (length, 0, -depth / 2, 180),
            (depth, length / 2, 0, 270),
        )
    ]
    down = RigidTransform.from_components([x, y, floor_z + height], Rotation.from_euler("x", 180, degrees=True))
    floor = moved(rectangle(length, depth), RigidTransform.from_translation([x, y, floor_z]))
    of_floor, of_walls, of_ceiling = materials
    return (
        Body("floor", floor, of_floor, is_part=False),
        Body("walls", joined(walls), of_walls, is_part=False),
        Body("ceiling", moved(rectangle(length, depth), down), of_ceiling, is_part=False),
    )


def box_on_floor(
    name: str, spec: str, centre: tuple[float, float], size: tuple[float, float, float], floor_z: float
) -> Body:
    """A box of that material on the floor at world z `floor_z`, its middle at x, y `centre` [m]."""
    pose = RigidTransform.from_translation([*centre, size[2] / 2 + floor_z])
    return Body(name, moved(box(size), pose), material(spec), is_part=False)


def _upright(width: float, height: float, centre: tuple[float, float, float], turn: float) -> Mesh:
    """Rectangle that looks along -y, then turned about z by `turn` degrees."""
    rotation = Rotation.from_euler("xz", [90, turn], degrees=True)
    return moved(rectangle(width, height), RigidTransform.from_components(np.array(centre), rotation))
