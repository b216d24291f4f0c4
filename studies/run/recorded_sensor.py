"""The sensor's settings of which a recording tells: exposure, gain, laser, preset, depth unit; and whether thresholds
that were certified for a sensor meet another one in it.

Options by librealsense's names in lower case, with librealsense's units, which are those of the settings, too.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from franbv.adapters.live.stated_sensor import flat_settings, stated_words
from franbv.adapters.recording.contents import Recording
from materials.input_error import InputError
from render.sensor import SensorSettings
from studies.base.config import read_yaml, validated
from studies.run.scene_settings import check_sensor

IMAGER_OPTIONS = {"exposure": "exposure_us", "gain": "gain", "laser_power": "laser_power_mw"}
"""Options with the imager's settings that they are about."""
PRESET_NUMBERS = {1: "default", 2: "hand", 3: "high_accuracy", 4: "high_density", 5: "medium_density"}
"""librealsense's numbers (`rs2_rs400_visual_preset`); 0 is a preset of the user's, of which no option tells."""
MODELS_BY_NAME = {"D435": "d435i", "D415": "d415"}
"""What a device's name has in it, and the model that stands for it; the D435 has the D435i's imagers."""
SENSOR_SECTION = "sensor"
"""Key of a file of settings (`thresholds.yaml`) under which it says for what sensor they hold."""


def check_recorded_sensor(recording: Recording) -> None:
    """InputError, with the recording's name, where what it states of its sensor is none that can be simulated."""
    if recording.run.sensor:
        source, said = "settings of its sensor", dict(recording.run.sensor)
    else:
        source, said = "options of the camera", sensor_fields(recording)
    settings = validated(SensorSettings, said, f"{recording.path}, {source}")
    try:
        check_sensor(settings)
    except InputError as error:
        raise InputError(f"{recording.path}, {source}: {error}") from error


def sensor_fields(recording: Recording) -> dict[str, Any]:
    """Fields of `SensorSettings` that the recording tells."""
    options, camera = recording.options, recording.camera
    fields: dict[str, Any] = {}
    imager = {name: options[option] for option, name in IMAGER_OPTIONS.items() if option in options}
    if options.get("emitter_enabled") == 0:
        imager["laser_power_mw"] = 0.0
    if imager:
        fields["imager"] = imager
    if "enable_auto_exposure" in options:
        fields["auto_exposure"] = bool(options["enable_auto_exposure"])
    if camera.depth_unit is not None:
        fields["depth"] = {"unit": camera.depth_unit}
    preset = _preset_name(options)
    if preset is not None:
        fields["preset"] = preset
    models = [model for words, model in MODELS_BY_NAME.items() if words in (camera.model or "").upper()]
    return fields | ({"model": models[0]} if models else {})


def unlike_sensor(file: Path, recording: Recording) -> str | None:
    """What a file of settings says of the sensor and the recording has otherwise, or does not tell; None where all is
    alike, or the file says nothing of it. InputError where it is nothing that a sensor can have."""
    section = read_yaml(file).get(SENSOR_SECTION, {})
    if not isinstance(section, dict):
        raise InputError(f"{file}: `{SENSOR_SECTION}` holds no keys with values; write lines like `preset: default`")
    sensor = validated(SensorSettings, section, f"{file}, {SENSOR_SECTION}").model_dump(mode="json")
    recorded, known = dict(flat_settings(_recorded_fields(recording))), dict(flat_settings(sensor))
    stated = {name: known[name] for name, _ in flat_settings(section) if name != "roll_deg"}  # parameters have it, too
    unlike = {name: value for name, value in stated.items() if name not in recorded or recorded[name] != value}
    if not unlike:
        return None
    told = {name: recorded[name] for name in unlike if name in recorded}
    untold = [name for name in unlike if name not in recorded]
    words = ([f"has {stated_words(told)}"] if told else []) + ([f"does not tell {', '.join(untold)}"] if untold else [])
    return f"{file}: its parameters hold for {stated_words(unlike)}; the recording {' and '.join(words)}"


def _recorded_fields(recording: Recording) -> Mapping[str, Any]:
    """Fields of the sensor: simulated, or real and recorded by us or by others."""
    own = recording.run.sensor
    if "options" not in own:
        return own or sensor_fields(recording)
    told = {name: value for name, value in own["options"].items() if value is not None}
    return sensor_fields(replace(recording, options=told)) | {"preset": own["settings"]["preset"]}


def _preset_name(options: Mapping[str, float | str]) -> str | None:
    said = options.get("visual_preset")
    if isinstance(said, str):
        words = said.strip().lower().replace(" ", "_")
        return words if words in PRESET_NUMBERS.values() else None
    return None if said is None else PRESET_NUMBERS.get(int(said))
