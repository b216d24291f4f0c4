"""librealsense's software device as a stereo camera: frames of ours become frames of librealsense, for its filters."""

from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from franbv.frames import Intrinsics

BASELINE = 50.0
"""[mm]"""
UNIT = 1e-3
"""Of depth [m]."""
WAIT_MS = 5000
"""For a frame that is already there."""


class SoftwareCamera:
    """Depth and two kinds of infrared, all of one size."""

    def __init__(self, sdk: ModuleType, intrinsics: Intrinsics) -> None:
        """Streams at once."""
        self.sdk = sdk
        self._size = intrinsics.width, intrinsics.height
        self._device = sdk.software_device()
        self._sensor = self._device.add_sensor("Stereo Module")
        self._sensor.add_read_only_option(sdk.option.depth_units, UNIT)
        self._sensor.add_read_only_option(sdk.option.stereo_baseline, BASELINE)
        self._depth = self._stream(intrinsics, sdk.stream.depth, sdk.format.z16, 0)
        self._infrared = {
            np.dtype(np.uint8): self._stream(intrinsics, sdk.stream.infrared, sdk.format.y8, 1),
            np.dtype(np.uint16): self._stream(intrinsics, sdk.stream.infrared, sdk.format.y16, 2),
        }
        self._queue = sdk.frame_queue(1)
        self._sensor.open([self._depth, *self._infrared.values()])
        self._sensor.start(self._queue)

    def close(self) -> None:
        """Stop streaming."""
        self._sensor.stop()
        self._sensor.close()

    def depth(self, z16: np.ndarray, number: int = 0, sequence_id: int = 0) -> Any:
        """A frame of the depth stream."""
        return self._frame(z16, self._depth, number, sequence_id)

    def infrared(self, grey: np.ndarray, number: int = 0, sequence_id: int = 0) -> Any:
        """A frame of an infrared stream: Y8 of bytes, Y16 of words."""
        return self._frame(grey, self._infrared[grey.dtype], number, sequence_id)

    def together(self, frames: list[Any]) -> Any:
        """One set of several frames."""
        block = self.sdk.processing_block(lambda _, source: source.frame_ready(source.allocate_composite_frame(frames)))
        queue = self.sdk.frame_queue(1)
        block.start(queue)
        block.invoke(frames[0])
        return queue.wait_for_frame(WAIT_MS).as_frameset()

    def _stream(self, intrinsics: Intrinsics, kind: Any, coding: Any, index: int) -> Any:
        calibration = self.sdk.intrinsics()
        calibration.width, calibration.height = self._size
        calibration.fx, calibration.fy = intrinsics.fx, intrinsics.fy
        calibration.ppx, calibration.ppy = intrinsics.cx, intrinsics.cy
        stream = self.sdk.video_stream()
        stream.type, stream.fmt, stream.index, stream.uid, stream.fps = kind, coding, index, index, 30
        stream.bpp = 1 if coding == self.sdk.format.y8 else 2
        (stream.width, stream.height), stream.intrinsics = self._size, calibration
        return self._sensor.add_video_stream(stream).as_video_stream_profile()

    def _frame(self, image: np.ndarray, profile: Any, number: int, sequence_id: int) -> Any:
        value = self.sdk.frame_metadata_value
        for key, is_so in ((value.frame_counter, number), (value.sequence_id, sequence_id), (value.sequence_size, 2)):
            self._sensor.set_metadata(key, is_so)
        frame = self.sdk.software_video_frame()
        frame.pixels, frame.profile = np.ascontiguousarray(image), profile
        frame.bpp, frame.stride, frame.frame_number = image.itemsize, image.itemsize * image.shape[1], number
        if profile is self._depth:
            frame.depth_units = UNIT
        self._sensor.on_video_frame(frame)
        return self._queue.wait_for_frame(WAIT_MS)


@contextmanager
def software_camera(intrinsics: Intrinsics) -> Iterator[SoftwareCamera]:
    """The camera while it streams; the test is skipped where pyrealsense2, or libusb-1.0 below it, is missing."""
    sdk = pytest.importorskip("pyrealsense2", exc_type=ImportError)
    camera = SoftwareCamera(sdk, intrinsics)
    try:
        yield camera
    finally:
        camera.close()
