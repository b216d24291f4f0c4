"""A camera for the live commands that needs nothing plugged in: the analytic one of the recorded run."""

import time
from collections.abc import Mapping
from typing import Any

from franbv.adapters.live.opened_camera import OpenedCamera
from tests.franbv.adapters.recording.recorded_run import CAMERA, InSteps, camera


class Slowly(InSteps):
    """Takes as long as frames take."""

    def capture(self, T_world_cam, n_frames):
        time.sleep(0.05)
        return super().capture(T_world_cam, n_frames)


def open_analytic(settings: Mapping[str, Any]) -> OpenedCamera:
    """Settings: `first`, the number of the burst that comes first."""
    made = camera(Slowly)
    made.captures = settings.get("first", 0)
    return OpenedCamera(made, CAMERA, dict(settings), drain=lambda: 1)
