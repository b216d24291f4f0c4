"""A burst out of a stream of frames: newer than the call, distinct, in order, matched, from one unbroken stream.

Knows no SDK: what makes frames is a `FrameSource`.
"""

import math
import time
from collections import deque
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64, Int64

from franbv.adapters.camera_error import CameraError
from franbv.frames import Intrinsics

DEPTH_STREAM, LEFT_INFRARED, RIGHT_INFRARED = "depth", "left infrared", "right infrared"
"""The streams' names here."""
HOST_CLOCK = "global_time"
"""librealsense's name for timestamps that were brought to this computer's clock [ms since 1970]."""

MOST_HELD = 4
"""Frames of each stream that may wait for something (choice: a hiccup of 0.1 s; the SDK has 16 buffers for each)."""
_MOST_CLOCK_CHANGES = 3
"""Within a burst [-] (choice: one is expected)."""


class StreamLostError(CameraError):
    """The frames stopped: unplugged, reset or hung. What was collected of a burst is void."""


@dataclass(frozen=True, eq=False)
class CameraFrame:
    """One frame of one stream, before anything is done to its pixels."""

    stream: str
    """DEPTH_STREAM, LEFT_INFRARED or RIGHT_INFRARED."""
    number: int
    """The camera's count; a gap is a dropped frame."""
    timestamp_ms: float
    """By `clock` [ms]."""
    clock: str
    """hardware_clock, system_time or global_time (librealsense, `rs2_timestamp_domain`)."""
    raw: Any = None
    """What the source needs to make its pixels."""


@runtime_checkable
class FrameSource(Protocol):
    """An opened camera that streams."""

    streams: tuple[str, ...]
    """That it sends, DEPTH_STREAM first."""
    period_s: float
    """Between frames [s]."""
    intrinsics: Intrinsics
    """Of the reduced depth."""
    min_z: float
    """[m]"""
    full: Intrinsics
    """Of depth and left infrared image at full resolution; they are the same."""
    depth_unit: float
    """Of one step of the depth images [m]."""
    serial: str
    """Serial number."""

    def drain(self) -> int:
        """Throw away what lies in the queue; how many frames that was."""
        ...

    def wait(self, timeout_s: float) -> CameraFrame | None:
        """The next frame; None after that time [s]. StreamLostError if the camera is known to be gone."""
        ...

    def pixels(self, frame: CameraFrame) -> np.ndarray:
        """A copy of its image: 16-bit depth, decimated and cropped, 0 = invalid; 8-bit infrared as it is."""
        ...

    def record(self) -> dict[str, Any]:
        """Everything about camera, SDK and options that a recording should hold, in JSON's types."""
        ...

    def readings(self, frame: CameraFrame | None = None) -> dict[str, float]:
        """Temperatures [deg C], and what the camera says of the frame's exposure [us], gain and laser [mW]."""
        ...

    def unlit(self) -> AbstractContextManager[None]:
        """The dot projector is off as long as this lasts."""
        ...

    def close(self) -> None:
        """Stop the stream; may be called twice, and after the camera is gone."""
        ...


@dataclass(frozen=True, eq=False)
class Taken:
    """The frames of a burst and how they came."""

    images: dict[str, np.ndarray]
    """(n, h, w) of each stream."""
    numbers: Int64[np.ndarray, "n"]
    """Of the depth frames, by the camera's count."""
    timestamps_ms: Float64[np.ndarray, "n"]
    """Of the depth frames by `clock` [ms]."""
    clock: str
    """See `CameraFrame.clock`."""
    dropped: int
    """Depth frames that are missing between the first and the last one."""
    discarded: int
    """Frames that were left out before the burst: older than the call, in flight, or while exposure settled."""
    repeated: int
    """Frames that came twice."""
    unmatched: int
    """Frames without a partner of the same time in the other streams."""
    readings: dict[str, float]
    """Of its last frame; see `FrameSource.readings`."""


def take_burst(source: FrameSource, n_frames: int, skip: int, settle_s: float, timeout_s: float) -> Taken:
    """The next `n_frames` frames that began after this call.

    Left out are frames in the queue, those of the next `settle_s` [s], by arrival and, where the camera's time is this
    computer's, by timestamp, and `skip` more. StreamLostError after `timeout_s` [s] of silence; CameraError if time or
    count run backwards, or if frames come of which none can be used.
    """
    return _Burst(source, skip, settle_s, timeout_s).take(n_frames)


class _Burst:
    def __init__(self, source: FrameSource, skip: int, settle_s: float, timeout_s: float) -> None:
        self.source, self.skip, self.timeout_s = source, skip, timeout_s
        self.discarded, self.repeated, self.unmatched, self.stale = source.drain(), 0, 0, 0
        self.begins, self.begins_ms = time.monotonic() + settle_s, (time.time() + settle_s) * 1e3
        # By count and not by time, which passes on a busy computer as well.
        self.most_useless = math.ceil((timeout_s + settle_s) / source.period_s) * len(source.streams)
        self.useless = 0
        self.waiting: dict[str, deque[CameraFrame]] = {stream: deque() for stream in source.streams}
        self.clock_changes = 0

    def take(self, n_frames: int) -> Taken:
        images: list[dict[str, np.ndarray]] = []
        frames: list[CameraFrame] = []
        for matched in self._matched():
            frame = matched[DEPTH_STREAM]
            if self._is_early(frame):
                self.discarded += 1
                continue
            self.useless = 0
            if self.skip > 0:
                self.skip, self.discarded = self.skip - 1, self.discarded + 1
                continue
            if frames and frame.clock != frames[0].clock:
                self._check_clock(frames[0], frame)
                self.discarded += len(frames)
                images, frames = [], []
            # At once: the SDK has few buffers, and stops delivering when they are held.
            images.append({stream: self.source.pixels(one) for stream, one in matched.items()})
            frames.append(frame)
            if len(frames) == n_frames:
                return self._taken(images, frames)
        raise AssertionError("the stream of frames has no end")

    def _taken(self, images: list[dict[str, np.ndarray]], frames: list[CameraFrame]) -> Taken:
        numbers = np.array([frame.number for frame in frames], np.int64)
        return Taken(
            images={stream: np.stack([image[stream] for image in images]) for stream in self.source.streams},
            numbers=numbers,
            timestamps_ms=np.array([frame.timestamp_ms for frame in frames], np.float64),
            clock=frames[0].clock,
            dropped=int(numbers[-1] - numbers[0]) + 1 - len(numbers),
            discarded=self.discarded,
            repeated=self.repeated,
            unmatched=self.unmatched,
            readings=self.source.readings(frames[-1]),
        )

    def _check_clock(self, before: CameraFrame, frame: CameraFrame) -> None:
        """The first frames after a start may be by another clock; CameraError if it goes on."""
        self.clock_changes += 1
        if self.clock_changes > _MOST_CLOCK_CHANGES:
            raise CameraError(
                f"timestamps go back and forth between {before.clock} and {frame.clock}; update the camera's firmware"
            )

    def _is_early(self, frame: CameraFrame) -> bool:
        """Whether its exposure may have begun before the camera stood still."""
        stale = frame.clock == HOST_CLOCK and frame.timestamp_ms < self.begins_ms
        self.stale += stale
        return stale or time.monotonic() < self.begins

    def _matched(self) -> Iterator[dict[str, CameraFrame]]:
        """Frames of all streams that were exposed together: timestamps within half a period."""
        tolerance_ms = self.source.period_s * 1e3 / 2
        for frame in self._ordered():
            queue = self.waiting[frame.stream]
            queue.append(frame)
            if len(queue) > MOST_HELD:
                queue.popleft()
                self.unmatched += 1
            while all(self.waiting.values()):
                newest = max(queue[0].timestamp_ms for queue in self.waiting.values())
                early = [queue for queue in self.waiting.values() if queue[0].timestamp_ms < newest - tolerance_ms]
                for queue in early:
                    queue.popleft()
                self.unmatched += len(early)
                if not early:
                    yield {stream: queue.popleft() for stream, queue in self.waiting.items()}

    def _ordered(self) -> Iterator[CameraFrame]:
        """Frames in the order of count and time, none twice."""
        last: dict[str, CameraFrame] = {}
        while True:
            frame = self.source.wait(self.timeout_s)
            if frame is None:
                raise StreamLostError(f"no frame for {self.timeout_s:g} s")
            self.useless += 1  # until it is used
            if self.useless > self.most_useless:
                raise CameraError(f"{self.most_useless} frames came, of which none can be used: {self._why_useless()}")
            before = last.get(frame.stream)
            if before is not None and before.clock == frame.clock:
                if frame.number == before.number:
                    self.repeated += 1
                    continue
                _check_forwards(before, frame)
            last[frame.stream] = frame
            yield frame

    def _why_useless(self) -> str:
        if self.stale:
            return (
                f"{self.stale} are older than the call by their time; set the computer's clock right "
                "(NTP), or unplug the camera and plug it in"
            )
        empty = [stream for stream, queue in self.waiting.items() if not queue]
        return f"nothing of {' and '.join(empty) or 'one time'} matches; use a USB 3 port, a lower fps, or no infrared"


def _check_forwards(before: CameraFrame, frame: CameraFrame) -> None:
    """CameraError where count or time step back: what came first can no longer be told."""
    for what, was, now, unit in (
        ("frame numbers", before.number, frame.number, ""),
        ("timestamps", before.timestamp_ms, frame.timestamp_ms, " ms"),
    ):
        if now < was:
            raise CameraError(
                f"{frame.stream}: {what} run backwards, {was:.15g}{unit} to {now:.15g}{unit}; "
                "unplug the camera and plug it in, and see that nothing resets the computer's clock"
            )
