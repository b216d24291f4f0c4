"""What a file of thresholds says of the camera that they hold for: set where the camera can be, said where it cannot.

`thresholds.yaml` of a study has the method's numbers under `parameters`, and under `sensor` those of the simulated
camera that differ from its defaults or were chosen, by the simulator's names.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

SECTIONS = {"parameters", "sensor"}
"""Of the file; one without them has the method's numbers alone."""
REALSENSE_NAMES = {
    **{name: name for name in ("model", "profile", "decimation", "crop", "preset")},
    **{f"imager.{name}": name for name in ("laser_power_mw", "exposure_us", "gain")},
}
"""The simulator's settings that a RealSense can be set to, with their names in `RealSenseSettings`."""
_MANUAL = ("imager.exposure_us", "imager.gain")


@dataclass(frozen=True)
class StatedSensor:
    """The section `sensor`, sorted."""

    settings: dict[str, Any]
    """By the names of the camera's own settings: those that it can be set to."""
    others: dict[str, Any]
    """By the simulator's names: those that nothing here sets."""


def thresholds_sections(stated: Mapping[str, Any]) -> tuple[Any, Any]:
    """The method's numbers and what is said of the camera, of a file's content."""
    if set(stated) <= SECTIONS:
        return stated.get("parameters", {}), stated.get("sensor", {})
    return stated, {}


def stated_sensor(section: Mapping[str, Any], camera: str) -> StatedSensor:
    """Sort the section. camera: its kind, as in `open_camera`; only of a RealSense it is known what it can be set to.

    The mount's turn is left out: it is the planner's, too, and stands under `parameters`.
    """
    said = {name: value for name, value in flat_settings(section) if name != "roll_deg"}
    settings: dict[str, Any] = {}
    if camera == "realsense":
        auto = said.pop("auto_exposure", None)
        if auto is not False:  # exposure and gain then are what it chooses
            said = {name: value for name, value in said.items() if name not in _MANUAL}
        names = [name for name in said if name in REALSENSE_NAMES and not _is_content(said[name])]
        settings = {REALSENSE_NAMES[name]: said.pop(name) for name in names}
        settings |= {"exposure_us": "auto"} if auto else {}
    return StatedSensor(settings, said)


def contradicted(settings: Mapping[str, Any], own: Mapping[str, Any]) -> str | None:
    """The first setting that a camera's own file has otherwise, in words; None where there is none."""
    for name, value in settings.items():
        if name in own and own[name] != value:
            return f"{name} {value}, and not {own[name]}"
    return None


def stated_words(settings: Mapping[str, Any]) -> str:
    """For people."""
    return ", ".join(f"{name} {value}" for name, value in settings.items())


def flat_settings(section: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Settings by dotted names, those of nested sections as well."""
    for name, value in section.items():
        if isinstance(value, Mapping):
            yield from flat_settings(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _is_content(value: Any) -> bool:
    """Whether it is what a simulator knows of a preset's file, which is not all that the camera needs of it."""
    return isinstance(value, str) and value.lstrip().startswith("{")
