"""librealsense's software device, dressed as a D435i, that shows what a script says; no camera is needed for it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from franbv.adapters.realsense.burst import DEPTH_STREAM, LEFT_INFRARED, RIGHT_INFRARED, CameraFrame
from franbv.adapters.realsense.camera import RealSenseCamera
from franbv.adapters.realsense.devices import pick_device
from franbv.adapters.realsense.sdk import sdk
from franbv.adapters.realsense.settings import RealSenseSettings
from franbv.adapters.realsense.source import RealSenseSource

PERIOD_MS = 1000 / 30
OPTIONS = {
    "laser_power": (0, 360, 150, 30),
    "visual_preset": (0, 6, 1, 1),
    "emitter_enabled": (0, 2, 1, 1),
    "enable_auto_exposure": (0, 1, 1, 1),
    "exposure": (1, 165000, 8500, 1),
    "gain": (16, 248, 16, 1),
}
"""Least, most, default and step, as a D435i has them."""
QUICK = {"warm_up_frames": 0, "settle_frames": 0, "settle_s": 0.0, "frame_timeout_s": 0.3, "reconnect_s": 0.6}
"""Settings under which a script's frames are the burst."""


class Still(NamedTuple):
    """A frame to be sent."""

    image: np.ndarray
    number: int
    timestamp_ms: float
    clock: str = "hardware_clock"
    stream: str = DEPTH_STREAM


@dataclass(eq=False)
class SoftwareCamera:
    """A device with a depth sensor; every field as a D435i at 640x360 has it."""

    serial: str = "1"
    name: str = "Intel RealSense D435I"
    size: tuple[int, int] = (640, 360)
    focal_px: float = 321.0
    fps: int = 30
    distortion: str = "brown_conrady"
    coefficients: tuple[float, ...] = (0.0,) * 5
    unit: float = 0.001
    baseline_mm: float | None = 50.0
    infrared: bool = False
    sends: tuple[int, int] | None = None
    """Width and height of what comes, whatever was opened."""
    info: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        rs = sdk()
        self.device = rs.software_device()
        told = {"serial_number": self.serial, "name": self.name, "firmware_version": "5.17.0.10"}
        for key, text in (told | {"usb_type_descriptor": "3.2"} | self.info).items():
            self.device.register_info(getattr(rs.camera_info, key), text)
        self.sensor = self.device.add_sensor("Stereo Module")
        self.sensor.add_read_only_option(rs.option.depth_units, self.unit)
        self.sensor.add_read_only_option(rs.option.asic_temperature, 41.0)
        if self.baseline_mm is not None:
            self.sensor.add_read_only_option(rs.option.stereo_baseline, self.baseline_mm)
        for name, numbers in OPTIONS.items():
            span = rs.option_range()
            span.min, span.max, span.default, span.step = numbers
            self.sensor.add_option(getattr(rs.option, name), span, True)
        kinds = {DEPTH_STREAM: (rs.stream.depth, 0, rs.format.z16, 2)}
        if self.infrared:
            kinds |= {
                LEFT_INFRARED: (rs.stream.infrared, 1, rs.format.y8, 1),
                RIGHT_INFRARED: (rs.stream.infrared, 2, rs.format.y8, 1),
            }
        self.profiles = {stream: self._add(i, *kind) for i, (stream, kind) in enumerate(kinds.items())}
        if self.sends is not None:
            self.size = self.sends
            self.profiles[DEPTH_STREAM] = self._add(len(kinds), *kinds[DEPTH_STREAM])

    def _add(self, uid: int, kind: Any, index: int, form: Any, bpp: int) -> Any:
        rs = sdk()
        calibration = rs.intrinsics()
        calibration.width, calibration.height = self.size
        calibration.fx = calibration.fy = self.focal_px
        calibration.ppx, calibration.ppy = (self.size[0] - 1) / 2, (self.size[1] - 1) / 2
        calibration.model = getattr(rs.distortion, self.distortion)
        calibration.coeffs = list(self.coefficients)
        stream = rs.video_stream()
        stream.type, stream.index, stream.fmt, stream.bpp, stream.uid = kind, index, form, bpp, uid
        stream.fps, (stream.width, stream.height), stream.intrinsics = self.fps, self.size, calibration
        return self.sensor.add_video_stream(stream).as_video_stream_profile()

    def send(self, still: Still) -> None:
        """Into the queue of whoever has opened it."""
        frame = sdk().software_video_frame()
        image = np.ascontiguousarray(still.image)
        frame.pixels, frame.bpp, frame.stride = image, image.itemsize, image.itemsize * image.shape[1]
        frame.profile, frame.frame_number = self.profiles[still.stream], still.number
        frame.timestamp, frame.domain = still.timestamp_ms, getattr(sdk().timestamp_domain, still.clock)
        self.sensor.on_video_frame(frame)

    def option(self, name: str) -> float:
        """What the device has it set to."""
        return self.sensor.get_option(getattr(sdk().option, name))

    @property
    def streams(self) -> bool:
        """Whether anyone has opened it."""
        return len(self.sensor.get_active_streams()) > 0


class ScriptedSource(RealSenseSource):
    """The adapter's own source; whenever it waits for a frame, the next of the script is sent. None = silence."""

    def __init__(self, bench: "Bench", camera: SoftwareCamera, settings: RealSenseSettings) -> None:
        self.bench, self.camera = bench, camera
        super().__init__(camera.device, settings, bench.find)

    def wait(self, timeout_s: float) -> CameraFrame | None:
        """As the adapter waits."""
        still = next(self.bench.script, None)
        if still is not None:
            self.camera.send(still)
        return super().wait(timeout_s)


@dataclass(eq=False)
class Bench:
    """What is plugged in, and what the cameras are to show."""

    cameras: list[SoftwareCamera]
    script: Iterator[Still | None] = field(default_factory=lambda: iter(()))
    opened: int = 0

    def find(self) -> list[Any]:
        """The devices on the bus."""
        return [camera.device for camera in self.cameras]

    def open(self, settings: RealSenseSettings) -> ScriptedSource:
        """As `open_source` does."""
        device = pick_device(self.find(), settings.serial, settings.model)
        source = ScriptedSource(self, next(one for one in self.cameras if one.device is device), settings)
        self.opened += 1
        return source

    def camera(self, **changes: Any) -> RealSenseCamera:
        """The adapter in front of it, quick but for the changes."""
        return RealSenseCamera(RealSenseSettings(**QUICK | changes), self.open)


def stills(
    image_of: Callable[[int], np.ndarray], first: int = 1, count: int = 10**9, start_ms: float = 0.0
) -> Iterator[Still]:
    """Frames of a camera that runs: image_of gives the picture of a frame number."""
    return (Still(image_of(k), k, start_ms + k * PERIOD_MS) for k in range(first, first + count))


def flat(value: int, size: tuple[int, int] = (640, 360)) -> np.ndarray:
    """Depth that says which frame it is [mm]."""
    return np.full((size[1], size[0]), value, np.uint16)
