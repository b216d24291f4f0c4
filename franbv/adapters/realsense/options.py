"""The camera's options: set as the settings say, read back, and all of them written down."""

from pathlib import Path
from typing import Any

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.devices import device_info
from franbv.adapters.realsense.sdk import sdk, sdk_text
from franbv.adapters.realsense.settings import VISUAL_PRESETS, RealSenseSettings


def set_preset(device: Any, sensor: Any, preset: str, where: str) -> None:
    """Load a preset by its name, or a JSON file of the viewer. Before the stream is opened, when the camera applies it
    anew for the resolution, and with it the preset's own laser and exposure (librealsense, advanced_mode)."""
    if device_info(device, "advanced_mode") == "NO":
        raise CameraError(
            f"{where}: its advanced mode is off, which presets need; switch it on in the RealSense viewer"
        )
    if preset in VISUAL_PRESETS:
        set_option(sensor, "visual_preset", int(getattr(sdk().rs400_visual_preset, preset)), where, read_back=False)
        return
    file = Path(preset)
    if file.suffix.lower() != ".json":
        raise CameraError(
            f"preset {preset!r}: not known; use one of {', '.join(VISUAL_PRESETS)}, or a .json file of the viewer"
        )
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeError) as error:
        raise CameraError(f"{preset}: cannot be read ({sdk_text(error)}); save it anew from the viewer") from None
    try:
        sdk().serializable_device(device).load_json(text)
    except RuntimeError as error:
        raise CameraError(
            f"{preset}: {where} does not take it ({sdk_text(error)}); save it anew from the viewer"
        ) from None


def set_light(sensor: Any, settings: RealSenseSettings, where: str) -> None:
    """Projector and exposure, where the settings say anything of them; after the stream is opened."""
    wanted: dict[str, float] = {}
    if settings.exposure_us == "auto":
        wanted["enable_auto_exposure"] = 1.0
    elif settings.exposure_us is not None:
        wanted |= {"enable_auto_exposure": 0.0, "exposure": settings.exposure_us}
    if settings.gain is not None:
        wanted["gain"] = settings.gain
    if settings.emitter is not None:
        wanted["emitter_enabled"] = float(settings.emitter)
    if settings.laser_power_mw is not None:
        wanted["laser_power"] = settings.laser_power_mw
    for name, value in wanted.items():
        set_option(sensor, name, value, where)


def set_option(sensor: Any, name: str, value: float, where: str, read_back: bool = True) -> None:
    """Set one option by librealsense's name; CameraError if the camera lacks it, its range or its steps do not hold the
    value, or it reads back another."""
    option = getattr(sdk().option, name)
    if not sensor.supports(option):
        raise CameraError(f"{where}: has no option {name}; leave it out of the settings, or use a D400 camera")
    span = sensor.get_option_range(option)
    steps = (value - span.min) / span.step if span.step > 0 else 0.0
    if not span.min <= value <= span.max or abs(steps - round(steps)) > 1e-3:  # of 32-bit floats
        raise CameraError(
            f"{where}: {name} {value:g}: it has {span.min:g} to {span.max:g} in steps of {span.step:g}; choose "
            "one of these"
        )
    try:
        sensor.set_option(option, value)
        found = sensor.get_option(option) if read_back else value
    except RuntimeError as error:
        raise CameraError(f"{where}: {name} {value:g}: {sdk_text(error)}; unplug it and plug it in") from None
    if abs(found - value) > span.step / 2:
        raise CameraError(f"{where}: {name} stays at {found:g} instead of {value:g}; close other programs that use it")


def all_options(sensor: Any) -> dict[str, float | None]:
    """The value of every option by librealsense's name; None for what cannot be read at the moment."""
    values: dict[str, float | None] = {}
    for option in sensor.get_supported_options():
        try:
            values[option.name] = float(sensor.get_option(option))
        except RuntimeError:
            values[option.name] = None
    return values


def disparity_shift(device: Any) -> int:
    """Start of the disparity search [px], as the preset that was loaded has it; 0 where advanced mode, which alone can
    change it, is off."""
    if device_info(device, "advanced_mode") != "YES":
        return 0
    return int(sdk().rs400_advanced_mode(device).get_depth_table().disparityShift)
