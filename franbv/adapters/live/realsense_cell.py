"""A RealSense camera as the live commands need it."""

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from franbv.adapters.camera_error import CameraError
from franbv.adapters.first_fault import first_fault
from franbv.adapters.live.opened_camera import OpenedCamera
from franbv.adapters.realsense.camera import RealSenseCamera
from franbv.adapters.realsense.settings import RealSenseSettings
from franbv.adapters.recording.contents import CameraFacts

WALL_CLOCKS = ("global_time", "system_time")
"""librealsense's names for timestamps since 1970."""


def open_realsense(settings: Mapping[str, Any]) -> OpenedCamera:
    """Open the camera; CameraError where it cannot be, or the settings are none of its."""
    try:
        checked = RealSenseSettings.model_validate({"infrared": True, **settings})
    except ValidationError as error:
        raise CameraError(f"camera settings: {first_fault(error, 'settings')}") from None
    return opened_realsense(RealSenseCamera(checked))


def opened_realsense(camera: RealSenseCamera) -> OpenedCamera:
    """What is around a camera that is open."""
    said = camera.record()
    info = said["camera"]
    facts = CameraFacts(
        camera.intrinsics,
        camera.min_z,
        said["depth_unit_m"],
        info.get("name"),
        info.get("serial_number"),
        info.get("firmware_version"),
    )

    def infrared() -> Any:
        shot = camera.last_shot
        return None if shot is None or shot.lefts is None else shot.lefts[0]

    def times_ns() -> Any:
        shot = camera.last_shot
        if shot is None or shot.taken.clock not in WALL_CLOCKS:
            return None
        return tuple(int(ms * 1e6) for ms in shot.taken.timestamps_ms)

    return OpenedCamera(camera, facts, said, camera.drain, infrared, times_ns, camera.unlit_view, camera.close)
