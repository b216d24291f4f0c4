"""Put a scene together: a part or coupon on a bench, the workshop's table or the paper's plinth, under its lamps."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from materials.input_error import InputError
from materials.material import Material
from materials.suggestion import suggest
from scenes.coupons import ball, inside_corner, lying_cylinder, plate, upright_cylinder
from scenes.lamps import Lighting, lighting
from scenes.paper_bench.hall import hall
from scenes.paper_bench.lighting import bench_lighting
from scenes.paper_bench.table import perforated_table, plinth
from scenes.paper_bench.task_lamp import lamp_on_arm
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


BenchName = Literal["workshop", "paper"]
"""By the names that the command line takes."""


@dataclass(frozen=True)
class Bench:
    """What parts stand on at z = 0, and what is around that."""

    lamps: str
    """Lamp preset, unless another is named."""
    lighting: Callable[[str], Lighting]
    """The bench's lamp presets by name."""
    support: Callable[[Material | None], tuple[Body, ...]]
    """What stands on the floor, the body under the part first, made of that material, None = its own."""
    around: Callable[[], tuple[Body, ...]]
    """Room and furniture."""


BENCHES: dict[BenchName, Bench] = {
    "workshop": Bench("workshop", lighting, lambda top: (table(top),), room_bodies),
    "paper": Bench("task", bench_lighting, lambda top: (plinth(top), *perforated_table(), lamp_on_arm()), hall),
}
"""A pine table in a room, and the bench of the paper's photographs."""


def part_scene(
    part: str,
    materials: PartMaterials | None = None,
    lamps: str | Lighting | None = None,
    table_material: Material | None = None,
    room: bool = True,
    bench: BenchName = "workshop",
) -> Scene:
    """One of `scenes.parts.ALL_PARTS` on the bench; see `scene_on_table` for the rest."""
    bodies = with_part_materials(f"part {part}", part_bodies(part), materials)
    return scene_on_table(f"part {part}", bodies, lamps, table_material, room, bench)


def coupon_scene(
    coupon: str,
    material: Material,
    lamps: str | Lighting | None = None,
    table_material: Material | None = None,
    room: bool = True,
    bench: BenchName = "workshop",
    **shape: float,
) -> Scene:
    """A coupon of `COUPONS` on the bench; `shape` (size, tilt ...) [m, rad] is for its function in `scenes.coupons`."""
    if coupon not in COUPONS:
        raise InputError(f"coupon {coupon}: there is none; {suggest(coupon, COUPONS)}")
    return scene_on_table(coupon, COUPONS[coupon](material, **shape), lamps, table_material, room, bench)


def scene_on_table(
    name: str,
    bodies: tuple[Body, ...],
    lamps: str | Lighting | None = None,
    table_material: Material | None = None,
    room: bool = True,
    bench: BenchName = "workshop",
) -> Scene:
    """The bodies as they are, with what they stand on, lamps and, unless `room` is False, the room or hall around.

    lamps: a preset of the bench's by name, or your own; by default those of a workshop, 500 lx, or the paper's own.
    table_material: of the table top, or of the plinth. A closed room needs no ambient light; without it the preset's
    ambient radiance stands for the light that walls would send back.
    """
    stand = BENCHES[bench]
    light = lamps if isinstance(lamps, Lighting) else stand.lighting(lamps or stand.lamps)
    around = stand.around() if room else ()
    ambient = 0.0 if room else light.ambient_radiance
    return Scene(name, (*bodies, *stand.support(table_material), *around), light.lamps, ambient, light.band)
