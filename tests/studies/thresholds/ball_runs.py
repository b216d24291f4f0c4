"""A run of the ball, kept in every way there is, and copies of it whose first burst has other noise."""

import os
from dataclasses import dataclass, field
from pathlib import Path
from shutil import copy2
from typing import Any

import numpy as np

from franbv.acquisition import Acquisition
from franbv.adapters.recording.contents import CameraFacts
from studies.run.bursts import KeptCaptures, depths_path
from studies.run.recording import recording_of
from studies.run.run_case import write_run
from studies.run.stored_run import ACQUISITIONS, RUN
from studies.store.views import read_arrays, view_path, write_arrays
from tests.studies.run.analytic_ball import CAMERA, SETTINGS, Ball, FreeArm, ball_reference

SHORT = SETTINGS.model_copy(update={"parameters": SETTINGS.parameters.model_copy(update={"max_iterations": 2})})


@dataclass
class Kept:
    """An observer that keeps the acquisitions."""

    seen: list[Acquisition] = field(default_factory=list)

    def observe(self, acquisition, coverage=None, infrared=None):
        self.seen.append(acquisition)

    def show(self, sight: Any):
        raise AssertionError("nothing is drawn here")

    def infrared(self, index: int, image: Any):
        raise AssertionError("nothing is drawn here")


@dataclass(frozen=True)
class BallRun:
    """One run: its folder, its recording, its acquisitions."""

    case: Path
    recording: Path
    seen: list[Acquisition]


def ball_run(folder: Path) -> BallRun:
    """The ball reconstructed and recorded; its highlight sets off a recovery."""
    case, recording, kept = folder / "case", folder / "ball.mcap", Kept()
    case.mkdir()
    captures = KeptCaptures(Ball().take, CAMERA, 0.128, case)
    with recording_of(recording, SHORT, "Ball", CameraFacts(CAMERA, 0.128, 0.001), case, {}) as watch:
        write_run(case, SHORT, "Ball", captures, FreeArm(), ball_reference(), False, watch, kept)
    return BallRun(case, recording, kept.seen)


def with_noise(depths: np.ndarray, spread: float, seed: int) -> np.ndarray:
    """The burst with noise of this standard deviation over Z^2 [1/m] instead of its own."""
    valid = (depths > 0).all(axis=0)
    z = np.where(valid, depths.mean(axis=0, dtype=float), 0.0)
    noise = np.random.default_rng(seed).normal(size=depths.shape)
    return np.where(valid, z + noise * spread * z**2, 0.0).astype(np.float32)


def noisy_copy(case: Path, target: Path, spread: float, seed: int, finished_s: float) -> Path:
    """What the monitor reads of a case, with other noise in the first burst, finished at another time [s]."""
    for name in (RUN, ACQUISITIONS, view_path(Path(), 0), depths_path(Path(), 0)):
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        copy2(case / name, target / name)
    arrays = read_arrays(depths_path(case, 0))
    write_arrays(depths_path(target, 0), {**arrays, "depths": with_noise(arrays["depths"], spread, seed)})
    os.utime(target / RUN, (finished_s, finished_s))
    return target
