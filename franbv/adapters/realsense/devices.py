"""Which cameras are plugged in, and the one that is meant."""

from collections.abc import Sequence
from functools import cache
from typing import Any

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.sdk import sdk, sdk_text

LIST_THEM = "`python -m franbv.adapters cameras` lists them"
TEMPERATURES = {"asic_temperature": "asic_deg_c", "projector_temperature": "projector_deg_c"}
"""librealsense's options with our names, in degrees Celsius. Cameras answer while they stream."""


class NotConnectedError(CameraError):
    """The camera that is meant is not there, or not yet."""


@cache
def _context() -> Any:
    """One for the process: each has a thread that watches the bus."""
    return sdk().context()


def connected_devices() -> list[Any]:
    """librealsense's devices, none opened."""
    context = _context()
    try:
        return list(context.query_devices())
    except RuntimeError as error:
        raise NotConnectedError(
            f"RealSense: the bus cannot be read ({sdk_text(error)}); unplug the cameras and plug them in"
        ) from None


def device_info(device: Any, name: str) -> str:
    """A text that the device knows of itself (librealsense, `rs2_camera_info`), "" if it does not."""
    wanted = getattr(sdk().camera_info, name, None)
    return device.get_info(wanted) if wanted is not None and device.supports(wanted) else ""


def all_info(device: Any) -> dict[str, str]:
    """All such texts."""
    return {name: text for name in sdk().camera_info.__members__ if (text := device_info(device, name))}


def device_title(device: Any) -> str:
    """The camera for people: name and serial number."""
    return f"{device_info(device, 'name') or 'RealSense'} {device_info(device, 'serial_number')}".rstrip()


def pick_device(devices: Sequence[Any], serial: str | None, model: str | None) -> Any:
    """The one that is meant; NotConnectedError or CameraError that lists what is there."""
    there = ", ".join(map(device_title, devices)) or "none"
    if serial is not None:
        found = [device for device in devices if device_info(device, "serial_number") == serial]
        if not found:
            raise NotConnectedError(f"RealSense {serial}: not connected, but {there}; plug it in, or name another")
    else:
        found = list(devices)
        if not found:
            raise NotConnectedError("RealSense: no camera is connected; plug one into a USB 3 port")
        if len(found) > 1:
            raise CameraError(f"RealSense: {len(found)} cameras are connected, {there}; name one by its serial number")
    if model is not None and model.upper() not in device_info(found[0], "name").upper().split():
        raise CameraError(f"{device_title(found[0])}: not a {model.upper()}; name another serial number or model")
    return found[0]


def temperatures(sensor: Any) -> dict[str, float]:
    """What the sensor's thermometers say [deg C]; empty while it does not stream."""
    found = {}
    for option, name in TEMPERATURES.items():
        wanted = getattr(sdk().option, option)
        if sensor.supports(wanted):
            try:
                found[name] = float(sensor.get_option(wanted))
            except RuntimeError:  # not streaming
                continue
    return found
