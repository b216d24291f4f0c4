"""An opened RealSense camera as a source of frames, through librealsense: depth, and the infrared pair if asked for.

The sensor is opened itself and not through a pipeline: the streams come from one exposure, so that there is nothing to
align, and librealsense's software device is then served by the same code.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from typing import Any

import numpy as np

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.burst import DEPTH_STREAM, MOST_HELD, CameraFrame, StreamLostError
from franbv.adapters.realsense.decimation import settle_decimation
from franbv.adapters.realsense.devices import (
    LIST_THEM,
    NotConnectedError,
    all_info,
    connected_devices,
    device_info,
    device_title,
    pick_device,
    temperatures,
)
from franbv.adapters.realsense.options import all_options, disparity_shift, set_light, set_preset
from franbv.adapters.realsense.profiles import depth_sensor, stream_intrinsics, wanted_profiles
from franbv.adapters.realsense.sdk import sdk, sdk_text
from franbv.adapters.realsense.settings import RealSenseSettings
from franbv.frames import block_centre_intrinsics, centre_corner, stereo_min_z

_SLICE_MS = 200
"""After which a silent camera is looked for on the bus [ms] (choice: several frames at any rate)."""
_METADATA = {"actual_exposure": "exposure_us", "gain_level": "gain", "frame_laser_power": "laser_power_mw"}
"""What a frame says of itself, by librealsense's names and ours."""


def open_source(
    settings: RealSenseSettings, find: Callable[[], Sequence[Any]] = connected_devices
) -> "RealSenseSource":
    """Find the camera that is meant, set it up and let it stream. find: the devices that are plugged in."""
    try:
        device = pick_device(find(), settings.serial, settings.model)
    except RuntimeError as error:
        if isinstance(error, CameraError):
            raise
        raise NotConnectedError(f"RealSense: a camera does not answer ({sdk_text(error)}); plug it in anew") from None
    return RealSenseSource(device, settings, find)


class RealSenseSource:
    """A `FrameSource` of one librealsense device.

    Depth goes through librealsense's decimation filter, its padding is cut off and the middle kept; intrinsics look
    along the middle of the blocks. Min-Z is that of the stream before decimation (`stereo_min_z`). No other
    filter of librealsense is used: they smooth over or fill the holes that the planner looks for.
    """

    def __init__(self, device: Any, settings: RealSenseSettings, find: Callable[[], Sequence[Any]]) -> None:
        """Set the camera up in the order that it needs, and start it; it is stopped again if anything fails."""
        self._device, self._settings, self._find = device, settings, find
        self._where, self.serial = device_title(device), device_info(device, "serial_number")
        self._sensor: Any = None
        try:
            with self._asking("cannot be opened"):
                self._open()
        except BaseException:
            self.close()
            raise

    def _open(self) -> None:
        settings, rs = self._settings, sdk()
        sensor = depth_sensor(self._device, self._where)
        settle_decimation(sensor, settings, self._where)
        profiles = wanted_profiles(sensor, settings, self._where, device_info(self._device, "usb_type_descriptor"))
        self.streams = tuple(profiles)
        self._streams = {(p.stream_type(), p.stream_index()): stream for stream, p in profiles.items()}
        self.full = stream_intrinsics(profiles[DEPTH_STREAM], self._where)
        reduced = block_centre_intrinsics(self.full, settings.decimation) if settings.decimation > 1 else self.full
        width, height = self._crop = settings.crop or (reduced.width, reduced.height)
        if width > reduced.width or height > reduced.height:
            raise CameraError(
                f"{self._where}: crop {width}x{height}: larger than the decimated image, "
                f"{reduced.width}x{reduced.height}; choose a smaller one"
            )
        self._corner = centre_corner((reduced.width, reduced.height), self._crop)
        self.intrinsics = reduced.cropped(*self._corner, *self._crop)
        self._on_host = settings.decimation if settings.decimate_in == "host" else 1
        self._filter = rs.decimation_filter(self._on_host) if self._on_host > 1 else None
        set_preset(self._device, sensor, settings.preset, self._where)
        self._queue = rs.frame_queue(MOST_HELD * len(profiles))
        sensor.open(list(profiles.values()))
        self._sensor = sensor
        set_light(sensor, settings, self._where)
        self.depth_unit = float(sensor.as_depth_sensor().get_depth_scale())
        self.baseline = self._baseline()
        self.disparity_shift = disparity_shift(self._device)
        self.min_z = stereo_min_z(self.full.fx * self.baseline, self.disparity_shift)
        self.period_s = 1.0 / settings.fps
        sensor.start(self._queue)

    def _baseline(self) -> float:
        """[m]; librealsense has millimetres."""
        option = sdk().option.stereo_baseline
        if not self._sensor.supports(option):
            raise CameraError(
                f"{self._where}: does not tell its baseline, so that Min-Z is not known; use a D400 camera"
            )
        return float(self._sensor.get_option(option)) * 1e-3

    def drain(self) -> int:
        """Throw away what lies in the queue; see `FrameSource.drain`."""
        count = 0
        while self._queue.poll_for_frame():
            count += 1
        return count

    def wait(self, timeout_s: float) -> CameraFrame | None:
        """The next frame; see `FrameSource.wait`. While none comes the bus is searched for the camera."""
        left_ms = int(np.ceil(timeout_s * 1e3))
        while left_ms > 0:
            with self._asking("stopped sending", StreamLostError):
                there, frame = self._queue.try_wait_for_frame(min(_SLICE_MS, left_ms))
                if there:
                    return self._frame(frame)
            left_ms -= _SLICE_MS
            with self._asking("cannot be found on the bus", StreamLostError):
                if self.serial not in [device_info(device, "serial_number") for device in self._find()]:
                    raise StreamLostError(f"{self._where}: unplugged")
        return None

    def _frame(self, frame: Any) -> CameraFrame:
        profile, clock = frame.get_profile(), frame.get_frame_timestamp_domain().name
        stream = self._streams[profile.stream_type(), profile.stream_index()]
        return CameraFrame(stream, frame.get_frame_number(), frame.get_timestamp(), clock, frame)

    def pixels(self, frame: CameraFrame) -> np.ndarray:
        """A copy of the image; see `FrameSource.pixels`."""
        with self._asking("frame lost", StreamLostError):
            if frame.stream != DEPTH_STREAM:
                return np.array(frame.raw.get_data())
            image = np.asanyarray(frame.raw.get_data())
            own = self._settings.decimation // self._on_host
            due = self.full.height // own, self.full.width // own
            if image.shape != due:
                raise CameraError(
                    f"{self._where}: frames of {image.shape[1]}x{image.shape[0]} instead of {due[1]}x{due[0]}: it "
                    "decimates where it should not, or not where it should; set decimate_in and decimation accordingly"
                )
            if self._filter is not None:
                image = np.asanyarray(self._filter.process(frame.raw).get_data())
            (left, top), (width, height) = self._corner, self._crop
            return image[top : top + height, left : left + width].copy()

    def record(self) -> dict[str, Any]:
        """Everything that a recording should hold; see `FrameSource.record`."""
        with self._asking("does not answer", StreamLostError):
            return {
                "camera": all_info(self._device),
                "sdk": f"librealsense {getattr(sdk(), '__version__', 'of unknown version')}",
                "settings": self._settings.model_dump(mode="json"),
                "options": all_options(self._sensor),
                "depth_unit_m": self.depth_unit,
                "baseline_m": self.baseline,
                "disparity_shift_px": self.disparity_shift,
                "min_z_m": self.min_z,
                "stream_intrinsics": asdict(self.full),
                "intrinsics": asdict(self.intrinsics),
                "decimation": {"factor": self._settings.decimation, "runs_in": self._decimator()},
                "temperatures": self.readings(),
            }

    def _decimator(self) -> str:
        return "nowhere" if self._settings.decimation == 1 else self._settings.decimate_in

    def readings(self, frame: CameraFrame | None = None) -> dict[str, float]:
        """Temperatures and what the frame says of itself; see `FrameSource.readings`."""
        with self._asking("does not answer", StreamLostError):
            found = temperatures(self._sensor)
            for name, ours in _METADATA.items():
                value = getattr(sdk().frame_metadata_value, name)
                if frame is not None and frame.raw.supports_frame_metadata(value):
                    found[ours] = float(frame.raw.get_frame_metadata(value))
        return found

    @contextmanager
    def unlit(self) -> Iterator[None]:
        """The dot projector is off as long as this lasts; see `FrameSource.unlit`."""
        option = sdk().option.emitter_enabled
        with self._asking("does not switch its projector", StreamLostError):
            was = self._sensor.get_option(option)
            self._sensor.set_option(option, 0.0)
        try:
            yield
        finally:
            with self._asking("does not switch its projector", StreamLostError):
                self._sensor.set_option(option, was)

    def close(self) -> None:
        """Stop the stream, whatever state the camera is in."""
        sensor, self._sensor = self._sensor, None
        if sensor is None:
            return
        for step in (sensor.stop, sensor.close):
            with suppress(RuntimeError):  # not streaming, or no longer there
                step()

    @contextmanager
    def _asking(self, what: str, kind: type[CameraError] = NotConnectedError) -> Iterator[None]:
        """The SDK's exceptions as ours. NotConnectedError: a camera that was just plugged in refuses for a moment."""
        try:
            yield
        except RuntimeError as error:
            if isinstance(error, CameraError):
                raise
            raise kind(
                f"{self._where}: {what} ({sdk_text(error)}); close other programs that use it, try another cable or "
                f"port; {LIST_THEM}"
            ) from None
