"""Reads a recording of ours, to the last bit as it was written, and refuses one that contradicts itself."""

import base64
import binascii
import json
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from jaxtyping import UInt8
from pydantic import BaseModel, ValidationError

from franbv.adapters.recording import topics
from franbv.adapters.recording.contents import (
    CameraFacts,
    NothingRecordedError,
    Reachability,
    RecordedBurst,
    Recording,
    RecordingError,
    RunFacts,
)
from franbv.adapters.recording.depth_codes import image_of, metres
from franbv.adapters.recording.forms import RECTIFY, intrinsics_of, lens_distortion, pose_of
from franbv.adapters.recording.mcap_records import (
    RECORDING_MEND,
    FoundMessage,
    MessagePlace,
    chunk_at,
    is_closed,
    messages_of,
)
from franbv.adapters.recording.messages import (
    RECORDING_FORMAT,
    BurstMessage,
    CalibrationMessage,
    DecisionMessage,
    HeaderMessage,
    ImageMessage,
    ReachabilityMessage,
    StopMessage,
)
from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst

AnyMessage = TypeVar("AnyMessage", bound=BaseModel)
MOST_BURSTS = 10_000
"""Choice: hundreds of times the views of a run; what has more is damaged."""


def read_recording(path: Path) -> Recording:
    """The recording; its images are checked now and loaded when they are asked for.

    RecordingError, one line, for a file that is damaged, contradicts itself or has a newer format.
    """
    reading = _Reading(path)
    try:
        for found in messages_of(path):
            reading.take(found)
        return reading.result(is_closed(path))
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror or error}); {RECORDING_MEND}") from error


class _Reading:
    """What was read so far: messages must come in the order in which the writer gives them."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.header: HeaderMessage | None = None
        self.intrinsics: Intrinsics | None = None
        self.frames: list[MessagePlace] = []
        self.infrared: list[MessagePlace] = []
        self.bursts: list[RecordedBurst] = []
        self.decisions: list[dict[str, Any]] = []
        self.poses: list[Any] = []
        self.reachable: list[bool] = []
        self.stop: str | None = None

    def take(self, found: FoundMessage) -> None:
        """One message after the other."""
        try:
            self._take(found)
        except RecordingError:
            raise
        except (ValueError, RecursionError, binascii.Error) as error:
            place = f"{found.topic} at byte {found.place.chunk}"
            words = f"{place} cannot be used ({_short(error)}); {RECORDING_MEND}"
            raise RecordingError(f"{self.path}: {words}") from error

    def _take(self, found: FoundMessage) -> None:
        topic, data = found.topic, found.data
        if topic == topics.HEADER_TOPIC.name:
            self._begin(data)
        elif self.header is None:
            raise ValueError("it comes before the header")
        elif topic == topics.CALIBRATION_TOPIC.name:
            said = _checked(CalibrationMessage, data)
            lens = lens_distortion(said.distortion_model, said.D)
            if lens is not None:
                raise RecordingError(f"{self.path}: {topic} has {lens}: {RECTIFY}")
            self.intrinsics = intrinsics_of(said.width, said.height, said.K)
        elif topic == topics.DEPTH_TOPIC.name:
            self.frames.append(self._seen(found, self.intrinsics))
        elif topic == topics.INFRARED_TOPIC.name:
            self.infrared.append(self._seen(found, None))
        elif topic == topics.BURST_TOPIC.name:
            self._end_burst(_checked(BurstMessage, data))
        elif topic == topics.REACHABILITY_TOPIC.name:
            said = _checked(ReachabilityMessage, data)
            if len(said.poses) != len(said.reachable):
                raise ValueError("as many answers as questions are wanted")
            self.poses += [pose_of(rows) for rows in said.poses]
            self.reachable += said.reachable
        elif topic == topics.DECISION_TOPIC.name:
            self._decide(_checked(DecisionMessage, data))
        elif topic == topics.STOP_TOPIC.name:
            self.stop = _checked(StopMessage, data).reason

    def _begin(self, data: bytes) -> None:
        if self.header is not None:
            raise ValueError("it is the second one")
        said = json.loads(data)
        if isinstance(said, dict) and said.get("format") != RECORDING_FORMAT:
            raise RecordingError(
                f"{self.path}: has format {said.get('format')}, and this version reads {RECORDING_FORMAT}; "
                "read it with the version that wrote it"
            )
        self.header = _checked(HeaderMessage, data)

    def _seen(self, found: FoundMessage, intrinsics: Intrinsics | None) -> MessagePlace:
        """Where the image stands, once it was seen to be right."""
        _pixels(found.data, intrinsics)
        return found.place

    def _end_burst(self, said: BurstMessage) -> None:
        """The frames since the last burst are those of this one."""
        if self.intrinsics is None:
            raise ValueError("it comes before the calibration")
        if said.index != len(self.bursts) or said.index >= MOST_BURSTS:
            raise ValueError(f"it is burst {said.index} where {len(self.bursts)} should stand")
        if len(self.frames) != said.n_frames or len(said.times_ns) != said.n_frames:
            raise ValueError(f"it has {len(self.frames)} of {said.n_frames} frames")
        if len(self.infrared) != int(said.infrared):
            raise ValueError(f"it has {len(self.infrared)} infrared images of {int(said.infrared)}")
        T_world_cam = pose_of(said.T_world_cam)
        path, intrinsics, unit = self.path, self.intrinsics, said.depth_unit
        frames, infrared = tuple(self.frames), tuple(self.infrared)

        def read() -> DepthBurst:
            pixels = [_pixels(data, intrinsics) for data in _data_of(path, frames)]
            return DepthBurst(np.stack([metres(image, unit) for image in pixels]), intrinsics, T_world_cam)

        def read_infrared() -> UInt8[np.ndarray, "h w"] | None:
            return next((_pixels(data, None) for data in _data_of(path, infrared)), None)

        facts = said.n_frames, tuple(said.times_ns), said.motion_s
        self.bursts.append(RecordedBurst(T_world_cam, pose_of(said.T_asked), *facts, read, read_infrared))
        self.frames, self.infrared = [], []

    def _decide(self, said: DecisionMessage) -> None:
        if said.index != len(self.decisions) or said.index >= len(self.bursts):
            raise ValueError(f"it is about burst {said.index} where {len(self.decisions)} should stand")
        pose_of(said.T_world_cam)
        self.decisions.append(said.model_dump(mode="json"))

    def result(self, closed: bool) -> Recording:
        """All of it; RecordingError where nothing can be done with it."""
        if self.header is None or self.intrinsics is None:
            raise NothingRecordedError(f"{self.path}: ends before its header; {RECORDING_MEND}")
        if not self.bursts:
            raise NothingRecordedError(f"{self.path}: holds no whole burst; record again")
        notices = []
        if not closed:
            rest = f", and {len(self.frames)} frames of one that is not" if self.frames else ""
            notices.append(f"{self.path}: was cut off; {len(self.bursts)} whole bursts are read{rest}")
        h = self.header
        run = RunFacts(h.title, h.planner, h.parameters, h.seed, h.azimuth_deg, h.ablation, h.sensor, h.versions)
        return Recording(
            path=self.path,
            run=run,
            camera=CameraFacts(self.intrinsics, h.min_z, h.depth_unit, h.model, h.serial, h.firmware),
            bursts=tuple(self.bursts),
            decisions=tuple(self.decisions),
            stop=self.stop,
            reachability=Reachability(tuple(self.poses), tuple(self.reachable)),
            notices=tuple(notices),
        )


def _data_of(path: Path, places: tuple[MessagePlace, ...]) -> Iterator[bytes]:
    """The payloads of these messages, each chunk unpacked once."""
    for at, together in groupby(places, key=lambda place: place.chunk):
        chunk = chunk_at(path, at)
        yield from (chunk[place.number] for place in together)


def _pixels(data: bytes, intrinsics: Intrinsics | None) -> np.ndarray:
    """The image of a message; ValueError where it is not as large as the calibration says."""
    said = _checked(ImageMessage, data)
    if intrinsics is not None and (said.width, said.height) != (intrinsics.width, intrinsics.height):
        raise ValueError(f"an image of {said.width} x {said.height} px, not as the calibration says")
    return image_of(base64.b64decode(said.data, validate=True), said.width, said.height, said.encoding)


def _checked(model: type[AnyMessage], data: bytes) -> AnyMessage:
    return model.model_validate(json.loads(data))


def _short(error: Exception) -> str:
    if isinstance(error, ValidationError):
        first = error.errors(include_url=False, include_input=False)[0]
        return f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
    return " ".join(str(error).split())[:200]
