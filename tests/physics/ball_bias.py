"""Depth of a ball that a camera looks down on, against the ball's true surface, by distance from its middle."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from franbv.frames import Intrinsics
from render.d435i import SensorSettings, SimulatedD435i
from render.depth.coding import DepthFormat
from render.world.rig import Rig
from tests.physics.mirror_scenes import MirrorView, pixel_rays

RINGS = 5
"""Rings of equal width between the middle and the outline."""
FINE = DepthFormat(unit=1e-4)
"""Steps of 0.1 mm, finer than the biases that are looked for."""
PUBLISHED_HEIGHT, PUBLISHED_FOCAL, PUBLISHED_BASELINE = 0.93, 896.0, 0.0548
"""Height of the camera over the table [m], focal length [px] and baseline [m] of the published frame of a polished
ball of R 43.5 mm on a metal table."""


@dataclass(frozen=True)
class BallBias:
    """Measured minus true Z-depth on one ball."""

    filled: float
    """Share of the ball's pixels with a depth."""
    median_mm: float
    rings_mm: tuple[float, ...]
    """Medians from the middle outward."""
    middle_mm: float
    """Median within half the outline's radius."""


def camera_near(view: MirrorView, seed: int = 1) -> SimulatedD435i:
    """The D435i at full resolution."""
    return SimulatedD435i(view.scene, SensorSettings(profile="1280x720", crop=None, depth=FINE), seed)


def camera_of_published_frame(view: MirrorView, rows: int = 420, seed: int = 1) -> SimulatedD435i:
    """Our rig with that focal length and baseline; the middle `rows` of its 720, which hold the ball and its
    surroundings. Pattern, projector's place, pixels and noise stay those of the D435i."""
    camera = camera_near(view, seed)
    middle = ((1280 - 1) / 2, (rows - 1) / 2)
    camera.rig = Rig(Intrinsics(1280, rows, PUBLISHED_FOCAL, PUBLISHED_FOCAL, *middle), PUBLISHED_BASELINE)
    return camera


def ball_bias(camera: SimulatedD435i, view: MirrorView, radius: float) -> BallBias:
    """Measure one frame from straight above, the ball's middle on the optical axis."""
    depth, truth = camera.measure(view.T_world_cam, 1).depths[0], camera.truth(view.T_world_cam)
    return bias_by_ring(depth, truth.depth, truth.body == view.mirror, outline_share(camera, view, radius))


def outline_share(camera: SimulatedD435i, view: MirrorView, radius: float) -> Float[np.ndarray, "h w"]:
    """Distance of each pixel from the ball's middle in units of its outline: sin of the half angle is R / distance."""
    to_centre = view.T_world_cam.translation[2] - radius
    rays = pixel_rays(camera)
    return np.hypot(rays[..., 0], rays[..., 1]) * np.sqrt(to_centre**2 - radius**2) / radius


def bias_by_ring(
    depth: Float[np.ndarray, "h w"],
    true_depth: Float[np.ndarray, "h w"],
    ball: Bool[np.ndarray, "h w"],
    share: Float[np.ndarray, "h w"],
) -> BallBias:
    """depth, true_depth: Z [m], 0 = invalid; share: see `outline_share`."""
    valid = ball & (depth > 0)
    error_mm = 1e3 * (depth.astype(float) - true_depth)
    ring = np.minimum((share * RINGS).astype(int), RINGS - 1)
    return BallBias(
        float(valid.sum() / ball.sum()),
        float(np.median(error_mm[valid])),
        tuple(float(np.median(error_mm[valid & (ring == k)])) for k in range(RINGS)),
        float(np.median(error_mm[valid & (share < 0.5)])),
    )
