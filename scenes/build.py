"""Put a scene together: a part or coupon on the table, in the room, under the lamps."""

from collections.abc import Callable

from materials.input_error import InputError
from materials.material import Material
from materials.suggestion import suggest
from scenes.coupons import ball, inside_corner, lying_cylinder, plate, upright_cylinder
from scenes.lamps import Lighting, lighting
from scenes.part_materials import PartMaterials, with_part_materials
from scenes.parts import part_bodies
from scenes.scene import Body, Scene
from scenes.surroundings import room as room_bodies
from scenes.surroundings import table

COUPONS: dict[str, Callable[..., tuple[Body, ...]]] = {
    "plate": plate,
    "upright_cylinder": upright_cylinder,
    "lying_cylinder": lying_cylinder,
    "ball": ball,
    "inside_corner": inside_corner,
}


def part_scene(
    part: str,
    materials: PartMaterials | None = None,
    lamps: str | Lighting = "workshop",
    table_material: Material | None = None,
    room: bool = True,
) -> Scene:
    """One of `scenes.parts.ALL_PARTS` on the table; see `scene_on_table` for the rest."""
    bodies = with_part_materials(f"part {part}", part_bodies(part), materials)
    return scene_on_table(f"part {part}", bodies, lamps, table_material, room)


def coupon_scene(
    coupon: str,
    material: Material,
    lamps: str | Lighting = "workshop",
    table_material: Material | None = None,
    room: bool = True,
    **shape: float,
) -> Scene:
    """A coupon of `COUPONS` on the table; `shape` (size, tilt ...) [m, rad] is for its function in `scenes.coupons`."""
    if coupon not in COUPONS:
        raise InputError(f"coupon {coupon}: there is none; {suggest(coupon, COUPONS)}")
    return scene_on_table(coupon, COUPONS[coupon](material, **shape), lamps, table_material, room)


def scene_on_table(
    name: str,
    bodies: tuple[Body, ...],
    lamps: str | Lighting = "workshop",
    table_material: Material | None = None,
    room: bool = True,
) -> Scene:
    """The bodies as they are, with table, lamps (a preset's name or your own) and, unless `room` is False, the room.

    The default lamps are those of a workshop, 500 lx: the paper's cell has fixed lamps. A closed room needs no ambient
    light; without it the preset's ambient radiance stands for the light that walls would send back.
    """
    light = lighting(lamps) if isinstance(lamps, str) else lamps
    around = room_bodies() if room else ()
    ambient = 0.0 if room else light.ambient_radiance
    return Scene(name, (*bodies, table(table_material), *around), light.lamps, ambient, light.band)
