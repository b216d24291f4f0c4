"""The sensor's settings of which a recording tells: exposure, gain, laser, preset, depth unit.

Options by librealsense's names in lower case, with librealsense's units, which are those of the settings, too.
"""

from collections.abc import Mapping
from typing import Any

from franbv.adapters.recording.contents import Recording
from materials.input_error import InputError
from render.sensor import SensorSettings
from studies.base.config import validated
from studies.run.scene_settings import check_sensor

IMAGER_OPTIONS = {"exposure": "exposure_us", "gain": "gain", "laser_power": "laser_power_mw"}
"""Options with the imager's settings that they are about."""
PRESET_NUMBERS = {1: "default", 2: "hand", 3: "high_accuracy", 4: "high_density", 5: "medium_density"}
"""librealsense's numbers (`rs2_rs400_visual_preset`); 0 is a preset of the user's, of which no option tells."""
MODELS_BY_NAME = {"D435": "d435i", "D415": "d415"}
"""What a device's name has in it, and the model that stands for it; the D435 has the D435i's imagers."""


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


def _preset_name(options: Mapping[str, float | str]) -> str | None:
    said = options.get("visual_preset")
    if isinstance(said, str):
        words = said.strip().lower().replace(" ", "_")
        return words if words in PRESET_NUMBERS.values() else None
    return None if said is None else PRESET_NUMBERS.get(int(said))
