"""What a dataset is drawn from: the declared distribution of scenes, lights, cameras and poses, read from YAML."""

import math
from collections import Counter
from pathlib import Path
from typing import Annotated, Literal, get_args

from pydantic import AfterValidator, Field, model_validator

from franbv.parameters import Share
from materials.catalog import finish_names, material_names, metal_names
from materials.input_error import InputError
from materials.suggestion import suggest
from materials.user_entries import UserEntry
from materials.user_materials import UserMaterials, checked_entry
from render.arm.camera_body import CAMERA_BODIES
from render.d435i import SensorSettings
from render.imager.settings import LONGEST_EXPOSURE_US, MOST_LASER_POWER_MW
from render.matcher.by_name import MatcherName
from render.matcher.d400_preset import UNITS, load_preset
from render.world.rig import CAMERA_MODELS, Rig
from scenes.lamps import LIGHTING_NAMES
from scenes.part_materials import part_materials
from scenes.parts import ALL_PARTS
from studies.base.config import Config, load_config

DEFAULT = Path(__file__).parent / "default.yaml"
"""The configuration that is named `default` on the command line."""

Arrangement = Literal["single", "pile"]
MaterialKind = Literal["own", "metal", "non_metal"]
Motion = Literal["hemisphere", "trajectory"]
Shape = Literal["box", "cylinder", "ball"]


def _weighted(weights: dict[str, float]) -> dict[str, float]:
    if not any(weights.values()):
        raise ValueError("no choice has a weight above 0; give at least one")
    return weights


def _ordered(limits: tuple[float, float]) -> tuple[float, float]:
    if limits[0] > limits[1]:
        raise ValueError(f"the lower end {limits[0]:g} is above the upper end {limits[1]:g}; swap them")
    return limits


Weights = Annotated[dict[str, Annotated[float, Field(ge=0)]], AfterValidator(_weighted)]
"""Name -> how often it is drawn, relative to the others."""
UpToAMillion = Annotated[int, Field(ge=1, le=1_000_000)]
Things = Annotated[int, Field(ge=0, le=20)]
"""Of one sort on the table (choice: more find no place on it)."""
Side = Annotated[float, Field(ge=0.001, le=0.2)]
"""Of clutter [m] (choice: from what few pixels see to a quarter of the table's depth)."""
LaserPower = Annotated[float, Field(ge=0.1, le=MOST_LASER_POWER_MW)]
"""[mW]; drawn to 0.1 mW, by its logarithm, so never 0."""
Exposure = Annotated[float, Field(ge=1, le=LONGEST_EXPOSURE_US)]
"""[us]; drawn to 1 us."""
Elevation = Annotated[float, Field(ge=0, le=90)]
"""[deg] above the table."""
Distance = Annotated[float, Field(ge=0.1, le=1.0)]
"""[m] (choice: up to here no furniture of the room is in the camera's way, and all depth fits 16 bits)."""
MILLIMETRE_UM = 1000
"""Depth unit of a dataset [um]."""


class UserCad(Config):
    """A CAD file in the pool of objects."""

    file: Path
    """STL, PLY, OBJ, GLB or STEP; a relative path counts from the configuration's folder."""
    units: str | None = None
    """`mm`, `cm`, `m` or `in`; only GLB and STEP know their own."""
    up: Literal["x", "y", "z"] | None = None
    """Upward axis; the default is the format's convention."""
    material: tuple[str, ...]
    """What the real thing is made of: `metal:finish`, or one per body, by name or number, as
    `body=metal:finish` or `#2=metal:finish`."""
    weight: Annotated[float, Field(ge=0)] = 1.0
    """How often it is drawn, relative to the parts."""


class Objects(Config):
    """What stands on the table to be looked at."""

    parts: dict[str, Annotated[float, Field(ge=0)]] = Field(default={"A1": 1, "B1": 1, "C1": 1, "D1": 1})
    """Parts by name and how often each is drawn. A1 to D1 is what the declared shares were balanced with."""
    cad: tuple[UserCad, ...] = ()
    """CAD files of yours."""
    arrangement: Weights = Field(default={"single": 0.6, "pile": 0.4})
    """One part, or several that lie on the table and on each other."""
    pile_parts: Annotated[tuple[Annotated[Things, Field(ge=1)], Things], AfterValidator(_ordered)] = (2, 5)
    """Fewest and most parts of a pile."""
    upright: Share = 0.5
    """Share of single parts that stand as designed; the others lie in one of their stable poses."""
    offset_m: Annotated[float, Field(ge=0, le=0.1)] = 0.02
    """A single part stands within this of the table's middle, along x and y [m]."""
    spread_m: Annotated[float, Field(gt=0, le=0.2)] = 0.05
    """Standard deviation of where the parts of a pile are let down, along x and y [m]."""


class Materials(Config):
    """What the parts are made of; drawn for each part on its own."""

    kind: Weights = Field(default={"own": 0.4, "metal": 0.5, "non_metal": 0.1})
    """`own` keeps what the real thing is made of; otherwise one material is drawn for the whole part."""
    metals: Weights
    finishes: Weights
    non_metals: Weights
    roughness: Literal["nominal", "range"] = "range"
    """Roughness of a drawn metal: the finish's nominal one, or log-uniform over what real parts show."""
    user: Annotated[dict[str, UserEntry], Field(max_length=12)] = Field(default={})
    """Materials of yours by name, which may then stand wherever a material may: entries as `--materials-file` has them
    below `materials`, their files counted from the configuration's folder (12: a material map counts to 255)."""

    @property
    def of_user(self) -> UserMaterials:
        """As the catalogue takes them."""
        return UserMaterials(materials=self.user)


class Surroundings(Config):
    """Table, room, lamps and what else lies about."""

    tables: Weights
    """Materials of the table top."""
    lamps: Weights
    """Lamp presets."""
    room: Share = 0.8
    """Share of scenes in a closed room; in the others ambient light comes from everywhere and behind the table is
    nothing."""
    clutter: Annotated[tuple[Things, Things], AfterValidator(_ordered)] = (0, 4)
    """Fewest and most other things on the table."""
    clutter_shapes: Weights = Field(default={"box": 1, "cylinder": 1, "ball": 1})
    clutter_size_m: Annotated[tuple[Side, Side], AfterValidator(_ordered)] = (0.015, 0.06)
    """Their sides and diameters, log-uniform [m]."""
    clutter_materials: Weights


class Camera(Config):
    """Stream, projector and exposure; drawn for each scene."""

    profiles: Weights = Field(default={"640x360": 1})
    """Stream profiles."""
    model: Literal["d435i", "d415"] = "d435i"
    """Camera of the D400 family."""
    matcher: MatcherName = "d4"
    preset: str = "default"
    """Preset of the RealSense viewer by name, or a JSON file; a relative path counts from the configuration's folder.
    Only what concerns the matcher counts: laser and exposure are drawn, and depth is in whole millimetres."""
    roll_deg: Annotated[float, Field(ge=-180, le=180)] = 0.0
    """Turn of the camera in its mount about its optical axis, clockwise as it looks; 90 = on end [deg]."""
    laser_mw: Annotated[tuple[LaserPower, LaserPower], AfterValidator(_ordered)] = (30.0, 360.0)
    """Laser power, log-uniform [mW]."""
    auto_exposure: Share = 0.8
    """Share of scenes with auto-exposure."""
    exposure_us: Annotated[tuple[Exposure, Exposure], AfterValidator(_ordered)] = (2000.0, 33000.0)
    """Exposure of the others, log-uniform [us]."""
    decimation: Annotated[int, Field(ge=2, le=8)] = 8
    """Factor of the decimated depth."""

    def sensor(self, profile: str) -> SensorSettings:
        """Camera, matcher and mount, as far as a dataset has one for all scenes; depth is kept whole."""
        shared = {name: getattr(self, name) for name in ("model", "roll_deg", "preset", "decimation", "matcher")}
        return SensorSettings(profile=profile, crop=None, **shared)

    def rig(self, profile: str) -> Rig:
        """Imagers and projector streaming at this profile."""
        return self.sensor(profile).rig


class Views(Config):
    """From where each scene is looked at."""

    per_scene: Annotated[int, Field(ge=1, le=1000)] = 10
    motion: Weights = Field(default={"hemisphere": 0.7, "trajectory": 0.3})
    """Independent poses on the hemisphere, or an even path between two of them."""
    elevation_deg: Annotated[tuple[Elevation, Elevation], AfterValidator(_ordered)] = (15.0, 85.0)
    """Uniform on the sphere between these [deg]."""
    distance_m: Annotated[tuple[Distance, Distance], AfterValidator(_ordered)] = (0.25, 0.7)
    """From the middle of what is looked at, uniform [m]."""
    roll_deg: Annotated[float, Field(ge=0, le=180)] = 15.0
    """The camera is turned about its axis by up to this from its mount's roll, either way [deg]."""
    aim_m: Annotated[float, Field(ge=0, le=0.2)] = 0.03
    """It aims at a point within this of the middle, along each axis [m]."""


class Rendering(Config):
    """How many light paths are spent."""

    glossy_paths: Literal[8, 16, 32, 64, 128] = 16
    """Of a pixel that sees a glossy surface."""
    indirect_directions: Literal[16, 32, 64, 128, 256] = 64
    """Gathered at each interpolation point of the light that comes to Lambertian surfaces by way of others."""


class DatasetConfig(Config):
    """All that decides a dataset."""

    title: str
    seed: Annotated[int, Field(ge=0)] = 0
    views: UpToAMillion = 1000
    n_frames: Annotated[int, Field(ge=1, le=100)] = 1
    """Depth frames of a view; more than one give the median depth and how often each pixel had none."""
    keep_frames: bool = False
    """Whether the single frames are stored as well."""
    objects: Objects = Objects()
    materials: Materials
    surroundings: Surroundings
    camera: Camera = Camera()
    poses: Views = Views()
    rendering: Rendering = Rendering()

    @model_validator(mode="after")
    def _known(self) -> "DatasetConfig":
        m, s, user = self.materials, self.surroundings, self.materials.of_user
        metals = metal_names(user)
        non_metals = [name for name in material_names(user) if name not in metals]
        specs = (*non_metals, *(f"{metal}:{finish}" for metal in metals for finish in finish_names(metal, user)))
        for place, words, known in (
            ("objects.parts", self.objects.parts, ALL_PARTS),
            ("objects.arrangement", self.objects.arrangement, get_args(Arrangement)),
            ("materials.kind", m.kind, get_args(MaterialKind)),
            ("materials.metals", m.metals, metals),
            ("materials.finishes", m.finishes, finish_names()),
            ("materials.non_metals", m.non_metals, non_metals),
            ("surroundings.tables", s.tables, specs),
            ("surroundings.clutter_materials", s.clutter_materials, specs),
            ("surroundings.clutter_shapes", s.clutter_shapes, get_args(Shape)),
            ("surroundings.lamps", s.lamps, LIGHTING_NAMES),
            (
                "camera.profiles",
                self.camera.profiles,
                [f"{w}x{h}" for w, h in CAMERA_MODELS[self.camera.model].focal_lengths_px],
            ),
            ("poses.motion", self.poses.motion, get_args(Motion)),
        ):
            for word in words:
                if word not in known:
                    raise ValueError(f"{place}: {word}: there is none; {suggest(word, known)}")
        return self

    @model_validator(mode="after")
    def _drawable(self) -> "DatasetConfig":
        """Whatever may be drawn exists: an object, a finish for every metal, a place for the camera."""
        o, m, p = self.objects, self.materials, self.poses
        if not any(o.parts.values()) and not any(cad.weight for cad in o.cad):
            raise ValueError("objects: neither a part nor a CAD file has a weight above 0; give one")
        for name, count in Counter(cad.file.name for cad in o.cad).items():
            if count > 1:
                raise ValueError(f"objects.cad: {count} files are named {name}; objects go by file name, so rename one")
        for cad in o.cad:
            part_materials(cad.material, m.of_user)
        for metal in (name for name, weight in m.metals.items() if weight and m.kind.get("metal")):
            fitting = finish_names(metal, m.of_user)
            if not any(m.finishes.get(finish) for finish in fitting):
                raise ValueError(f"materials.finishes: none goes with {metal}; give one of {', '.join(fitting)}")
        least_height = CAMERA_BODIES[self.camera.model].reach_below(self.camera.roll_deg)
        if p.distance_m[0] * math.sin(math.radians(p.elevation_deg[0])) - p.aim_m < least_height:
            raise ValueError(
                f"poses: from {p.distance_m[0]:g} m at {p.elevation_deg[0]:g} deg, aimed {p.aim_m:g} m too low, the "
                f"camera is in the table ({least_height:g} m of it are below its axis); raise distance_m or "
                "elevation_deg, or lower aim_m"
            )
        return self

    @property
    def scenes(self) -> int:
        """Scenes that the views are spread over."""
        return -(-self.views // self.poses.per_scene)

    def views_of(self, scene: int) -> int:
        """Views of one scene; the last one may have fewer."""
        return min(self.poses.per_scene, self.views - scene * self.poses.per_scene)


def load_dataset_config(name: str) -> DatasetConfig:
    """From a YAML file, or `default`; CAD and BSDF files by absolute path, a preset file by its content."""
    path = DEFAULT if name == "default" else Path(name)
    config = load_config(DatasetConfig, path)
    folder = path.resolve().parent
    preset = load_preset(config.camera.preset, folder)
    if preset.values.get(UNITS, MILLIMETRE_UM) != MILLIMETRE_UM:
        raise InputError(
            f"{path}: camera.preset {config.camera.preset}: depth units are {preset.values[UNITS]:g} um; a dataset's "
            "depth is in whole millimetres, so take that key out of it"
        )
    config = config.model_copy(update={"camera": config.camera.model_copy(update={"preset": preset.matcher_text})})
    cad = tuple(entry.model_copy(update={"file": folder / entry.file}) for entry in config.objects.cad)
    user = {name: checked_entry(path, name, entry) for name, entry in config.materials.user.items()}
    return with_files(config, cad, user)


def with_files(config: DatasetConfig, cad: tuple[UserCad, ...], user: dict[str, UserEntry]) -> DatasetConfig:
    """The configuration with other CAD files and materials of the user's."""
    objects = config.objects.model_copy(update={"cad": cad})
    materials = config.materials.model_copy(update={"user": user})
    return config.model_copy(update={"objects": objects, "materials": materials})
