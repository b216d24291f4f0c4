"""The camera among what is chosen: every combination of the stated values of its fields is an alternative.

Alternatives see the same draws with the same seeds, each in a bank of its own (`studies.thresholds.bank`), so that what
they show of a draw differs by the camera alone.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import product
from operator import getitem
from typing import Any

from pydantic import BaseModel

from materials.input_error import InputError
from materials.suggestion import suggest
from render.d435i import SensorSettings
from render.matcher.d400_preset import is_file_name, load_preset
from studies.base.config import validated

SENSOR = "sensor."
"""Start of the settings that are the camera's: then a field of `SensorSettings`, with those of nested ones by dots."""
PRESET = f"{SENSOR}preset"
SENSOR_CHOICES = tuple(
    f"{SENSOR}{field}"
    for field in (
        *("preset", "auto_exposure", "imager.exposure_us", "imager.gain", "imager.laser_power_mw", "imager.set_point"),
        *("imager.band_pass", "depth.unit", "depth.clamp_min", "depth.clamp_max"),
    )
)
"""What a camera can be set to; a filter can be put before its lenses."""
LOOKED_THROUGH = tuple(f"{SENSOR}{field}" for field in ("roll_deg", "model", "profile", "decimation", "crop"))
"""What poses and pixels hang on. Settings would no longer be compared on the same pixels of the same views, and counts
of pixels (`LEAST_HOLE_PX`, `cluster_min_samples`) would mean something else for each."""
_ALWAYS = (PRESET, f"{SENSOR}auto_exposure", f"{SENSOR}imager.laser_power_mw")
_ONLY_MANUAL, _ONLY_AUTO = (f"{SENSOR}imager.exposure_us", f"{SENSOR}imager.gain"), (f"{SENSOR}imager.set_point",)

NO_EFFECT = "no effect"
"""In place of a value."""

Stated = Mapping[str, Sequence[Any]]
"""Values to choose among, by setting, those of the planner with them."""


@dataclass(frozen=True, eq=False)
class SensorAlternative:
    """A camera that is chosen among."""

    values: dict[str, Any]
    """By setting, as they were stated; NO_EFFECT for one that does nothing beside the others."""
    sensor: SensorSettings
    """All of its settings, resolved."""

    @property
    def section(self) -> dict[str, Any]:
        """What a file of settings says of it: what differs from the defaults, and what a person sets."""
        said = self.sensor.model_dump(mode="json", exclude_defaults=True)
        whole = self.sensor.model_dump(mode="json")
        chosen = [name for name, value in self.values.items() if value != NO_EFFECT]
        for name in (*_ALWAYS, *chosen, *(() if self.sensor.auto_exposure else _ONLY_MANUAL)):
            _put(said, name, _at(whole, name))
        return said

    @property
    def words(self) -> str:
        """What was chosen, for people."""
        told = {name: value for name, value in self.values.items() if value != NO_EFFECT}
        return ", ".join(f"{name.removeprefix(SENSOR)} {value}" for name, value in told.items())


def sensor_names(stated: Stated) -> tuple[str, ...]:
    """Those of the settings that are the camera's."""
    return tuple(name for name in stated if name.startswith(SENSOR))


def check_sensor_names(stated: Stated, sensor: SensorSettings) -> None:
    """ValueError for a setting that no camera has, that it cannot be set to, or that would have no effect. sensor: the
    declared one."""
    for name in sensor_names(stated):
        if name in LOOKED_THROUGH:
            raise ValueError(
                f"settings: {name}: poses and pixels of all draws hang on it; state it once, under domain.sensor"
            )
        if name not in SENSOR_CHOICES and name in _fields(SensorSettings, SENSOR):
            raise ValueError(
                f"settings: {name}: is what the camera is, and nothing that it can be set to; declare it under "
                "domain.sensor"
            )
        if name not in SENSOR_CHOICES:
            raise ValueError(f"settings: the camera has no {name}; {suggest(name, SENSOR_CHOICES)}")
    if PRESET in stated and sensor.matcher != "d4":
        raise ValueError(f"settings: {PRESET}: the matcher {sensor.matcher} knows no presets; declare matcher d4")
    if PRESET in stated and (is_file_name(sensor.preset) or sensor.preset.lstrip().startswith("{")):
        raise ValueError(
            f"domain.sensor.preset: a file, but {PRESET} is chosen among; name the file there, or leave {PRESET} out"
        )


def _fields(model: type[BaseModel], prefix: str) -> Iterator[str]:
    """Fields by their dotted paths, those of nested models instead of the models."""
    for name, field in model.model_fields.items():
        nested = field.annotation
        if isinstance(nested, type) and issubclass(nested, BaseModel):
            yield from _fields(nested, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}"


def chosen_preset_files(stated: Stated) -> list[str]:
    """Preset files that are chosen among."""
    return [text for text in stated.get(PRESET, ()) if isinstance(text, str) and is_file_name(text)]


def with_preset_texts(stated: Stated) -> dict[str, tuple[Any, ...]]:
    """The settings with the content of preset files in place of their names; InputError where one cannot be read."""
    settings = {name: tuple(values) for name, values in stated.items()}
    if PRESET in settings:
        files = chosen_preset_files(stated)
        settings[PRESET] = tuple(load_preset(text).text if text in files else text for text in settings[PRESET])
    return settings


def sensor_alternatives(stated: Stated, sensor: SensorSettings) -> tuple[SensorAlternative, ...]:
    """Every combination, in the order of the values; the declared camera where nothing of it is chosen.

    stated: with `with_preset_texts`; sensor: the declared one, resolved. What has no effect in a combination, an
    exposure under auto-exposure say, is as declared, and combinations that are then alike are one. InputError for a
    value that no camera has, and for a setting that has no effect in any combination.
    """
    names = sensor_names(stated)
    if not names:
        return (SensorAlternative({}, sensor),)
    found: dict[str, SensorAlternative] = {}
    for values in product(*(stated[name] for name in names)):
        chosen = dict(zip(names, values, strict=True))
        idle = _ONLY_MANUAL if _sensor_with(sensor, chosen).auto_exposure else _ONLY_AUTO
        made = _sensor_with(sensor, {name: value for name, value in chosen.items() if name not in idle})
        shown = {name: NO_EFFECT if name in idle else _in_words(value) for name, value in chosen.items()}
        found.setdefault(made.model_dump_json(), SensorAlternative(shown, made))
    alternatives = tuple(found.values())
    for name in names:
        if all(alternative.values[name] == NO_EFFECT for alternative in alternatives):
            auto = name in _ONLY_AUTO
            raise InputError(
                f"settings: {name} has no effect {'without' if auto else 'under'} auto-exposure; state "
                f"sensor.auto_exposure: [{str(auto).lower()}] as well, or leave it out"
            )
    return alternatives


def _sensor_with(sensor: SensorSettings, chosen: Mapping[str, Any]) -> SensorSettings:
    """The declared camera with these values; what a preset's file says comes first, and what is stated counts."""
    if PRESET in chosen:
        sensor = _validated(sensor.model_dump() | {"preset": chosen[PRESET]}).resolved()
    stated = sensor.model_dump()
    for name, value in chosen.items():
        if name != PRESET:
            _put(stated, name, value)
    return _validated(stated)


def _at(sensor: Mapping[str, Any], name: str) -> Any:
    """The value of a setting in a sensor's dump."""
    return reduce(getitem, name.removeprefix(SENSOR).split("."), sensor)


def _put(sensor: dict[str, Any], name: str, value: Any) -> None:
    """Put it there."""
    *groups, field = name.removeprefix(SENSOR).split(".")
    reduce(lambda inner, group: inner.setdefault(group, {}), groups, sensor)[field] = value


def _in_words(value: Any) -> Any:
    """A filter as text, so that all values can be compared and counted alike."""
    return json.dumps(value) if isinstance(value, Mapping) else value


def _validated(stated: dict[str, Any]) -> SensorSettings:
    return validated(SensorSettings, stated, "settings, sensor")
