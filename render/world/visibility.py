"""Which points of a surface some camera above the table can see, whatever it is made of."""

import numpy as np
from jaxtyping import Bool, Float

from render.world import backend
from render.world.mitsuba_scene import LoadedScene

SEARCH_DIRECTIONS = 256
"""Directions tried, about 9 deg apart (choice: through a narrower gap no stereo pair sees at 0.3 m)."""
LOWEST_ELEVATION = np.radians(10.0)
"""Of a view [rad] (choice: the planner's lowest candidates stand at a polar angle of 80 deg)."""
FARTHEST = 0.6
"""A view is free if nothing stands within this distance of the point [m] (choice: past the part, before the walls)."""
BATCH = 16
"""Directions tried at once (choice: after a few batches only the hidden points are left)."""


def seen_from_above(
    world: LoadedScene, points: Float[np.ndarray, "n 3"], normals: Float[np.ndarray, "n 3"]
) -> Bool[np.ndarray, "n"]:
    """Whether the front of each surface point is in sight from any direction of the upper hemisphere.

    points [m] and outward unit normals, world frame. Exact rays against all bodies, table included.
    """
    seen = np.zeros(len(points), bool)
    directions = upper_directions(SEARCH_DIRECTIONS)
    for start in range(BATCH):  # every BATCH-th direction, so that each batch spans the hemisphere
        batch = directions[start::BATCH]
        point, direction = np.nonzero(~seen[:, None] & (normals @ batch.T > 1e-3))
        if len(point):
            free = ~_blocked(world, points[point], normals[point], batch[direction])
            seen[point[free]] = True
    return seen


def upper_directions(count: int) -> Float[np.ndarray, "n 3"]:
    """Unit vectors spread evenly from LOWEST_ELEVATION to the zenith (Fibonacci lattice)."""
    k = np.arange(count) + 0.5
    z = 1 - k / count * (1 - np.sin(LOWEST_ELEVATION))
    azimuth = np.pi * (1 + np.sqrt(5)) * k
    level = np.sqrt(1 - z**2)
    return np.column_stack([level * np.cos(azimuth), level * np.sin(azimuth), z])


def _blocked(
    world: LoadedScene,
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    directions: Float[np.ndarray, "n 3"],
) -> Bool[np.ndarray, "n"]:
    """Whether something stands in the way of each point within FARTHEST along its direction."""
    mi = backend.mitsuba()
    import drjit as dr

    si = dr.zeros(mi.SurfaceInteraction3f, len(points))
    si.t, si.p, si.n = mi.Float(1), mi.Point3f(points.T), mi.Normal3f(normals.T)
    ray = si.spawn_ray_to(mi.Point3f((points + FARTHEST * directions).T))
    return world.scene.ray_test(ray).numpy()
