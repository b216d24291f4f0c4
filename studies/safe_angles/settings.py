"""What safe angles are measured for: a subject, materials, camera, light, and how many poses around it."""

from typing import Annotated

import tyro
from pydantic import Field

from materials.catalog import material
from materials.input_error import InputError
from materials.user_materials import NO_USER_MATERIALS, load_user_materials
from studies.run.scene_settings import SubjectSettings, build_subject, on_bench
from studies.sensitivity.preset import OWN, Metres


class SafeAnglesSettings(SubjectSettings):
    """All that decides what is measured."""

    material: Annotated[tuple[str, ...], tyro.conf.arg(metavar="METAL:FINISH ...")] = ()
    """Materials, each with a card of its own; `own` for a part as the real thing is."""
    poses: Annotated[int, Field(ge=1, le=2000), tyro.conf.arg(metavar="N")] = 88
    """Poses around the part, measured at every roll. More of them know more; those that are measured stay. Choice: all
    bins of a box but the first have the 22 views that `--confidence 0.9` needs, in some five minutes of two cores."""
    rolls: Annotated[tuple[Annotated[float, Field(ge=-180, le=180)], ...], tyro.conf.arg(metavar="DEG ...")] = (
        0.0,
        90.0,
    )
    """Turns of the camera about its optical axis, a line of each card for each [deg]: 0 = baseline horizontal, 90 = on
    end."""
    most_polar: Annotated[float, Field(ge=0, le=85), tyro.conf.arg(metavar="DEG")] = 75.0
    """Largest angle of a view from the vertical [deg]; the poses spread evenly from 0 to there. Choice: lower ones look
    along the table."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Number of the first pose, which sets angles and noise: another one continues the series."""
    distance: Annotated[Metres, tyro.conf.arg(metavar="M")] = 0.3
    """From the camera to the part's middle [m]."""
    frames: Annotated[int, Field(ge=1, le=100)] = 3
    """Frames of a burst; a pixel has depth if it has in most of them. Choice: as the sensitivity study."""


def check_settings(settings: SafeAnglesSettings) -> SafeAnglesSettings:
    """The settings with the bench's light, materials and rolls each once, and the camera's roll left to the rolls.

    InputError for whatever cannot be measured, before anything is.
    """
    if settings.sensor.roll_deg is not None:
        raise InputError(
            f"--sensor.roll-deg {settings.sensor.roll_deg:g}: each view is taken at several rolls; give --rolls instead"
        )
    if not settings.material:
        raise InputError("no material to make a card of; give --material metal:finish, or several")
    if not settings.rolls:
        raise InputError("no roll of the camera; give --rolls 0 90, or leave it out")
    user = load_user_materials(settings.materials_file) if settings.materials_file else NO_USER_MATERIALS
    specs = tuple(spec if spec == OWN else material(spec, user).name for spec in settings.material)
    update = {"material": tuple(dict.fromkeys(specs)), "rolls": tuple(dict.fromkeys(settings.rolls))}
    checked = on_bench(settings).model_copy(update={**update, "sensor": settings.sensor})
    for spec in checked.material:
        build_subject(subject_in(checked, spec))
    return checked


def subject_in(settings: SubjectSettings, spec: str, lamps: str | None = None) -> SubjectSettings:
    """The settings of the subject in one material, under these lamps, None = its own."""
    update = {"material": () if spec == OWN else (spec,), "lamps": lamps or settings.lamps}
    return settings.model_copy(update=update)
