"""Draws of the declared domain: which part, of what, in which light, seen from where, by number.

A draw depends on the study's seed and its number alone: a larger budget adds draws and changes none.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.parameters import Parameters
from scenes.reference_points import part_box
from scenes.scene import Scene
from studies.base.config import Config
from studies.dataset.draw.weighted_draw import pick
from studies.run.reconstruct import ReconstructSettings
from studies.run.scene_settings import SubjectSettings, mounted, on_bench
from studies.sensitivity.cases import pose_around
from studies.sensitivity.preset import OWN
from studies.thresholds.config import Domain

VIEW_STREAM, RUN_STREAM = 1, 2
"""Tell the seeds of views and of reconstructions apart (choice)."""


class DomainView(Config):
    """One view of one scene."""

    number: int
    part: str
    """Of ours, or a mesh of the domain."""
    material: str
    """`own`, or of the whole part."""
    lamps: str
    polar_deg: float
    azimuth_deg: float
    distance_m: float
    """From the middle of the part's box."""
    seed: int
    """Of the sensor's noise and the planner."""


@dataclass(frozen=True)
class RunDraw:
    """One reconstruction of one scene, but for the setting."""

    number: int
    part: str
    material: str
    lamps: str
    azimuth_deg: float
    """Where the first view stands."""
    seed: int


def view_draw(domain: Domain, seed: int, number: int) -> DomainView:
    """View number `number`."""
    rng = np.random.default_rng([seed, VIEW_STREAM, number])
    scene = _scene(rng, domain)
    low, high = np.cos(np.radians(domain.polar_deg))
    return DomainView(
        number=number,
        **scene,
        polar_deg=round(float(np.degrees(np.arccos(rng.uniform(high, low)))), 4),
        azimuth_deg=round(float(rng.uniform(0, 360)), 4),
        distance_m=round(float(rng.uniform(*domain.distance_m)), 4),
        seed=int(rng.integers(2**31)),
    )


def run_draw(domain: Domain, seed: int, number: int) -> RunDraw:
    """Reconstruction number `number`."""
    rng = np.random.default_rng([seed, RUN_STREAM, number])
    scene = _scene(rng, domain)
    return RunDraw(number, **scene, azimuth_deg=round(float(rng.uniform(0, 360)), 4), seed=int(rng.integers(2**31)))


def _scene(rng: np.random.Generator, domain: Domain) -> dict[str, str]:
    return {name: pick(rng, getattr(domain, weights)) for name, weights in _DRAWN.items()}


_DRAWN = {"part": "parts", "material": "materials", "lamps": "lamps"}


def subject_settings(domain: Domain, draw: DomainView | RunDraw) -> SubjectSettings:
    """The scene as the commands take it."""
    cad = domain.meshes.get(draw.part)
    given = {} if cad is None else {"mesh": cad.file, "units": cad.units, "up": cad.up}
    own = () if cad is None else cad.material
    settings = SubjectSettings(
        part=None if cad else draw.part,
        **given,
        material=own if draw.material == OWN else (draw.material,),
        materials_file=domain.materials_file,
        bench=domain.bench,
        lamps=draw.lamps,
        seed=draw.seed,
        sensor=domain.sensor,
    )
    return on_bench(settings)


def drawn_run(domain: Domain, draw: RunDraw, parameters: Parameters) -> ReconstructSettings:
    """A reconstruction as `franbv reconstruct` takes it, with the paper's planner and its roll from the mount."""
    subject = subject_settings(domain, draw)
    settings = ReconstructSettings(
        **{name: getattr(subject, name) for name in SubjectSettings.model_fields},
        planner="fra",
        azimuth_deg=draw.azimuth_deg,
        parameters=parameters,
    )
    return settings.model_copy(update={"parameters": mounted(parameters, settings.sensor)})


def view_pose(draw: DomainView, scene: Scene, roll_deg: float) -> RigidTransform:
    """T_world_cam [m] of a view, the camera turned by the mount's roll."""
    return pose_around(part_box(scene).mean(axis=0), draw.polar_deg, draw.azimuth_deg, draw.distance_m, roll_deg)
