"""A recorded run of the analytic camera: a box whose top gives no depth to steep views, so that recoveries fire."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from franbv.acquisition import Reconstruction
from franbv.adapters.recording.contents import CameraFacts, RunFacts
from franbv.adapters.recording.watched import TimesOf, Watch
from franbv.adapters.recording.writer import RecordingWriter
from franbv.parameters import Parameters
from franbv.planners import fra
from franbv.reconstruction import reconstruct
from franbv.sensing import DepthBurst
from tests.franbv.analytic_camera import SENSOR, AnalyticCamera, FreeArm

BOX = ((-0.05, -0.04, 0.0), (0.05, 0.04, 0.07))
PARAMETERS = Parameters(n_frames=3, max_iterations=2, max_components=3)
SEED = 2
"""One of those with which the first view sets off a recovery."""
UNIT = 0.001
CAMERA = CameraFacts(SENSOR, 0.128, UNIT, "analytic", "0042", "1.2.3")
RUN = RunFacts("Box", "fra", PARAMETERS.model_dump(mode="json"), SEED, versions={"franbv": "0"})


@dataclass
class InSteps(AnalyticCamera):
    """The analytic camera with depth in whole millimetres, as 16-bit cameras give it."""

    def capture(self, T_world_cam, n_frames):
        burst = super().capture(T_world_cam, n_frames)
        steps = np.rint(burst.depths / UNIT).astype(np.uint16)
        return DepthBurst(steps * np.float32(UNIT), burst.intrinsics, burst.T_world_cam)


def hole_on_top(points, cosine):
    """A mirror-like patch on the top face that gives no depth to views within 55 deg of its normal."""
    on_top = (points[:, 2] > BOX[1][2] - 1e-6) & (np.abs(points[:, 0]) < 0.035) & (np.abs(points[:, 1]) < 0.03)
    return on_top & (cosine > np.cos(np.radians(55)))


def camera(kind: type[AnalyticCamera] = InSteps) -> AnalyticCamera:
    """A new one, whose noise begins anew."""
    return kind((BOX,), room=2.0, hole=hole_on_top)


def infrared(number: int) -> UInt8[np.ndarray, "h w"] | None:
    """Every other burst has an image."""
    return np.full((90, 160), number, np.uint8) if number % 2 == 0 else None


def record(path: Path, kind: type[AnalyticCamera] = InSteps, times_of: TimesOf = lambda number: None) -> Reconstruction:
    """Make the run and its recording."""
    with RecordingWriter(path, RUN, CAMERA) as writer:
        watch = Watch(writer, infrared, times_of)
        loop = watch.camera(camera(kind)), watch.arm(FreeArm()), fra(), PARAMETERS
        run = reconstruct(*loop, seed=SEED, observe=watch.observe)
        watch.stop(run.stop)
    return run
