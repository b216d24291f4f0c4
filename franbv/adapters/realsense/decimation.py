"""Who decimates: librealsense's filter on this computer or the camera's own, and never both.

Cameras of the D400 family have no decimation of their own. D500 cameras do (librealsense 2.58 and later): over Ethernet
as a filter of two options, over USB as one composite option. It halves both sides and nothing else, and how it treats
zeros is not documented.
"""

from typing import Any

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.sdk import sdk
from franbv.adapters.realsense.settings import RealSenseSettings


def settle_decimation(sensor: Any, settings: RealSenseSettings, where: str) -> None:
    """Switch the camera's own decimation on or off, and ask it whether it is; CameraError if the answer is not what was
    asked for. Before the stream is opened: it changes the size of the frames."""
    own, wanted = own_decimation(sensor), settings.decimate_in == "camera"
    if own is None:
        if wanted:
            raise CameraError(f"{where}: has no decimation of its own, as no D400 has; set decimate_in host")
        return
    if _state(own)[0] != wanted:
        _switch(own, wanted)
    runs, factor = _state(own)
    if runs != wanted:
        raise CameraError(
            f"{where}: its own decimation stays {'on' if runs else 'off'}; unplug it and plug it in, "
            f"or set decimate_in {'camera' if runs else 'host'}"
        )
    if runs and factor != settings.decimation:
        raise CameraError(
            f"{where}: its own decimation is by {factor} and not by {settings.decimation}; "
            f"set decimation {factor}, or decimate_in host"
        )


def own_decimation(sensor: Any) -> Any | None:
    """The camera's own decimation filter; None if it has none, or librealsense is too old to know of any."""
    if not hasattr(sensor, "query_embedded_filters"):
        return None
    kind = sdk().embedded_filter_type.decimation
    return next((one for one in sensor.query_embedded_filters() if one.get_type() == kind), None)


def _state(own: Any) -> tuple[bool, int]:
    """Whether it runs, and its factor."""
    option = sdk().option
    if own.supports(option.embedded_filter_enabled):
        return bool(own.get_option(option.embedded_filter_enabled)), int(own.get_option(option.filter_magnitude))
    config = own.get_decimation_filter_dpp_config(sdk().composite_option_id.decimation_filter_dpp)
    return bool(config.enabled), int(config.magnitude)


def _switch(own: Any, on: bool) -> None:
    option = sdk().option
    if own.supports(option.embedded_filter_enabled):
        own.set_option(option.embedded_filter_enabled, float(on))
        return
    composite = sdk().composite_option_id.decimation_filter_dpp
    config = own.get_decimation_filter_dpp_config(composite)  # the rest of it stays as it is
    config.enabled = int(on)
    own.set_decimation_filter_dpp_config(composite, config)
