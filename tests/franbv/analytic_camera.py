"""An analytic depth camera and an arm: boxes and spheres on a table, ray-cast in closed form, with holes on demand."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst

SENSOR = Intrinsics(60, 40, 40.125, 40.125, 29.5, 19.5)
"""The paper's 60 x 40 sensor: 640x360 (fx 321) decimated by 8 and cropped to the centre."""


@dataclass
class AnalyticCamera:
    """Perfect depth of axis-aligned boxes and spheres on a table, plus Gaussian noise and holes."""

    boxes: tuple = ()
    """(lower corner, upper corner) of each box [m]."""
    spheres: tuple = ()
    """(centre, radius) of each sphere [m]."""
    room: float = np.inf
    """Radius of a spherical room around everything, so that every ray ends somewhere [m]."""
    noise: float = 0.0005
    """Standard deviation of depth at 0.3 m, growing with Z^2 [m]."""
    hole: Callable = lambda points, cosine: np.zeros(len(points), bool)
    """(surface points [m], cosine of their incidence angle) -> which of them give no depth."""
    seed: int = 0
    intrinsics: Intrinsics = SENSOR
    min_z: float = 0.128
    """f B / 126 of the 640x360 profile [m]."""
    captures: int = field(default=0, init=False)

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """Depth of the nearest surface along every pixel's ray; the noise of every frame is new."""
        origin = T_world_cam.translation
        rays = T_world_cam.rotation.apply(self.intrinsics.pixel_directions().reshape(-1, 3))
        z, normals = np.full(len(rays), np.inf), np.zeros((len(rays), 3))
        surfaces = [self._table(origin, rays), *(_box(b, origin, rays) for b in self.boxes)]
        surfaces += [_sphere(s, origin, rays) for s in self.spheres]
        surfaces += [_sphere(((0.0, 0.0, 0.0), self.room), origin, rays, from_inside=True)] * bool(self.room < np.inf)
        for depth, normal in surfaces:
            nearer = depth < z
            z[nearer], normals[nearer] = depth[nearer], normal[nearer]
        seen = np.isfinite(z) & (z >= self.min_z)
        cosine = -np.sum(rays * normals, axis=1) / np.linalg.norm(rays, axis=1)
        seen[seen] &= ~self.hole(origin + z[seen, None] * rays[seen], cosine[seen])
        rng = np.random.default_rng([self.seed, self.captures])
        self.captures += 1
        z = np.where(seen, z, 0.0)
        frames = z + rng.normal(size=(n_frames, len(z))) * self.noise * (z / 0.3) ** 2
        frames = frames.reshape(n_frames, self.intrinsics.height, self.intrinsics.width)
        return DepthBurst(frames.astype(np.float32), self.intrinsics, T_world_cam)

    def _table(self, origin, rays):
        with np.errstate(divide="ignore"):
            t = -origin[2] / rays[:, 2]
        return np.where((rays[:, 2] < 0) & (t < 1.5), t, np.inf), np.tile([0.0, 0.0, 1.0], (len(rays), 1))


def _box(box, origin, rays):
    lower, upper = np.array(box[0]), np.array(box[1])
    with np.errstate(divide="ignore"):
        t = np.stack([lower - origin, upper - origin])[:, None, :] / rays  # (2, n, 3)
    enters = t.min(axis=0)
    axis = np.argmax(enters, axis=1)
    enter, leave = enters.max(axis=1), t.max(axis=0).min(axis=1)
    normals = -np.sign(np.take_along_axis(rays, axis[:, None], axis=1)) * np.eye(3)[axis]
    return np.where((enter < leave) & (enter > 0), enter, np.inf), normals


def _sphere(sphere, origin, rays, from_inside=False):
    centre, radius = np.array(sphere[0]), sphere[1]
    a, b = np.sum(rays**2, axis=1), rays @ (origin - centre)
    discriminant = b**2 - a * (np.sum((origin - centre) ** 2) - radius**2)
    side = 1.0 if from_inside else -1.0
    t = np.where(discriminant > 0, (-b + side * np.sqrt(np.maximum(discriminant, 0.0))) / a, -np.inf)
    t = np.where(t > 0, t, np.inf)
    points = origin + np.where(np.isfinite(t), t, 0.0)[:, None] * rays
    return t, -side * (points - centre) / radius


@dataclass
class FreeArm:
    """An arm that stands anywhere above the table, moving at 0.25 m/s."""

    clearance: float = 0.03
    """Lowest height of the camera [m]."""
    at: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, 0.5]))

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """Above the table."""
        return bool(T_world_cam.translation[2] >= self.clearance)

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """Seconds along a straight line."""
        seconds = float(np.linalg.norm(T_world_cam.translation - self.at)) / 0.25
        self.at = T_world_cam.translation
        return seconds
