"""The views of a measurement of safe angles: every material from the same poses around the part, at every roll.

Each is a case of the sensitivity study's engine without the planner: rendered, exposed, matched, held against the truth
and labelled, its pixels counted in bins of true incidence.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import sqrt
from pathlib import Path
from typing import ClassVar

from materials.catalog import material
from materials.material import Matte
from materials.user_materials import NO_USER_MATERIALS, load_user_materials
from scenes.scene import Scene
from studies.base.case_folder import case_digest
from studies.run.scene_settings import SubjectSettings, build_subject, resolved
from studies.safe_angles.settings import SafeAnglesSettings, subject_in
from studies.sensitivity.cases import ANY_GLOSSY, LitCase, Look, SceneOf, azimuth_deg
from studies.sensitivity.counts import incidence_counts, view_counts, view_keys
from studies.sensitivity.measurement import CaseRows, CaseTask, write_case
from studies.sensitivity.preset import OWN, Light
from studies.sensitivity.views import lit_views

GLOSSY_PATHS = 32
"""Of a pixel that sees a glossy surface; choice: as the sensitivity study, whose labels are what is counted."""
POLAR_STEP = sqrt(2) - 1
"""From one pose to the next, in spans of the polar angle. Choice: with the golden angle of the azimuths, an irrational
that has no ratio to it, so that however many poses there are they spread evenly over both (Kronecker's sequence)."""
KEPT_SCENES = 2
"""Scenes that a worker keeps: the twin's and that of the material in turn."""


class AnglesView(LitCase):
    """One view: all that decides what it counts."""

    kind: ClassVar[str] = "safe angles 1"
    twin_of: str
    """Material that stands for all with the same twin."""

    @property
    def stand_in(self) -> str:
        """As it was found with the user's materials at hand."""
        return self.twin_of

    @property
    def roll_deg(self) -> float:
        """Turn of the camera [deg]."""
        return self.sensor.mount_roll_deg

    @property
    def title(self) -> str:
        """For people."""
        return f"{super().title}, roll {self.roll_deg:g} deg"


@dataclass(frozen=True)
class SubjectScene:
    """Makes the scenes of one subject; goes to the workers, who read a mesh from its file."""

    settings: SubjectSettings

    def __call__(self, look: Look, spec: str, light: Light) -> Scene:
        """The subject in a material under lamps."""
        return _scene(self.settings.model_dump_json(), spec, light.lamps)


@lru_cache(KEPT_SCENES)
def _scene(settings: str, spec: str, lamps: str) -> Scene:
    """Built once for all poses of a material."""
    return build_subject(subject_in(SubjectSettings.model_validate_json(settings), spec, lamps)).scene


def subject_scene(settings: SafeAnglesSettings) -> SceneOf:
    """What makes the scenes of these settings."""
    wanted = {name: getattr(settings, name) for name in SubjectSettings.model_fields}
    return SubjectScene(SubjectSettings(**wanted))


def subject_name(settings: SafeAnglesSettings) -> str:
    """The part's or the file's name; with a hash where its content, the bench or a material file decide more."""
    name = settings.part or settings.mesh.name if settings.mesh else str(settings.part)
    own = {field: getattr(resolved(settings), field) for field in SubjectSettings.model_fields}
    others = {"material": (), "lamps": None, "seed": 0, "sensor": SubjectSettings().sensor}
    scene = SubjectSettings(**{**own, **others})
    plain = scene == SubjectSettings(part=settings.part)
    return name if plain else f"{name} {case_digest('subject', scene)}"


def angle_views(settings: SafeAnglesSettings) -> list[AnglesView]:
    """All views, material by material, of each the poses of every roll in turn."""
    camera = resolved(settings).sensor
    light = Light(lamps=str(settings.lamps), laser_mw=camera.imager.laser_power_mw)
    user = load_user_materials(settings.materials_file) if settings.materials_file else NO_USER_MATERIALS
    name = subject_name(settings)
    return [
        AnglesView(
            subject=name,
            material=spec,
            polar_deg=polar,
            azimuth_deg=azimuth,
            distance_m=settings.distance,
            seed=number,
            dot_fwhm_px=None,
            lights=(light,),
            n_frames=settings.frames,
            sensor=camera.model_copy(update={"roll_deg": roll}),
            glossy_paths=GLOSSY_PATHS,
            twin_of=spec if spec == OWN or isinstance(material(spec, user), Matte) else ANY_GLOSSY,
        )
        for spec in settings.material
        for roll in settings.rolls
        for number, (polar, azimuth) in zip(_numbers(settings), poses_around(settings), strict=True)
    ]


def poses_around(settings: SafeAnglesSettings) -> list[tuple[float, float]]:
    """Polar angle and azimuth of every pose [deg]. Those of fewer poses are the first ones of more.

    Polar angles are as often steep as flat, so that surfaces that lie face up are seen at every incidence alike.
    """
    part = settings.part or ""
    return [
        (round(settings.most_polar * ((0.5 + number * POLAR_STEP) % 1), 6), azimuth_deg(part, number))
        for number in _numbers(settings)
    ]


def _numbers(settings: SafeAnglesSettings) -> Sequence[int]:
    """Of the poses: the seed is that of the first, so that another one continues the series."""
    return range(settings.seed, settings.seed + settings.poses)


def do_angles_view(task: CaseTask[AnglesView]) -> None:
    """For a worker: measure the view and write its folder."""
    write_case(task, counted_view)


def counted_view(config: AnglesView, twins: Path, scene_of: SceneOf) -> CaseRows:
    """Rows of the sensitivity study's tables: of the view, and of its bins of incidence."""
    (view,) = lit_views(config, twins, scene_of)
    keys = view_keys(config, view)
    incidence = [keys | counts for counts in incidence_counts(view)]
    return {"views": [keys | view_counts(view)], "incidence": incidence, "recovery_views": []}
