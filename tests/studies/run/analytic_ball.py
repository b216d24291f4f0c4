"""A ball on a table as an analytic depth camera: closed-form depth, holes where the ball mirrors the camera."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.evaluation.reference import Reference
from franbv.frames import Intrinsics
from franbv.parameters import Parameters
from franbv.sensing import DepthBurst
from studies.run.bursts import KeptCaptures
from studies.run.run_case import RunSettings, write_run

CAMERA = Intrinsics(60, 40, 40.125, 40.125, 29.5, 19.5)
"""The paper's 60 x 40 sensor."""
CENTRE, RADIUS = np.array([0.0, 0.0, 0.05]), 0.05
HIGHLIGHT = 0.5
"""The ball gives no depth within this angle of incidence [rad]: it mirrors the projector into the camera."""
SETTINGS = RunSettings(parameters=Parameters(n_frames=3, max_iterations=4))


@dataclass
class Ball:
    """Takes bursts; counts them."""

    taken: list[RigidTransform] = field(default_factory=list)
    fail_at: int | None = None
    """Raise KeyboardInterrupt instead of taking this burst."""

    def take(self, T_world_cam: RigidTransform, n_frames: int):
        """A burst and an infrared image; the noise depends on the pose alone."""
        if len(self.taken) == self.fail_at:
            raise KeyboardInterrupt
        self.taken.append(T_world_cam)
        depth, incidence = ball_depth(T_world_cam)
        noise = np.random.default_rng(np.abs(T_world_cam.translation * 1e6).astype(int).tolist())
        frames = depth + noise.normal(size=(n_frames, *depth.shape)) * 0.0005
        hole = np.nan_to_num(incidence, nan=np.pi) < HIGHLIGHT
        frames[:, hole | (depth == 0)] = 0
        infrared = np.where(hole, 255, 90 + 60 * np.cos(np.nan_to_num(incidence, nan=1.2)))
        picture = np.kron(infrared, np.ones((8, 8))).astype(np.uint8)
        return DepthBurst(frames.astype(np.float32), CAMERA, T_world_cam), picture


class FreeArm:
    """Stands anywhere above the table."""

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """Above the table."""
        return bool(T_world_cam.translation[2] > 0.02)

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """Always two seconds."""
        return 2.0


def ball_depth(T_world_cam: RigidTransform) -> tuple[np.ndarray, np.ndarray]:
    """Z-depth [m] of ball and table, 0 = nothing, and the ball's incidence angle [rad], NaN off the ball."""
    rays = CAMERA.pixel_directions() @ T_world_cam.rotation.as_matrix().T
    eye = T_world_cam.translation
    length = np.linalg.norm(rays, axis=-1)
    unit = rays / length[..., None]
    b = unit @ (eye - CENTRE)
    under_root = b**2 - (np.sum((eye - CENTRE) ** 2) - RADIUS**2)
    on_ball = under_root > 0
    t_ball = np.where(on_ball, -b - np.sqrt(np.maximum(under_root, 0)), np.inf)
    t_table = np.where(unit[..., 2] < -0.05, -eye[2] / np.minimum(unit[..., 2], -0.05), np.inf)
    normal = (eye + np.where(on_ball, t_ball, 0)[..., None] * unit - CENTRE) / RADIUS
    incidence = np.where(on_ball, np.arccos(np.clip(-(normal * unit).sum(-1), -1, 1)), np.nan)
    t = np.minimum(t_ball, t_table)
    return np.where(np.isfinite(t), t / length, 0), incidence


def ball_reference(count: int = 3000) -> Reference:
    """Points spread evenly over the ball down to 10 deg from its foot (Fibonacci lattice), and the exact distance."""
    k = np.arange(count) + 0.5
    z = 1 - k / count * (1 + np.cos(np.radians(10)))
    azimuth = np.pi * (1 + np.sqrt(5)) * k
    level = np.sqrt(1 - z**2)
    points = CENTRE + RADIUS * np.column_stack([level * np.cos(azimuth), level * np.sin(azimuth), z])
    return Reference(points, lambda cloud: np.abs(np.linalg.norm(cloud - CENTRE, axis=1) - RADIUS))


def reconstruct_ball(folder: Path, ball: Ball | None = None, settings: RunSettings = SETTINGS) -> Ball:
    """A whole reconstruction in `folder`, as the command would make it with a rendered camera."""
    ball = ball or Ball()
    captures = KeptCaptures(ball.take, CAMERA, 0.128, folder)
    write_run(folder, settings, "Ball <mirror> & table", captures, FreeArm(), ball_reference())
    return ball
