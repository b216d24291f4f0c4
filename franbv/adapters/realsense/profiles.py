"""The streams that are wanted of a camera, and their calibration."""

from typing import Any

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.burst import DEPTH_STREAM, LEFT_INFRARED, RIGHT_INFRARED
from franbv.adapters.realsense.sdk import sdk
from franbv.adapters.realsense.settings import RealSenseSettings
from franbv.frames import Intrinsics

BROWN = ("brown_conrady", "modified_brown_conrady", "inverse_brown_conrady")
"""librealsense's models that are pinholes where all coefficients are zero, as D400 depth streams have them."""


def depth_sensor(device: Any, where: str) -> Any:
    """The device's first sensor that knows depth; CameraError if it has none."""
    for sensor in device.query_sensors():
        if sensor.is_depth_sensor():
            return sensor
    raise CameraError(f"{where}: has no depth sensor; use a depth camera of the D400 family")


def wanted_profiles(sensor: Any, settings: RealSenseSettings, where: str, usb: str) -> dict[str, Any]:
    """librealsense's profile of each stream, depth first; CameraError that lists what there is. usb: type of the port,
    which the list depends on."""
    rs = sdk()
    kinds = {DEPTH_STREAM: (rs.stream.depth, 0, rs.format.z16)}
    if settings.infrared:
        kinds |= {
            LEFT_INFRARED: (rs.stream.infrared, 1, rs.format.y8),
            RIGHT_INFRARED: (rs.stream.infrared, 2, rs.format.y8),
        }
    offered = [profile.as_video_stream_profile() for profile in sensor.get_stream_profiles()]
    return {stream: _one_of(offered, stream, kind, settings, where, usb) for stream, kind in kinds.items()}


def _one_of(
    offered: list[Any], stream: str, kind: tuple[Any, int, Any], settings: RealSenseSettings, where: str, usb: str
) -> Any:
    there = [p for p in offered if p and (p.stream_type(), p.stream_index(), p.format()) == kind]
    wanted = (*settings.profile, settings.fps)
    for profile in there:
        if (profile.width(), profile.height(), profile.fps()) == wanted:
            return profile
    rates: dict[str, set[int]] = {}
    for profile in there:
        rates.setdefault(f"{profile.width()}x{profile.height()}", set()).add(profile.fps())
    listed = ", ".join(f"{size} at {'/'.join(map(str, sorted(fps)))}" for size, fps in rates.items()) or "none"
    raise CameraError(
        f"{where}: no {stream} stream {wanted[0]}x{wanted[1]} at {wanted[2]} fps"
        f"{f' on USB {usb}' if usb else ''}; use one of {listed}"
    )


def stream_intrinsics(profile: Any, where: str) -> Intrinsics:
    """Calibration of a rectified stream; CameraError if it is distorted: the planner has a pinhole."""
    found = profile.get_intrinsics()
    model = found.model.name
    if model != "none" and (model not in BROWN or any(found.coeffs)):
        raise CameraError(
            f"{where}: depth with {model} distortion ({', '.join(f'{c:.4g}' for c in found.coeffs)}): only rectified "
            "streams (none, or Brown-Conrady with zeros) are taken; use a D400 depth stream"
        )
    return Intrinsics(found.width, found.height, found.fx, found.fy, found.ppx, found.ppy)
