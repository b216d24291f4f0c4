"""A camera before a box one side of which shows what lies behind it, unless it is looked at face on."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.robust.scans import quarter_turns
from franbv.sensing import DepthBurst
from tests.franbv.analytic_camera import AnalyticCamera

BOX = ((-0.05, -0.04, 0.0), (0.05, 0.04, 0.08))
"""Lower and upper corner [m]; the side towards +y mirrors."""
ROOM = 2.0
"""Radius of the room [m]."""


@dataclass
class MirrorCamera(AnalyticCamera):
    """Perfect but for that side: depth is right there up to `right_deg` of incidence, else what would be seen without
    the box."""

    boxes: tuple = (BOX,)
    room: float = ROOM
    right_deg: tuple[float, float] = (15.0, 15.0)
    """Upright and on end [deg]."""

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """Both, put together."""
        solid = super().capture(T_world_cam, n_frames)
        empty = AnalyticCamera((), (), self.room, self.noise, seed=self.seed).capture(T_world_cam, n_frames)
        rays = T_world_cam.rotation.apply(self.intrinsics.pixel_directions().reshape(-1, 3))
        points = T_world_cam.translation + solid.depths[0].reshape(-1, 1) * rays
        on_side = (np.abs(points[:, 1] - BOX[1][1]) < 0.004) & (np.abs(points[:, 0]) < 0.05) & (points[:, 2] > 0.003)
        cosine = np.abs(rays[:, 1]) / np.linalg.norm(rays, axis=1)
        wrong = on_side & (cosine < np.cos(np.radians(self.right_deg[quarter_turns(T_world_cam)])))
        depths = np.where(wrong.reshape(solid.depths.shape[1:]), empty.depths, solid.depths)
        return DepthBurst(depths, solid.intrinsics, T_world_cam)
