"""Writes a recording while a run lasts: MCAP, burst by burst, each on disk before the run goes on.

A burst is one or more chunks with checksums, its frames first and `BurstMessage` last, so that whatever ends the run
leaves a file of which everything up to the last whole burst can be read. Needs the extra `record`.
"""

import contextlib
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from jaxtyping import UInt8
from mcap.writer import Writer
from scipy.spatial.transform import RigidTransform

from franbv.adapters.recording import topics
from franbv.adapters.recording.contents import CameraFacts, RecordingError, RunFacts
from franbv.adapters.recording.depth_codes import GREY_8, coding_of, grey_bytes, image_bytes
from franbv.adapters.recording.forms import as_json, calibration, frame_transform, matrix_rows, pose_in_frame, raw_image
from franbv.adapters.recording.messages import MOST_FRAMES, header
from franbv.adapters.recording.topics import PROFILE, Topic
from franbv.sensing import DepthBurst

CHUNK_BYTES = 4 * 2**20
"""A chunk ends when it is larger [bytes]. Choice: a reader needs little memory, and compression suffers little."""


class RecordingWriter:
    """A recording that is being written. A context manager: leaving it ends the file, whatever happened.

    Never writes over a file that is there. Times are the wall's unless the camera has its own.
    """

    def __init__(self, path: Path, run: RunFacts, camera: CameraFacts, clock: Callable[[], int] = time.time_ns) -> None:
        """Begin the file; clock: the time [ns] where nothing else gives one.

        RecordingError where the file exists or cannot be made.
        """
        self._path, self._camera, self._clock, self._failed = path, camera, clock, False
        try:
            self._file = path.open("xb")
        except FileExistsError:
            raise RecordingError(f"{path}: is there already, and is never written over; name another file") from None
        except OSError as error:
            raise RecordingError(f"{path}: cannot be written ({error.strerror}); name another file") from error
        self._writer = Writer(self._file, chunk_size=CHUNK_BYTES, enable_data_crcs=True)
        self._writer.start(profile=PROFILE, library="franbv")
        self._channels = {topic.name: self._channel(topic) for topic in topics.TOPICS}
        self._bursts = 0
        now = clock()
        self._add(topics.HEADER_TOPIC, header(run, camera), now)
        self._add(topics.CALIBRATION_TOPIC, calibration(camera.intrinsics, now), now)
        self._to_disk()

    def burst(
        self,
        burst: DepthBurst,
        T_asked: RigidTransform,
        motion_s: float = 0.0,
        infrared: UInt8[np.ndarray, "h w"] | None = None,
        times_ns: Sequence[int] | None = None,
    ) -> None:
        """Add a burst. infrared: of its first frame; times_ns: when each frame was taken."""
        if burst.depths.dtype != np.float32 or burst.intrinsics != self._camera.intrinsics:
            raise RecordingError(
                f"{self._path}: burst {self._bursts} is {burst.depths.dtype} with {burst.intrinsics}; "
                f"a recording holds float32 of one camera, {self._camera.intrinsics}"
            )
        if not 1 <= len(burst.depths) <= MOST_FRAMES:
            raise RecordingError(f"{self._path}: a burst has 1 to {MOST_FRAMES} frames, not {len(burst.depths)}")
        now = self._clock()
        times = list(times_ns) if times_ns is not None else [now] * len(burst.depths)
        unit, size = self._camera.depth_unit, (burst.intrinsics.width, burst.intrinsics.height)
        coding = coding_of(burst.depths, unit)
        for depth, at in zip(burst.depths, times, strict=True):
            self._add(topics.DEPTH_TOPIC, raw_image(image_bytes(depth, coding, unit), size, coding, at), at)
        if infrared is not None:
            picture = raw_image(grey_bytes(infrared), infrared.shape[::-1], GREY_8, times[0])
            self._add(topics.INFRARED_TOPIC, picture, times[0])
        self._add(topics.POSE_TOPIC, pose_in_frame(burst.T_world_cam, now), now)
        self._add(topics.TRANSFORM_TOPIC, frame_transform(burst.T_world_cam, now), now)
        facts = {
            "index": self._bursts,
            "n_frames": len(burst.depths),
            "infrared": infrared is not None,
            "depth_unit": unit,
            "T_world_cam": matrix_rows(burst.T_world_cam),
            "T_asked": matrix_rows(T_asked),
            "times_ns": times,
            "motion_s": motion_s,
        }
        self._add(topics.BURST_TOPIC, facts, now)
        self._bursts += 1
        self._to_disk()

    def reachability(self, poses: Sequence[RigidTransform], reachable: Sequence[bool]) -> None:
        """Add what the arm said of these poses; on disk with the next burst."""
        said = {"poses": [matrix_rows(T) for T in poses], "reachable": list(reachable)}
        self._add(topics.REACHABILITY_TOPIC, said, self._clock())

    def decision(self, decision: Mapping[str, Any], planning_s: Mapping[str, float], sensing_s: float) -> None:
        """Add the planner's decision at the last burst, as `decision_of` has it, and how long it took [s]."""
        now = self._clock()
        self._add(topics.DECISION_TOPIC, decision, now)
        times = {"index": decision["index"], "planning_s": dict(planning_s), "sensing_s": sensing_s}
        self._add(topics.TIMES_TOPIC, times, now)
        self._to_disk()

    def stop(self, reason: str) -> None:
        """Say that the run came to its end, and by which rule."""
        self._add(topics.STOP_TOPIC, {"reason": reason}, self._clock())

    def close(self) -> None:
        """End the file with its index; after a failed write it stays as it is."""
        if self._file.closed:
            return
        if self._failed:
            with contextlib.suppress(OSError):
                self._file.close()
            return
        with self._writing():
            self._writer.finish()
            self._file.flush()
            os.fsync(self._file.fileno())
            self._file.close()

    def __enter__(self) -> "RecordingWriter":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _channel(self, topic: Topic) -> int:
        schema = self._writer.register_schema(topic.schema, "jsonschema", as_json(topic.form))
        return self._writer.register_channel(topic.name, "json", schema)

    def _add(self, topic: Topic, message: Mapping[str, Any], time_ns: int) -> None:
        with self._writing():
            self._writer.add_message(self._channels[topic.name], time_ns, as_json(message), time_ns, self._bursts)

    def _to_disk(self) -> None:
        with self._writing():
            self._writer.flush()
            os.fsync(self._file.fileno())

    @contextlib.contextmanager
    def _writing(self) -> Iterator[None]:
        """RecordingError where the disk takes no more: what is on it already can be read."""
        try:
            yield
        except OSError as error:
            self._failed = True
            raise RecordingError(
                f"{self._path}: the recording ends after {self._bursts} bursts ({error.strerror}); free some space"
            ) from error
