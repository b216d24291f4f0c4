"""What stands in front of the sensor, as settings: a part of ours or a CAD file, materials, lamps, camera."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
import tyro
from pydantic import BaseModel, Field

from franbv.frames import decimated_intrinsics
from franbv.parameters import Parameters
from materials.catalog import material
from materials.input_error import InputError
from materials.user_materials import UserMaterials, load_user_materials, named_files
from render.d435i import SensorSettings
from render.depth.decimation import crop_centre
from render.matcher.d400_preset import is_file_name, load_preset
from scenes.build import BENCHES, COUPONS, BenchName, coupon_scene, part_scene, scene_on_table
from scenes.cad.cad_file import file_name
from scenes.paper_bench.table import plinth_material
from scenes.part_materials import part_materials
from scenes.parts import ALL_PARTS, part_description
from scenes.scene import Scene
from scenes.user_mesh import load_user_part
from studies.base.atomic_file import file_digest
from studies.base.config import Config


class SubjectSettings(Config):
    """Shared by every command that looks at a part."""

    part: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None
    """Part A, B, C or D of the paper, E1 to E4 of its pictures, A1, B1, C1 or D1 of an earlier set; or a coupon: plate,
    ball, upright_cylinder, lying_cylinder, inside_corner."""
    mesh: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """CAD file instead of a part: STL, PLY, OBJ, GLB, or STEP with the extra `step`."""
    units: Annotated[str | None, tyro.conf.arg(metavar="mm|cm|m|in")] = None
    """Unit of the CAD file; only GLB and STEP know their own, and that of STEP cannot be changed."""
    up: Literal["x", "y", "z"] | None = None
    """Upward axis of the CAD file; the default is its format's convention."""
    material: Annotated[tuple[str, ...], tyro.conf.arg(metavar="METAL:FINISH|BODY=METAL:FINISH")] = ()
    """One material for all bodies, or one per body, by name or number ('#2=METAL:FINISH'); parts come with those of the
    real things."""
    materials_file: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """YAML file with materials of your own."""
    bench: BenchName = "workshop"
    """What it stands on and in: `workshop`, a pine table in a room; `paper`, the paper's plinth on its table under a
    task lamp in a hall, the camera on end."""
    plinth: Annotated[Literal["black", "white"] | None, tyro.conf.arg(metavar="black|white")] = None
    """Colour of the paper's plinth; black is the paper's."""
    lamps: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None
    """Lamp preset of the bench. workshop: workshop, dim, bright, halogen or off; paper: task (task lamp and hall), hall
    or off; the first is its own."""
    room: bool = True
    """Whether there is a room around the table, or a hall around the paper's."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Root seed of all randomness, the sensor's noise and the planner's choices."""
    sensor: SensorSettings = SensorSettings()
    """The camera."""
    digests: Annotated[dict[str, str], tyro.conf.Suppress] = Field(default_factory=dict)
    """Filled in when the settings are resolved: hashes of the input files' content."""


AnySubject = TypeVar("AnySubject", bound=SubjectSettings)
AnyModel = TypeVar("AnyModel", bound=BaseModel)


@dataclass(frozen=True, eq=False)
class Subject:
    """A scene ready to be looked at."""

    title: str
    """For people: what is reconstructed."""
    scene: Scene
    notices: tuple[str, ...] = ()
    """What was mended in a CAD file, and what a preset's file says in vain, one line each."""


BENCH_ROLL_DEG: dict[BenchName, float] = {"workshop": 0.0, "paper": 90.0}
"""Turn of the camera in its mount [deg]: as on a tripod, and as in the paper's photographs of its bench, on end."""


def on_bench(settings: AnySubject) -> AnySubject:
    """The settings with what the bench decides where they leave it open: lamps, plinth, turn of the camera.

    InputError for a plinth where there is none.
    """
    bench, plinth, sensor = settings.bench, settings.plinth, settings.sensor
    if bench == "paper":
        plinth = plinth or "black"
    elif plinth:
        raise InputError(f"plinth {plinth}: the {bench}'s table has no plinth; leave it out, or add --bench paper")
    lamps = settings.lamps or BENCHES[bench].lamps
    return settings.model_copy(update={"plinth": plinth, "lamps": lamps, "sensor": _turned(sensor, bench)})


def _turned(sensor: SensorSettings, bench: BenchName) -> SensorSettings:
    """The camera turned in its mount as the bench has it, unless that is said."""
    return sensor if sensor.roll_deg is not None else sensor.model_copy(update={"roll_deg": BENCH_ROLL_DEG[bench]})


def build_subject(settings: SubjectSettings) -> Subject:
    """The scene that the settings describe; InputError for whatever is wrong with them. Loads no renderer."""
    settings = on_bench(settings)
    if (settings.part is None) == (settings.mesh is None):
        raise InputError(
            "nothing to look at; give either --part A, B, C, D or another, or --mesh FILE with --units and --material"
        )
    notices = check_sensor(settings.sensor)
    user = load_user_materials(settings.materials_file) if settings.materials_file else UserMaterials()
    if settings.mesh is not None:
        return _from_file(settings, settings.mesh, user, notices)
    if settings.units or settings.up:
        raise InputError(f"part {settings.part}: --units and --up are for --mesh; leave them out")
    if settings.part in COUPONS:
        return _coupon(settings, settings.part, user, notices)
    part = str(settings.part)
    if part not in ALL_PARTS:
        raise InputError(f"part {part}: there is none; choose {', '.join([*ALL_PARTS, *COUPONS])}")
    materials = part_materials(settings.material, user) if settings.material else None
    scene = part_scene(part, materials, **_bench_of(settings))
    changed = f", as {', '.join(settings.material)}" if settings.material else ""
    return Subject(f"Part {part}, {part_description(part)}{changed}", scene, notices)


def check_sensor(sensor: SensorSettings) -> tuple[str, ...]:
    """InputError for a stream profile, a preset or a crop that the camera does not have; what to say of the preset."""
    full = sensor.rig.intrinsics
    reduced = decimated_intrinsics(full, sensor.decimation)
    if sensor.crop is not None:
        crop_centre(np.zeros((1, reduced.height, reduced.width), np.uint16), reduced, sensor.crop)
    ignored = load_preset(sensor.preset).ignored
    return (f"{sensor.preset}: no counterpart, ignored: {', '.join(ignored)}",) if ignored else ()


def mounted(parameters: Parameters, sensor: SensorSettings) -> Parameters:
    """The planner's parameters for this sensor: its mount alone says how the camera is turned."""
    if parameters.roll_deg not in (0.0, sensor.mount_roll_deg):
        raise InputError(
            f"parameters.roll_deg {parameters.roll_deg:g}: the sensor is turned by {sensor.mount_roll_deg:g} deg; give "
            "sensor.roll_deg alone, the planner takes it from there"
        )
    return parameters.model_copy(update={"roll_deg": sensor.mount_roll_deg})


def with_sensor_resolved(settings: AnyModel) -> AnyModel:
    """Settings or a study's preset with the content of the sensor's preset file in place of its path, and the mount's
    turn as a number: the bench's where the settings have one."""
    sensor: Any = getattr(settings, "sensor")  # noqa: B009 (of models that have one)
    sensor = _turned(sensor, getattr(settings, "bench", "workshop"))
    return settings.model_copy(update={"sensor": sensor.resolved()})


def preset_files(name: str, sensor: SensorSettings) -> list[Path]:
    """The files that a study reads: its preset, unless it is one of ours, and the sensor's."""
    return [Path(text) for text, is_file in ((name, True), (sensor.preset, is_file_name(sensor.preset))) if is_file]


def resolved(settings: AnySubject) -> AnySubject:
    """The settings that decide the result: what the bench decides as `on_bench` has it, and input files by name and
    content, not by where they lie."""
    settings = on_bench(settings)
    files = {name: path for name in ("mesh", "materials_file") if (path := getattr(settings, name)) is not None}
    names = {name: Path(file_name(path)) for name, path in files.items()}
    digests = {name: file_digest(path) for name, path in files.items()}
    if settings.materials_file is not None:
        beside = named_files(settings.materials_file)
        # One that is missing is named when the materials are read.
        digests |= {f"materials_file/{name}": file_digest(path) for name, path in beside.items() if path.is_file()}
    return with_sensor_resolved(settings).model_copy(update={**names, "digests": digests})


def _bench_of(settings: SubjectSettings) -> dict[str, Any]:
    """What the settings say of the surroundings, by the arguments of `scenes.build`."""
    top = plinth_material(settings.plinth) if settings.plinth else None
    return {"lamps": settings.lamps, "table_material": top, "room": settings.room, "bench": settings.bench}


def _from_file(settings: SubjectSettings, path: Path, user: UserMaterials, notices: tuple[str, ...]) -> Subject:
    part = load_user_part(path, settings.units, part_materials(settings.material, user), settings.up)
    scene = scene_on_table(part.name, part.bodies, **_bench_of(settings))
    title = f"{file_name(path)}, {', '.join(settings.material)}"
    return Subject(title, scene, (*part.notices, *notices))


def _coupon(settings: SubjectSettings, coupon: str, user: UserMaterials, notices: tuple[str, ...]) -> Subject:
    if len(settings.material) != 1:
        raise InputError(f"{coupon}: a coupon needs one material; give --material metal:finish")
    scene = coupon_scene(coupon, material(settings.material[0], user), **_bench_of(settings))
    return Subject(f"{coupon.replace('_', ' ').capitalize()}, {settings.material[0]}", scene, notices)
