"""A RealSense camera as the planner's `DepthCamera`: bursts of frames that all come from one standing camera."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np
from jaxtyping import UInt8
from scipy.spatial.transform import RigidTransform

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.burst import (
    DEPTH_STREAM,
    LEFT_INFRARED,
    RIGHT_INFRARED,
    FrameSource,
    StreamLostError,
    Taken,
    take_burst,
)
from franbv.adapters.realsense.devices import NotConnectedError
from franbv.adapters.realsense.settings import RealSenseSettings
from franbv.adapters.realsense.source import open_source
from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst

_LOOK_EVERY_S = 0.25
"""Between two looks for a camera that was lost [s] (choice: a camera takes seconds to start)."""


@dataclass(frozen=True, eq=False)
class Shot:
    """A burst and how it came about."""

    burst: DepthBurst
    """What the planner gets: decimated and cropped."""
    taken: Taken
    """Frame numbers, timestamps, what was dropped, and the same depth in the camera's units."""
    restarts: int
    """How often the stream was lost and the burst begun anew."""

    @property
    def lefts(self) -> UInt8[np.ndarray, "n h w"] | None:
        """Left infrared images at full resolution [DN]; None without `RealSenseSettings.infrared`."""
        return self.taken.images.get(LEFT_INFRARED)

    @property
    def rights(self) -> UInt8[np.ndarray, "n h w"] | None:
        """Right infrared images at full resolution [DN]; None without `RealSenseSettings.infrared`."""
        return self.taken.images.get(RIGHT_INFRARED)


class RealSenseCamera:
    """A camera of the D400 family in front of the real thing, streaming until it is closed.

    Poses are given by the caller, who knows arm and hand-eye transform. A burst holds only frames that came after the
    call, in order, each once; if the camera is lost, it is waited for, set up again and the burst begun from nothing.
    Left out: the colour imager, the inertial unit, librealsense's filters but decimation, cameras in step by cable.

        with RealSenseCamera(RealSenseSettings(laser_power_mw=150)) as camera:
            burst = camera.capture(T_world_cam, n_frames=15)
    """

    def __init__(
        self,
        settings: RealSenseSettings | None = None,
        open_camera: Callable[[RealSenseSettings], FrameSource] = open_source,
    ) -> None:
        """Open the camera; CameraError if that cannot be. open_camera: makes the stream, anew after a loss."""
        self.settings = settings or RealSenseSettings()
        self._open_camera = open_camera
        self._source: FrameSource | None = open_camera(self.settings)
        # Whoever named none means this one from now on, whatever else is plugged in.
        self.settings = self.settings.model_copy(update={"serial": self._source.serial or None})
        self._intrinsics, self._min_z = self._source.intrinsics, self._source.min_z
        self._is_warm = False
        self.last_shot: Shot | None = None
        """What was taken last, with its infrared images."""

    @property
    def intrinsics(self) -> Intrinsics:
        """Of the decimated and cropped depth, along the middle of each block."""
        return self._intrinsics

    @property
    def min_z(self) -> float:
        """Smallest measurable Z-depth [m]."""
        return self._min_z

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """Depth frames as the planner gets them; the camera stands at this pose, and has stopped."""
        self.last_shot = self.shoot(T_world_cam, n_frames)
        return self.last_shot.burst

    def unlit_view(self) -> tuple[UInt8[np.ndarray, "h w"], Intrinsics]:
        """A left infrared image without dots [DN], at full resolution, and its intrinsics: to find a board in.

        CameraError without `RealSenseSettings.infrared`, or when the camera does not deliver.
        """
        source, s = self._opened(), self.settings
        if not s.infrared:
            raise CameraError(f"RealSense {s.serial or ''}: sends no infrared images; set infrared")
        with source.unlit():
            taken = take_burst(source, 1, max(s.settle_frames, 1), s.settle_s, s.frame_timeout_s)
        return taken.images[LEFT_INFRARED][0], source.full

    def drain(self) -> int:
        """Throw away frames that nobody asked for; how many came since the last call."""
        return self._opened().drain()

    def shoot(self, T_world_cam: RigidTransform, n_frames: int) -> Shot:
        """The same with all that is known about it. CameraError in one line when the camera does not deliver."""
        if n_frames < 1:
            raise CameraError(f"a burst of {n_frames} frames; ask for 1 at least")
        try:
            return self._shot(T_world_cam, n_frames, restarts=0)
        except StreamLostError as lost:
            self._reopen(lost)
        try:
            return self._shot(T_world_cam, n_frames, restarts=1)
        except StreamLostError as lost:
            raise CameraError(f"RealSense {self.settings.serial}: lost twice in one burst: {lost}; {_CHECK}") from None

    def _shot(self, T_world_cam: RigidTransform, n_frames: int, restarts: int) -> Shot:
        source, s = self._opened(), self.settings
        skip = s.settle_frames if self._is_warm else max(s.warm_up_frames, s.settle_frames)
        taken = take_burst(source, n_frames, skip, s.settle_s, s.frame_timeout_s)
        self._is_warm = True
        depths = taken.images[DEPTH_STREAM] * np.float32(source.depth_unit)
        return Shot(DepthBurst(depths, self._intrinsics, T_world_cam), taken, restarts)

    def _reopen(self, lost: StreamLostError) -> None:
        """Wait for the same camera and set it up again; CameraError if it does not come back, or comes back changed."""
        self.close()
        until, last = time.monotonic() + self.settings.reconnect_s, str(lost)
        while time.monotonic() < until:
            try:
                self._source = self._open_camera(self.settings)
                break
            except NotConnectedError as still:
                last = str(still)
                time.sleep(_LOOK_EVERY_S)
        else:
            raise CameraError(f"{lost}, and not back within {self.settings.reconnect_s:g} s ({last}); {_CHECK}")
        self._is_warm = False
        if (self._source.intrinsics, self._source.min_z) != (self._intrinsics, self._min_z):
            self.close()
            raise CameraError(f"RealSense {self.settings.serial}: calibrated anew while it was away; begin a new run")

    def record(self) -> dict[str, Any]:
        """Camera, firmware, SDK, settings, every option's value, calibration and temperatures, for a recording."""
        return self._opened().record()

    def _opened(self) -> FrameSource:
        if self._source is None:
            raise CameraError(f"RealSense {self.settings.serial or ''}: closed; open a new RealSenseCamera")
        return self._source

    def close(self) -> None:
        """Stop the stream; may be called twice."""
        source, self._source = self._source, None
        if source is not None:
            source.close()

    def __enter__(self) -> "RealSenseCamera":
        """The camera itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop the stream, whatever happened."""
        self.close()


_CHECK = "check cable and port (USB 3, screwed tight), then start again"
