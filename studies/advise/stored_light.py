"""Radiance and truth from every pose, rendered once for each light and kept on disk."""

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from materials.input_error import InputError
from render.d435i import SimulatedD435i
from render.light.radiance import RadianceLayers, StoppedPaths
from render.world.truth import Truth, looks_at_part
from scenes.scene import Scene
from studies.advise.changed_scene import changed_scene
from studies.advise.poses import stood
from studies.advise.setup import LightKey
from studies.base.case_folder import case_digest
from studies.base.config import Config
from studies.base.pose_text import check_free
from studies.base.reading import reading
from studies.run.scene_settings import SubjectSettings
from studies.scoring.missing_surface import pixel_areas
from studies.store.views import read_arrays, write_arrays

LIGHT = "light"
"""Sub-folder of the radiance."""
KEPT_LIGHTS = 4
"""Renderings at hand (choice: two looks of two settings; 6 MB each at 640x360)."""
STEEPEST_SCORED_DEG = 65.0
"""Surface that is seen at more than this incidence does not count [deg]. Choice: a matcher's window does not hold it,
whatever it is made of. The bench's matte block, sprayed and well exposed, has right depth on 91 to 99 % of its surface
below, on 61 % of what lies at 65 to 70 deg and on 17 to 44 % beyond; at 75 deg a pixel is four times as much surface
as face on, so that all of it together would be half of the block's."""
FACINGS = ("top", "+x", "-x", "+y", "-y", "slanting", "underside")
"""Sides of the part, by where the surface's normal points."""
FACING_COSINE = 0.9
"""Of the angle between normal and axis, from which on a surface faces along the axis (choice: 26 deg)."""


class LitPose(Config):
    """Names one rendering: all that decides it."""

    subject: SubjectSettings
    pose: str
    roll_deg: float
    """Of the mount."""
    light: LightKey


@dataclass(frozen=True, eq=False)
class SeenPart:
    """What is really there, as far as it is scored."""

    depth: Float32[np.ndarray, "h w"]
    """True Z-depth [m], 0 = nothing there."""
    area: Float32[np.ndarray, "h w"]
    """Of the part's surface behind each pixel [m^2], 0 elsewhere and where it is too steep to count."""
    body: UInt8[np.ndarray, "h w"]
    """Index into the scene's bodies."""
    facing: UInt8[np.ndarray, "h w"]
    """Index into FACINGS."""


@dataclass(frozen=True, eq=False)
class PoseLight:
    """One rendering."""

    T_world_cam: RigidTransform
    layers: tuple[RadianceLayers, RadianceLayers]
    """Left and right."""
    seen: SeenPart


@dataclass(eq=False)
class LightStore:
    """Lights by what decides them; renders what is missing."""

    out: Path
    subject: SubjectSettings
    scene: Scene
    """As it is without remedies."""
    poses: tuple[str, ...]
    roll_deg: float
    """Of the mount."""
    seconds: list[float] = field(default_factory=list)
    """What renderings took, at the first profile's size or any other [s]."""
    _cameras: dict[str, SimulatedD435i] = field(default_factory=dict)
    _stands: dict[tuple[str, str], RigidTransform] = field(default_factory=dict)
    _possible: dict[str, bool] = field(default_factory=dict)
    _read: dict[Path, PoseLight] = field(default_factory=dict)

    def camera(self, key: LightKey) -> SimulatedD435i:
        """Before the light's scene; loaded once."""
        name = key.model_copy(update={"stand": type(key.stand)()}).model_dump_json()
        if name not in self._cameras:
            scene = changed_scene(self.scene, key.sprayed, key.tilt_deg, key.lamps)
            known = next(iter(self._cameras.values())).world if self._cameras else None
            sensor = key.sensor.model_copy(update={"decimation": 1, "crop": None})
            self._cameras[name] = SimulatedD435i(scene, sensor, known=known)
        return self._cameras[name]

    def stands(self, key: LightKey, index: int) -> RigidTransform:
        """T_world_cam of a pose; found once."""
        name = self.poses[index], key.stand.model_dump_json()
        if name not in self._stands:
            self._stands[name] = stood(self.poses[index], self.scene, self.roll_deg, key.stand)
        return self._stands[name]

    def can_stand(self, key: LightKey) -> bool:
        """Whether the camera can be there from every pose; the scene without remedies decides. Found once."""
        name = key.stand.model_dump_json()
        if name not in self._possible:
            self._possible[name] = all(self._is_free(key, index) for index in range(len(self.poses)))
        return self._possible[name]

    def _is_free(self, key: LightKey, index: int) -> bool:
        try:
            check_free(self.poses[index], self.stands(key, index).translation, self.scene)
        except InputError:
            return False
        return True

    def path(self, key: LightKey, index: int) -> Path:
        """File of one rendering."""
        lit = LitPose(subject=self.subject, pose=self.poses[index], roll_deg=self.roll_deg, light=key)
        return self.out / LIGHT / f"{case_digest('advise light 2', lit)}.npz"

    def missing(self, key: LightKey, n_poses: int) -> int:
        """Poses of the first so many that would have to be rendered."""
        return sum(not self.path(key, index).exists() for index in range(n_poses))

    def light(self, key: LightKey, index: int) -> PoseLight:
        """Read, or rendered and written; the last ones are kept at hand."""
        path, pose = self.path(key, index), self.stands(key, index)
        if path in self._read:
            return self._read[path]
        if not path.exists():
            began = time.perf_counter()
            camera = self.camera(key)
            layers, truth = camera.render(pose), camera.truth(pose)
            seen = seen_part(truth, camera.world.source, camera.rig.intrinsics)
            write_arrays(path, {**_arrays(layers), **vars(seen)})
            self.seconds.append(time.perf_counter() - began)
        while len(self._read) >= KEPT_LIGHTS:
            self._read.pop(next(iter(self._read)))
        with reading(path, "remove it and give the command again"):
            self._read[path] = _pose_light(pose, read_arrays(path))
        return self._read[path]


def seen_part(truth: Truth, scene: Scene, intrinsics: Intrinsics) -> SeenPart:
    """What is scored of a truth. scene: the one that it was found in."""
    part = looks_at_part(truth, scene)
    depth, incidence = truth.depth.astype(float), truth.incidence.astype(float)
    steepest = np.radians(STEEPEST_SCORED_DEG)
    areas = pixel_areas(depth, incidence, intrinsics, np.cos(steepest))
    area = np.where(part & (incidence <= steepest), areas, 0).astype(np.float32)
    return SeenPart(truth.depth, area, truth.body, facings(truth.normal_world))


def facings(normal: Float32[np.ndarray, "h w 3"]) -> UInt8[np.ndarray, "h w"]:
    """Index into FACINGS of unit normals in the world."""
    x, y, z = np.moveaxis(normal, -1, 0)
    along = [component >= FACING_COSINE for component in (z, x, -x, y, -y)]
    slanting = FACINGS.index("slanting")
    return np.select([*along, -z >= FACING_COSINE], [*range(5), slanting + 1], slanting).astype(np.uint8)


def _arrays(layers: tuple[RadianceLayers, RadianceLayers]) -> dict[str, np.ndarray]:
    arrays: dict[str, np.ndarray] = {}
    for side, one in zip(("left", "right"), layers, strict=True):
        arrays |= {f"{side}_projector": one.projector, f"{side}_ambient": one.ambient}
        if one.stopped is not None:
            arrays |= {f"{side}_pixels": one.stopped.pixels, f"{side}_stopped": one.stopped.layers}
    return arrays


def _pose_light(pose: RigidTransform, arrays: dict[str, np.ndarray]) -> PoseLight:
    left, right = (
        RadianceLayers(
            arrays[f"{side}_projector"],
            arrays[f"{side}_ambient"],
            StoppedPaths(arrays[f"{side}_pixels"], arrays[f"{side}_stopped"]) if f"{side}_pixels" in arrays else None,
        )
        for side in ("left", "right")
    )
    return PoseLight(pose, (left, right), SeenPart(*(arrays[name] for name in ("depth", "area", "body", "facing"))))
