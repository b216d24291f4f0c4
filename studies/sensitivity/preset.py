"""What a sensitivity study measures: sweeps of subjects, materials, views and lights, read from a preset or a file."""

from collections.abc import Iterator
from itertools import product
from typing import Annotated

from pydantic import Field, model_validator

from franbv.parameters import Count, Parameters
from materials.catalog import finish_names, material, metal_names
from materials.suggestion import suggest
from render.d435i import SensorSettings
from render.imager.settings import REFERENCE_LASER_POWER_MW, ImagerSettings
from scenes.build import COUPONS
from scenes.lamps import LIGHTING_NAMES
from scenes.parts import ALL_PARTS
from studies.base.config import Config, Preset
from studies.run.scene_settings import check_sensor, mounted

OWN = "own"
"""Material of a part whose bodies keep what the real things are made of."""
ROUGHNESS_FINISH = "bright"
"""Finish whose roughness a sweep over `alphas` replaces (choice: any isotropic one without oxide will do)."""

Degrees = Annotated[float, Field(ge=0, le=85)]
Metres = Annotated[float, Field(ge=0.15, le=1.5)]
Alpha = Annotated[float, Field(ge=0.005, le=1.0)]
Milliwatts = Annotated[float, Field(ge=0, le=360)]
DotWidth = Annotated[float, Field(ge=3.2, le=8.0)]
Seed = Annotated[int, Field(ge=0)]


class Light(Config):
    """What shines on the subject."""

    lamps: str = "workshop"
    """Lamp preset."""
    laser_mw: Milliwatts = REFERENCE_LASER_POWER_MW
    """Laser power [mW]."""


class Sweep(Config):
    """All combinations of what it lists."""

    name: str
    """What the tables and the report call it."""
    subjects: tuple[str, ...] = ("plate",)
    """Coupons, or parts."""
    metals: tuple[str, ...] = ()
    """Metals, each with every finish and every alpha below that it can have."""
    finishes: tuple[str, ...] = ()
    """Finishes of the metals."""
    alphas: tuple[Alpha, ...] = ()
    """Isotropic GGX roughness of the metals instead of a finish [-]."""
    materials: tuple[str, ...] = ()
    """More materials by name; `own` leaves a part as it is."""
    polar_deg: tuple[Degrees, ...] = (45.0,)
    """Angles of the view from the vertical [deg]: on the level plate the angle of incidence."""
    distances_m: tuple[Metres, ...] = (0.3,)
    """Distances of the camera from the subject's middle [m]."""
    lamps: tuple[str, ...] = ("workshop",)
    """Lamp presets."""
    lasers_mw: tuple[Milliwatts, ...] = (REFERENCE_LASER_POWER_MW,)
    """Laser powers [mW]. Lights other than the first lamps with the first power are measured but not recovered."""
    dots_fwhm_px: Annotated[tuple[DotWidth | None, ...], Field(min_length=1)] = (None,)
    """Widths of the projector's dots at half their height, in 1280x720 images [px]; null = as the study's sensor has
    them. Others are measured and tabulated by width, and left out of all other figures."""
    seeds: tuple[Seed, ...] = (0,)
    """Each turns the camera to another azimuth and draws other noise."""
    recovery: bool = False
    """Whether the recovery of detected regions is measured, which takes many more views."""
    hemisphere_poses: Annotated[int, Field(ge=0)] = 0
    """Poses around each recovered region that are tried to learn what was possible; 0 = none. 200 of them take two
    minutes of a processor a case."""

    @model_validator(mode="after")
    def _known(self) -> "Sweep":
        for words, known in ((self.metals, metal_names()), (self.lamps, LIGHTING_NAMES), (self.subjects, SUBJECTS)):
            for word in words:
                if word not in known:
                    raise ValueError(f"{word}: there is none; {suggest(word, known)}")
        if self.metals and not (self.finishes or self.alphas):
            raise ValueError(f"sweep {self.name}: metals need finishes or alphas")
        if not self.specs():
            raise ValueError(f"sweep {self.name}: lists no materials; give metals with finishes, or materials")
        if self.hemisphere_poses and not self.recovery:
            raise ValueError(f"sweep {self.name}: hemisphere_poses are tried for a recovery; give recovery: true")
        if OWN in self.materials and not set(self.subjects) <= set(ALL_PARTS):
            raise ValueError(f"sweep {self.name}: `{OWN}` is for parts; name a material for coupons")
        return self

    def specs(self) -> tuple[str, ...]:
        """All materials, checked; a metal that grows no oxide is left out where a finish needs one."""
        return tuple(dict.fromkeys(self._specs()))

    def _specs(self) -> Iterator[str]:
        for metal, finish in product(self.metals, self.finishes):
            if finish in finish_names(metal) or finish not in finish_names():
                yield material(f"{metal}:{finish}").name
        for metal, alpha in product(self.metals, self.alphas):
            yield material(f"{metal}:{ROUGHNESS_FINISH}@alpha={alpha:g}").name
        for spec in self.materials:
            yield spec if spec == OWN else material(spec).name

    def lights(self) -> tuple[Light, ...]:
        """All lights, the one that everything else is measured by first."""
        return tuple(Light(lamps=lamps, laser_mw=laser) for lamps, laser in product(self.lamps, self.lasers_mw))


SUBJECTS = (*COUPONS, *ALL_PARTS)
"""What a sweep can look at."""


class SensitivityPreset(Preset):
    """A whole study."""

    title: str
    """Headline of the report."""
    sweeps: Annotated[tuple[Sweep, ...], Field(min_length=1)]
    """What is measured."""
    n_frames: Count = 3
    """Frames of a burst. Choice: the fewest with a majority; noise hides little of a hole."""
    glossy_paths: Count = 32
    """Paths of a pixel that sees a glossy surface; the noisiest are not computed again as the sensor by itself would.
    Choice: shares of holes move by about a percent, single pixels more."""
    other_paths: Count = 16
    """The same for the views that say what a recovery regains. Choice: shares hardly move with it, and most of the time
    goes there."""
    sensor: SensorSettings = SensorSettings()
    """The camera."""
    parameters: Parameters = Parameters()
    """Of the method."""

    @model_validator(mode="after")
    def _consistent(self) -> "SensitivityPreset":
        names = [sweep.name for sweep in self.sweeps]
        if len(set(names)) < len(names):
            raise ValueError(f"two sweeps are called {max(names, key=names.count)}")
        if self.sensor.imager.laser_power_mw != ImagerSettings().laser_power_mw:
            raise ValueError("the laser power belongs into the sweeps, as lasers_mw")
        check_sensor(self.sensor)
        mounted(self.parameters, self.sensor)
        return self
