"""What an advice is asked for: a part before a camera, poses, and how much time it may take."""

from typing import Annotated

import tyro
from pydantic import Field

from materials.input_error import InputError
from render.d435i import SensorSettings
from studies.advise.setup import Setup
from studies.run.scene_settings import SubjectSettings, on_bench, resolved


class AdviseSettings(SubjectSettings):
    """All that decides what is measured; not how much of it."""

    sensor: SensorSettings = SensorSettings(decimation=1, crop=None)
    """The camera as it is set: what all remedies are held against. Its depth counts at the stream's full resolution,
    unless it decimates."""
    poses: Annotated[int, Field(ge=2, le=200), tyro.conf.arg(metavar="N")] = 6
    """Poses around the part, the same for all remedies. Choice: intervals over fewer say little, and each costs some
    seconds for every new light."""
    pose: Annotated[tuple[str, ...], tyro.conf.arg(metavar="AZIMUTH,ELEVATION,DISTANCE|eye:X,Y,Z ...")] = ()
    """These poses instead, at least two [deg, deg, m], or positions [m]; the camera looks at the part's middle."""
    distance: Annotated[float, Field(gt=0.05, le=5.0), tyro.conf.arg(metavar="M")] | None = None
    """From the camera to the part's middle [m]; None: the planner's stand-off beside half the part's diagonal."""
    seeds: Annotated[int, Field(ge=1, le=20), tyro.conf.arg(metavar="N")] = 2
    """Draws of noise and speckle at every pose, the same for all remedies."""


def checked_settings(settings: AdviseSettings) -> AdviseSettings:
    """The settings with what the bench decides; InputError for whatever cannot be advised on, before anything is."""
    if settings.sensor.crop is not None:
        raise InputError("--sensor.crop: remedies are scored over the whole image; leave it out")
    if 0 < len(settings.pose) < 2:
        raise InputError("--pose: intervals need poses to vary over; give two or more, or --poses N")
    return on_bench(settings)


def subject_of(settings: AdviseSettings) -> SubjectSettings:
    """What stands before the camera, input files by content; the camera left out, which remedies change."""
    whole = resolved(settings)
    fields = {name: getattr(whole, name) for name in SubjectSettings.model_fields}
    return SubjectSettings(**{**fields, "sensor": SensorSettings()})


def base_setup(settings: AdviseSettings) -> Setup:
    """The camera as it is set."""
    return Setup(sensor=resolved(settings).sensor)
