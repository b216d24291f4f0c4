"""U(x) of eq. (2) computed a second way: surface points instead of conics, polygons instead of sectors, counting
instead of sorting."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from franbv.ellipsoids import Ellipsoids
from franbv.frames import Intrinsics, look_at
from franbv.parameters import Parameters
from franbv.utility import view_utilities

SENSOR = Intrinsics(60, 40, 40.125, 40.125, 29.5, 19.5)
POLYGON_ERROR = 4e-3
"""Share of the largest utility: the hull of 4,000 surface points lies inside the silhouette."""


def sphere_points(count: int = 4_000) -> np.ndarray:
    """Evenly spread on the unit sphere (Fibonacci lattice)."""
    k = np.arange(count) + 0.5
    z, azimuth = 1 - 2 * k / count, np.pi * (1 + np.sqrt(5)) * k
    return np.column_stack([np.sqrt(1 - z**2) * np.cos(azimuth), np.sqrt(1 - z**2) * np.sin(azimuth), z])


def area_within_image(pixels: np.ndarray) -> float:
    """Area of the convex hull of these image points, cut edge by edge to the image [px^2]."""
    polygon = [tuple(pixels[k]) for k in ConvexHull(pixels).vertices]
    for axis, sign, limit in ((0, 1, -0.5), (0, -1, -59.5), (1, 1, -0.5), (1, -1, -39.5)):
        kept = []
        for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
            a, b = sign * p[axis] - limit, sign * q[axis] - limit
            if a >= 0:
                kept.append(p)
            if a * b < 0:
                kept.append(tuple(np.add(p, np.subtract(q, p) * a / (a - b))))
        polygon = kept
    x, y = np.array(polygon or [(0.0, 0.0)]).T
    return 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def utility_by_points(bodies: Ellipsoids, pose, parameters: Parameters) -> float:
    """Sum over the bodies: sign, one half to the power of how many centres are nearer, area of the projected points."""
    to_camera = pose.inv()
    if parameters.rank_by == "distance":
        depths = [np.linalg.norm(np.subtract(centre, pose.translation)) for centre in bodies.centres]
    else:
        depths = [to_camera.apply(centre)[2] for centre in bodies.centres]
    total = 0.0
    for centre, shape, frontier, depth in zip(bodies.centres, bodies.shapes, bodies.is_frontier, depths, strict=True):
        values, vectors = np.linalg.eigh(shape)
        points = to_camera.apply(centre + (sphere_points() * np.sqrt(values)) @ vectors.T)
        u = SENSOR.fx * points[:, 0] / points[:, 2] + SENSOR.cx
        v = SENSOR.fy * points[:, 1] / points[:, 2] + SENSOR.cy
        nearer = sum(other < depth for other in depths)
        area = area_within_image(np.column_stack([u, v]))
        total += (1 if frontier else -1) * parameters.weight_base**nearer * area
    return total


@pytest.mark.parametrize("seed", range(2))
def test_utility_computed_a_second_way(seed):
    """Ten random ellipsoids, views from all sides, some cut by the image's edge: equal to the polygons' error."""
    rng = np.random.default_rng(seed)
    factors = rng.normal(size=(10, 3, 3)) * 0.012
    shapes = factors @ factors.transpose(0, 2, 1) + 1e-5 * np.eye(3)
    bodies = Ellipsoids(rng.uniform(-0.09, 0.09, (10, 3)), shapes, rng.uniform(size=10) < 0.5)
    eyes = rng.normal(size=(5, 3))
    poses = [look_at(0.28 * eye / np.linalg.norm(eye), rng.uniform(-0.02, 0.02, 3)) for eye in eyes]
    for base, rank_by in ((0.5, "distance"), (0.5, "depth"), (1.0, "distance")):
        parameters = Parameters(weight_base=base, rank_by=rank_by)
        found = view_utilities(bodies, SENSOR, poses, parameters)
        expected = [utility_by_points(bodies, pose, parameters) for pose in poses]
        scale = max(np.abs(expected))
        np.testing.assert_allclose(found, expected, atol=POLYGON_ERROR * scale)
