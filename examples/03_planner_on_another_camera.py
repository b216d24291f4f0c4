"""The planner alone, on a camera of your own: here depth of a ball on a table, straight from its equation."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.parameters import Parameters
from franbv.planners import pb
from franbv.reconstruction import reconstruct
from franbv.sensing import DepthBurst

RADIUS, CENTRE = 0.05, np.array([0.0, 0.0, 0.05])


class BallCamera:
    """A perfect depth camera in front of a ball on the table z = 0."""

    intrinsics = Intrinsics(width=60, height=40, fx=40.0, fy=40.0, cx=29.5, cy=19.5)
    min_z = 0.12

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """Z-depth of the nearer of ball and table; rays are scaled to z = 1, so their parameter is Z itself."""
        rays = T_world_cam.rotation.apply(self.intrinsics.pixel_directions().reshape(-1, 3))
        eye = T_world_cam.translation
        a, b = np.sum(rays**2, axis=1), rays @ (eye - CENTRE)
        discriminant = b**2 - a * (np.sum((eye - CENTRE) ** 2) - RADIUS**2)
        ball = np.where(discriminant > 0, (-b - np.sqrt(np.maximum(discriminant, 0))) / a, np.inf)
        table = np.where(rays[:, 2] < 0, -eye[2] / np.minimum(rays[:, 2], -1e-9), np.inf)
        depth = np.minimum(ball, table)
        depth = np.where(np.isfinite(depth), depth, 0).reshape(40, 60).astype(np.float32)
        return DepthBurst(np.repeat(depth[None], n_frames, axis=0), self.intrinsics, T_world_cam)


class Tripod:
    """Goes wherever it is told to, above the table, in no time."""

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """Above the table."""
        return bool(T_world_cam.translation[2] > 0.05)

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """Seconds."""
        return 0.0


parameters = Parameters(n_frames=1, max_iterations=6)
run = reconstruct(BallCamera(), Tripod(), pb(), parameters, seed=0)
for view in run.acquisitions:
    x, y, z = view.burst.T_world_cam.translation
    print(f"view {view.index}: from ({x:+.2f}, {y:+.2f}, {z:+.2f}) m, {len(view.points):4d} points on the ball")
off_surface = np.linalg.norm(run.cloud - CENTRE, axis=1) - RADIUS
print(f"{len(run.cloud)} points, RMS distance from the ball {np.sqrt(np.mean(off_surface**2)) * 1e3:.2f} mm")
