"""Cameras by the name that a command line gives: a RealSense, or anybody's own."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from franbv.adapters.camera_error import CameraError
from franbv.adapters.named_function import named_function
from franbv.adapters.recording.contents import CameraFacts

OWN_CAMERAS: Mapping[str, str] = {"realsense": "franbv.adapters.live.realsense_cell:open_realsense"}
"""Where each of ours is opened."""


@dataclass(frozen=True, eq=False)
class OpenedCamera:
    """A camera as the live commands need it: a `DepthCamera`, and what is around it."""

    camera: Any
    """The `DepthCamera`."""
    facts: CameraFacts
    settings: Mapping[str, Any]
    """For the recording."""
    drain: Callable[[], int]
    """As of `Pulse`."""
    infrared: Callable[[], Any] = lambda: None
    """Left infrared image of the burst that was taken last [DN], None where there is none."""
    times_ns: Callable[[], Any] = lambda: None
    """When the frames of that burst were taken, since 1970 [ns]; None where the camera does not tell."""
    look: Callable[[], Any] | None = None
    """Takes an infrared image without dots, and its intrinsics; for an arm that is a person."""
    close: Callable[[], None] = lambda: None


def open_camera(kind: str, settings: Mapping[str, Any]) -> OpenedCamera:
    """Open a camera. kind: a name in OWN_CAMERAS, or `package.module:function`, called with the settings.

    CameraError where there is no such camera.
    """
    return named_function("camera", kind, OWN_CAMERAS, ", ".join(OWN_CAMERAS), CameraError)(settings)
