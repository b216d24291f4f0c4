"""A depth camera that keeps every burst on disk, and gives it back when an interrupted run is taken up again.

The planner is deterministic: given the bursts of the first acquisitions it asks for the same poses again, in
milliseconds each, and goes on where the run was cut off. A burst is reused only if it was taken from the very pose.
"""

import json
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, UInt8
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst
from studies.base.atomic_file import write_atomically
from studies.base.case_folder import PROGRESS
from studies.store.images import read_png, write_png
from studies.store.views import camera_vector, read_arrays, write_arrays

Take = Callable[[RigidTransform, int], tuple[DepthBurst, UInt8[np.ndarray, "h w"]]]
"""(pose, frames) -> the burst, and the left infrared image of its first frame, where the depth image lies."""


@runtime_checkable
class BurstPool(Protocol):
    """Bursts of other runs: `studies.run.shared_bursts.SharedCaptures`, which knows scenes, as no reader need."""

    def take_over(self, T_world_cam: RigidTransform, n_frames: int, files: Iterable[Path]) -> bool: ...
    def offer(self, T_world_cam: RigidTransform, n_frames: int, files: Iterable[Path]) -> None: ...


@dataclass
class KeptCaptures:
    """Implements `franbv.sensing.DepthCamera`."""

    take: Take
    """The sensor itself."""
    intrinsics: Intrinsics
    min_z: float
    case: Path
    """Folder of the (unfinished) case; the captures go into its PROGRESS folder."""
    shared: BurstPool | None = None
    """Captures of other runs that may be taken over, None = none."""
    sensing_s: list[float] = field(default_factory=list)
    """Time that each capture took when it was taken, or taken over from another run [s]."""
    earlier_s: float = 0.0
    """Time that interrupted processes spent on the captures that were taken over [s]."""
    earlier_processor_s: float = 0.0
    """Processor time of the same [s]."""
    _began: float = field(default_factory=time.perf_counter)
    _processor_began: float = field(default_factory=time.process_time)

    @property
    def elapsed_s(self) -> float:
        """Wall time spent on the case so far, interrupted processes included [s]."""
        return self.earlier_s + time.perf_counter() - self._began

    @property
    def processor_s(self) -> float:
        """Processor time of all threads spent on the case so far, likewise [s]."""
        return self.earlier_processor_s + time.process_time() - self._processor_began

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """The burst from this pose: the kept one if there is one, else a new one, which is kept."""
        number = len(self.sensing_s)
        kept = self._kept(number, T_world_cam, n_frames)
        if kept is not None:
            return kept
        start = time.perf_counter()
        files = (infrared_path(self.case, number), self._path(number, ".npz"))
        files[0].parent.mkdir(exist_ok=True)
        if self.shared and self.shared.take_over(T_world_cam, n_frames, files):
            self._keep_times(number, time.perf_counter() - start)
            return DepthBurst(read_arrays(files[1])["depths"], self.intrinsics, T_world_cam)
        burst, infrared = self.take(T_world_cam, n_frames)
        sensing_s = time.perf_counter() - start
        write_png(files[0], infrared)
        self._keep(number, burst)
        self._keep_times(number, sensing_s)
        if self.shared:
            self.shared.offer(T_world_cam, n_frames, files)
        return burst

    def _keep_times(self, number: int, sensing_s: float) -> None:
        """Written last: a capture without its times does not count."""
        self.sensing_s.append(sensing_s)
        times = {"sensing_s": sensing_s, "elapsed_s": self.elapsed_s, "processor_s": self.processor_s}
        write_atomically(self._path(number, ".json"), json.dumps(times).encode())

    def _keep(self, number: int, burst: DepthBurst) -> None:
        arrays = {
            "depths": burst.depths,
            "camera": camera_vector(burst.intrinsics),
            "T_world_cam": burst.T_world_cam.as_matrix(),
        }
        write_arrays(self._path(number, ".npz"), arrays)

    def _kept(self, number: int, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst | None:
        """The stored burst, if it was taken from this pose with this many frames."""
        if not (self._path(number, ".npz").exists() and self._path(number, ".json").exists()):
            return None
        arrays = read_arrays(self._path(number, ".npz"))
        same_pose = np.array_equal(arrays["T_world_cam"], T_world_cam.as_matrix())
        if not same_pose or len(arrays["depths"]) != n_frames:
            return None
        times = json.loads(self._path(number, ".json").read_text())
        self.sensing_s.append(times["sensing_s"])
        self.earlier_s = max(self.earlier_s, times["elapsed_s"])
        self.earlier_processor_s = max(self.earlier_processor_s, times["processor_s"])
        return DepthBurst(arrays["depths"], self.intrinsics, T_world_cam)

    def drop_times(self) -> None:
        """Remove the time files once they are summed up elsewhere, so that equal runs leave equal captures."""
        for number in range(len(self.sensing_s)):
            self._path(number, ".json").unlink()

    def _path(self, number: int, suffix: str) -> Path:
        return self.case / PROGRESS / f"{number:03d}{suffix}"


def stored_depths(case: Path, number: int) -> Float[np.ndarray, "n h w"]:
    """The depth frames of one acquisition of a finished case [m]."""
    return read_arrays(depths_path(case, number))["depths"]


def depths_path(case: Path, number: int) -> Path:
    """File of the depth frames of one acquisition."""
    return case / PROGRESS / f"{number:03d}.npz"


def infrared_path(case: Path, number: int) -> Path:
    """File of the left infrared image of one acquisition."""
    return case / PROGRESS / f"{number:03d}_ir.png"


def stored_infrared(case: Path, number: int) -> UInt8[np.ndarray, "h w"] | None:
    """Left infrared image of the first frame, None where there is none."""
    path = infrared_path(case, number)
    return read_png(path) if path.exists() else None
