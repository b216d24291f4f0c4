"""What a study of mitigations measures: metals, finishes, coupons, light, and which remedies are tried on them."""

from collections.abc import Iterator
from itertools import product
from typing import Annotated

from pydantic import Field, model_validator

from materials.catalog import finish_names, material, material_names, metal_names
from materials.suggestion import suggest
from render.d435i import SensorSettings
from scenes.build import BENCHES, COUPONS, BenchName
from studies.advise.settings import AdviseSettings, checked_settings
from studies.base.config import Preset
from studies.mitigations.declared import declared_factors
from studies.run.scene_settings import check_sensor

STANDARD_REMEDIES: dict[str, tuple[str, ...]] = {
    "preset": ("high_accuracy", "high_density", "medium_density"),
    "RSM removal threshold": ("off",),
    "laser": ("60 mW", "360 mW"),
    "set-point": ("32 DN", "128 DN"),
    "HDR pair": ("8500 and 1000 us",),
    "frames": ("median of 9",),
    "filters": ("temporal filter", "hole filling, largest disparity", "recommended chain"),
    "decimation": ("by 8",),
    "lamps": ("off", "dim"),
    "spray": ("matte",),
    "roll": ("90 deg",),
    "second look": ("turned by 90 deg",),
    "stand-off": ("0.75 times", "1.33 times"),
    "polarisers": ("crossed", "on the imagers"),
    "placing of lamps": ("diffuse",),
    "band-pass filter": ("850 nm",),
    "tilt of the part": ("30 deg",),
}
"""Remedies of a study that names none. Choice: one telling level of each factor, two where people advise either way."""
NAMED_LIST = Annotated[tuple[str, ...], Field(min_length=1)]


class MitigationsPreset(Preset):
    """A whole study."""

    title: str
    """Headline of the report."""
    metals: tuple[str, ...] = ()
    """Each with every finish below that it can have."""
    finishes: tuple[str, ...] = ()
    """Of the metals."""
    materials: tuple[str, ...] = ()
    """More materials by name, such as black_plastic, whose clear coat polarises where metals hardly do."""
    coupons: NAMED_LIST = ("upright_cylinder",)
    """Shapes that each material is looked at in. Choice: an upright cylinder is curved as bars are, has a flat end, and
    changes when it is tilted."""
    remedies: Annotated[dict[str, NAMED_LIST], Field(min_length=1)] = STANDARD_REMEDIES
    """Levels by factor, as `studies.advise.factors` names them; each is tried by itself."""
    bench: BenchName = "workshop"
    """What coupons stand on and in."""
    lamps: str | None = None
    """Lamp preset of the bench; null = its own."""
    poses: Annotated[int, Field(ge=2, le=200)] = 3
    """Around each coupon, the same for all remedies and materials. Choice: rendering is nearly all of the cost; what
    three poses do not settle, many cases do."""
    seeds: Annotated[int, Field(ge=1, le=20)] = 1
    """Draws of noise at every pose. Choice: poses differ far more."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Root of poses and noise."""
    distance: Annotated[float, Field(gt=0.05, le=5.0)] | None = None
    """From the camera to the coupon's middle [m]; null = the planner's stand-off beside half the coupon's diagonal."""
    sensor: SensorSettings = SensorSettings(decimation=1, crop=None)
    """The camera as it is set: what all remedies are held against."""

    @model_validator(mode="after")
    def _known(self) -> "MitigationsPreset":
        lists = (
            ("metals", self.metals, metal_names()),
            ("finishes", self.finishes, finish_names()),
            ("materials", self.materials, material_names()),
            ("coupons", self.coupons, tuple(COUPONS)),
        )
        for name, words, known in lists:
            for word in words:
                if word not in known:
                    raise ValueError(f"{name}: there is no {word}; {suggest(word, known)}")
            if len(set(words)) < len(words):
                raise ValueError(f"{name}: {max(words, key=words.count)} stands there twice")
        if bool(self.metals) != bool(self.finishes):
            raise ValueError("metals go with finishes; give both or neither")
        if not self.specs():
            raise ValueError("lists no materials; give metals with finishes, or materials")
        declared_factors(self.remedies)
        BENCHES[self.bench].lighting(self.lamps or BENCHES[self.bench].lamps)
        checked_settings(AdviseSettings(sensor=self.sensor))
        check_sensor(self.sensor)
        return self

    def specs(self) -> tuple[str, ...]:
        """All materials; a metal that grows no oxide is left out where a finish needs one."""
        return tuple(dict.fromkeys(self._specs()))

    def _specs(self) -> Iterator[str]:
        for metal, finish in product(self.metals, self.finishes):
            if finish in finish_names(metal):
                yield material(f"{metal}:{finish}").name
        for spec in self.materials:
            yield material(spec).name
