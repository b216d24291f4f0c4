"""The cases of a sensitivity study: one subject of one material seen from one pose, under one or more lights.

Everything that decides a case's result stands in its configuration, whose hash names its folder. The matte twin depends
on everything but the material, so it is a case of its own that all materials share.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any, ClassVar, TypeVar

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at, rolled
from franbv.parameters import Parameters
from materials.catalog import material
from materials.material import Matte
from render.d435i import SensorSettings, SimulatedD435i
from render.light.sampling import Sampling
from render.world.mitsuba_scene import LoadedScene, load_scene
from scenes.build import COUPONS, coupon_scene, part_scene
from scenes.coupons import plate_centre_height
from scenes.part_materials import PartMaterials
from scenes.reference_points import part_box
from scenes.scene import Scene
from studies.base.case_folder import case_digest
from studies.base.config import Config
from studies.run.scene_settings import mounted
from studies.sensitivity.preset import OWN, Light, SensitivityPreset, Sweep

CASE, TWIN = "sensitivity 5", "sensitivity twin 4"
"""What the hashes of a case and of a twin call them; the number rises when labels come to mean something else."""
FIRST_AZIMUTH_DEG = 20.0
"""Azimuth of seed 0 [deg]. Choice: no symmetry plane of lamps, room or lay."""
GOLDEN_ANGLE_DEG = 137.508
"""Turn from one seed to the next [deg]: however many there are, they are spread about evenly."""
CORNER_AZIMUTH_DEG, CORNER_SPREAD_DEG = -90.0, 50.0
"""The inside corner is open towards -y; its azimuths stay within this spread about it [deg] (choice)."""
ANY_GLOSSY = "iron:blasted"
"""Stands for every material that is not matte where the twin is made (choice: any of them gives the same)."""
PLATE_SIZE = 0.1
"""Of the plate, the default of `scenes.coupons.plate` [m]."""


class Look(Config):
    """What stands where, and what looks at it from where."""

    subject: str
    """Coupon or part."""
    polar_deg: float
    """Angle of the view from the vertical [deg]."""
    azimuth_deg: float
    """Azimuth of the camera from world x [deg]."""
    distance_m: float
    """From the subject's middle [m]."""
    seed: int
    """Of the sensor's noise and the planner."""
    dot_fwhm_px: float | None
    """Width of the projector's dots instead of the sensor's, in 1280x720 images [px]; None = the sensor's."""
    n_frames: int
    sensor: SensorSettings


class TwinConfig(Look):
    """All that decides what the matte twin shows."""

    light: Light
    material: str
    """One of those that have this twin."""

    @property
    def digest(self) -> str:
        """Name of the twin's folder."""
        return case_digest(TWIN, self)

    @property
    def title(self) -> str:
        """For people."""
        return f"matte twin of {self.subject}, {self.polar_deg:g} deg, {self.distance_m:g} m, seed {self.seed}"


class LitCase(Look):
    """All that decides what the sensor measures of a case, whatever is then made of it."""

    kind: ClassVar[str]
    """What the hash of its name calls it."""
    material: str
    """Name of the material; `own` for a part as it is."""
    lights: tuple[Light, ...]
    """Detection and recovery are measured under the first."""
    glossy_paths: int

    @property
    def twins(self) -> list[TwinConfig]:
        """The twin of the subject in this material under each light."""
        shared = {name: getattr(self, name) for name in Look.model_fields}
        return [TwinConfig(**shared, light=light, material=self.stand_in) for light in self.lights]

    @property
    def stand_in(self) -> str:
        """Material that the twin is made of: one for all that share it."""
        return twin_material(self.material)

    @property
    def digest(self) -> str:
        """Name of the case's folder."""
        return case_digest(self.kind, self)

    @property
    def title(self) -> str:
        """For people, short enough for a progress display."""
        dots = "" if self.dot_fwhm_px is None else f", dots {self.dot_fwhm_px:g} px"
        return f"{self.subject} {self.material}, {self.polar_deg:g} deg, {self.distance_m:g} m{dots}, seed {self.seed}"


class CaseConfig(LitCase):
    """All that decides the result of a case."""

    kind: ClassVar[str] = CASE
    other_paths: int
    recovery: bool
    """Whether regions are recovered."""
    hemisphere_poses: int
    """Poses that are tried to learn what was possible."""
    parameters: Parameters


AnyCase = TypeVar("AnyCase", bound=LitCase)


@dataclass(frozen=True)
class SweepCase:
    """A case and the sweep that asked for it."""

    sweep: str
    config: CaseConfig


def sweep_cases(preset: SensitivityPreset) -> list[SweepCase]:
    """All cases of all sweeps; one that two sweeps share stands there twice."""
    return [SweepCase(sweep.name, config) for sweep in preset.sweeps for config in _cases(preset, sweep)]


def _cases(preset: SensitivityPreset, sweep: Sweep) -> Iterator[CaseConfig]:
    views = product(sweep.subjects, sweep.specs(), sweep.distances_m, sweep.polar_deg, sweep.dots_fwhm_px, sweep.seeds)
    for subject, spec, distance, polar, dots, seed in views:
        yield CaseConfig(
            subject=subject,
            material=spec,
            polar_deg=polar,
            azimuth_deg=azimuth_deg(subject, seed),
            distance_m=distance,
            seed=seed,
            dot_fwhm_px=dots,
            lights=sweep.lights(),
            n_frames=preset.n_frames,
            sensor=preset.sensor.resolved(),
            glossy_paths=preset.glossy_paths,
            other_paths=preset.other_paths,
            recovery=sweep.recovery,
            hemisphere_poses=sweep.hemisphere_poses,
            parameters=mounted(preset.parameters, preset.sensor).model_copy(update={"n_frames": preset.n_frames}),
        )


def azimuth_deg(subject: str, seed: int) -> float:
    """Azimuth of the camera for a seed [deg]."""
    if subject == "inside_corner":
        turn = (seed * GOLDEN_ANGLE_DEG / 360 + 0.5) % 1 - 0.5  # evenly within -0.5 .. 0.5
        return round(CORNER_AZIMUTH_DEG + CORNER_SPREAD_DEG * turn, 6)
    return round((FIRST_AZIMUTH_DEG + GOLDEN_ANGLE_DEG * seed) % 360, 6)


SceneOf = Callable[[Look, str, Light], Scene]
"""What makes the scene of a look, the subject of this material under this light; it is sent to workers."""


def look_scene(look: Look, spec: str, light: Light) -> Scene:
    """The subject of this material on its table, under the lamps."""
    if look.subject in COUPONS:
        return coupon_scene(look.subject, material(spec), light.lamps)
    return part_scene(look.subject, None if spec == OWN else PartMaterials(material(spec)), light.lamps)


def twin_material(spec: str) -> str:
    """One material for all that share a twin: matte surfaces, which a part's own may hold, are twins of themselves."""
    return spec if spec == OWN or isinstance(material(spec), Matte) else ANY_GLOSSY


def look_camera(look: Look, scene: Scene, light: Light, paths: int | None = None) -> SimulatedD435i:
    """The camera before the scene. paths: of a pixel that sees a glossy surface, None = the sensor's default."""
    imager = look.sensor.imager.model_copy(update={"laser_power_mw": light.laser_mw})
    dots = {} if look.dot_fwhm_px is None else {"dot_fwhm_px": look.dot_fwhm_px}
    settings = look.sensor.model_copy(update={"imager": imager, **dots})
    sampling = Sampling() if paths is None else Sampling(**plain_paths(paths))
    return SimulatedD435i(scene, settings, look.seed, sampling, known=loaded_scene(scene))


@lru_cache(1)
def loaded_scene(scene: Scene) -> LoadedScene:
    """The scene that a worker looked at last: what its surfaces see of one another is found once for all its poses."""
    return load_scene(scene)


def plain_paths(paths: int) -> dict[str, Any]:
    """Fields of the sampling for this many paths everywhere, the noisiest pixels not computed again."""
    return {"glossy_paths": paths, "refined_share": 0.0}


def look_pose(look: Look, scene: Scene) -> RigidTransform:
    """Pose T_world_cam: at the polar angle, azimuth and distance from the subject's middle, looking at it, turned as
    the sensor's mount has it."""
    middle = subject_middle(look.subject, scene)
    return pose_around(middle, look.polar_deg, look.azimuth_deg, look.distance_m, look.sensor.mount_roll_deg)


def pose_around(
    middle: Float[np.ndarray, "3"], polar_deg: float, azimuth_deg: float, distance_m: float, roll_deg: float
) -> RigidTransform:
    """T_world_cam that looks at a point [m] from this distance and side; angles from the vertical and from world x."""
    polar, azimuth = np.radians([polar_deg, azimuth_deg])
    outward = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    eye = middle + distance_m * (np.sin(polar) * outward + [0.0, 0.0, np.cos(polar)])
    # Straight down there is no upright: the image's top then points where it points at every other polar angle.
    return rolled(look_at(eye, middle, -outward if polar_deg == 0 else None), roll_deg)


def subject_middle(subject: str, scene: Scene) -> Float[np.ndarray, "3"]:
    """What the camera looks at [m]: the middle of the plate's front face, else of the part's bounding box."""
    if subject == "plate":
        return np.array([0.0, 0.0, plate_centre_height(PLATE_SIZE)])
    return part_box(scene).mean(axis=0)
