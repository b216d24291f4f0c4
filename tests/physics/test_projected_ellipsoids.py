"""Projected ellipsoids against spheres in closed form, projected surface points, and brute force along rays."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull, HalfspaceIntersection
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.ellipsoids import Ellipsoids
from franbv.frames import Intrinsics, look_at, project
from franbv.geometry.ray_hits import first_hit_depths, ray_hits
from franbv.projection import (
    dual_conics,
    ellipse_areas_in_image,
    ellipses,
    in_camera_frame,
    projected_areas,
    silhouette,
)

SENSOR = Intrinsics(60, 40, 40.125, 40.125, 29.5, 19.5)
WIDE = Intrinsics(4000, 3000, 300.0, 350.0, 1900.0, 1500.0)
"""A window that clips nothing, with unequal focal lengths."""
IDENTITY = RigidTransform.identity()
DISCRETE = 2e-4
"""Relative deficit of the hull of 300 x 600 surface points: the square of half their angular spacing."""


def ellipsoid(centre, axes, turn=(0.0, 0.0, 0.0), is_frontier=False) -> Ellipsoids:
    """One ellipsoid by its semi-axes [m] and Euler angles [rad]."""
    R = Rotation.from_euler("xyz", turn).as_matrix()
    shape = R @ np.diag(np.square(axes)) @ R.T
    return Ellipsoids(np.array([centre], float), shape[None], np.array([is_frontier]))


def surface(ellipsoids: Ellipsoids, k: int = 0) -> np.ndarray:
    """Points on a fine grid over the surface, world frame."""
    polar, azimuth = np.meshgrid(np.linspace(0, np.pi, 300), np.linspace(0, 2 * np.pi, 600))
    unit = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], -1)
    return ellipsoids.centres[k] + unit.reshape(-1, 3) @ np.linalg.cholesky(ellipsoids.shapes[k]).T


def outline(ellipsoids: Ellipsoids, intrinsics: Intrinsics, T_world_cam: RigidTransform) -> ConvexHull:
    """Convex hull of the projected surface points."""
    return ConvexHull(project(T_world_cam.inv().apply(surface(ellipsoids)), intrinsics))


def clipped_area(hull: ConvexHull, rng: np.random.Generator) -> float:
    """Area of the hull within the sensor's image, as an intersection of half-planes."""
    image = np.array([[-1, 0, -0.5], [0, -1, -0.5], [1, 0, -59.5], [0, 1, -39.5]], float)
    planes = np.concatenate([hull.equations, image])
    inside = rng.uniform([-0.5, -0.5], [59.5, 39.5], size=(2000, 2))
    inside = inside[np.all(planes[:, :2] @ inside.T + planes[:, 2:] < 0, axis=0)]
    return ConvexHull(HalfspaceIntersection(planes, inside.mean(axis=0)).intersections).volume


@pytest.mark.parametrize("distance", [0.05, 0.2, 1.0])
def test_sphere_on_the_axis_is_a_circle(distance):
    """Radius r at distance D: tangent cone of half angle asin(r/D), so a circle of f r / sqrt(D^2 - r^2) px."""
    r = 0.03
    radius = r / np.sqrt(distance**2 - r**2)
    area = projected_areas(ellipsoid([0, 0, distance], [r, r, r]), WIDE, IDENTITY)[0]
    assert area == pytest.approx(np.pi * WIDE.fx * WIDE.fy * radius**2, rel=1e-9)


def test_sphere_off_the_axis_is_an_ellipse():
    """A cone of half angle a at an angle t to the axis cuts the image in an ellipse with
    f sin a cos a / (cos^2 t - sin^2 a) along the radius and f sin a / sqrt(cos^2 t - sin^2 a) across it.
    """
    r, distance, t = 0.05, 0.4, 0.7
    sphere = ellipsoid([distance * np.sin(t), 0, distance * np.cos(t)], [r, r, r])
    square = Intrinsics(4000, 4000, 300.0, 300.0, 2000.0, 2000.0)
    conics = dual_conics(*in_camera_frame(sphere, IDENTITY), square)
    centres, shapes = ellipses(conics)
    a = np.arcsin(r / distance)
    spare = np.cos(t) ** 2 - np.sin(a) ** 2
    np.testing.assert_allclose(
        np.sqrt(np.diag(shapes[0])), 300.0 * np.sin(a) / np.array([spare / np.cos(a), np.sqrt(spare)]), rtol=1e-9
    )
    np.testing.assert_allclose(shapes[0][0, 1], 0.0, atol=1e-6)
    edges = square.cx + 300.0 * np.tan([t - a, t + a])
    np.testing.assert_allclose(centres[0], [edges.mean(), square.cy], rtol=1e-9)


def test_dual_conic_is_the_papers():
    """Eq. (1) to the letter: P = K [R | t], Q of order 4 with x^T Q x = 0 on the surface; equal up to scale.

    Q = [[A, -A c], [-c^T A, c^T A c - 1]] with A = S^-1; Phi is also tangent to what points of the surface project to.
    """
    body = ellipsoid([0.02, -0.03, 0.05], [0.03, 0.05, 0.02], (0.3, 1.0, -0.4))
    T = look_at(np.array([0.2, -0.25, 0.3]), np.array([0.0, 0.02, 0.03]))
    A, c = np.linalg.inv(body.shapes[0]), body.centres[0]
    Q = np.block([[A, -(A @ c)[:, None]], [-(A @ c)[None], c @ A @ c - 1.0]])
    homogeneous = np.column_stack([surface(body), np.ones(300 * 600)])
    np.testing.assert_allclose(np.einsum("ni,ij,nj->n", homogeneous, Q, homogeneous), 0.0, atol=1e-9)
    P = SENSOR.matrix @ T.inv().as_matrix()[:3]
    expected = P @ np.linalg.inv(Q) @ P.T
    ours = dual_conics(*in_camera_frame(body, T), SENSOR)[0]
    np.testing.assert_allclose(ours / ours[2, 2], expected / expected[2, 2], rtol=1e-9)
    Phi = np.linalg.inv(expected / expected[2, 2])
    pixels = np.column_stack([project(T.inv().apply(surface(body)), SENSOR), np.ones(300 * 600)])
    inside = np.einsum("ni,ij,nj->n", pixels, Phi, pixels) * np.sign(Phi[0, 0])
    assert inside.max() <= 1e-9 * np.abs(Phi).max()
    assert inside.max() >= -DISCRETE * np.abs(inside).max()


@pytest.mark.parametrize("seed", range(8))
def test_area_is_pi_a_b_and_that_of_projected_surface_points(seed):
    """Unclipped: the closed form in the image, pi sqrt(det E), and the hull of the projected surface agree."""
    rng = np.random.default_rng(seed)
    body = ellipsoid(rng.uniform(-0.05, 0.05, 3), rng.uniform(0.01, 0.08, 3), rng.uniform(-3, 3, 3))
    T = look_at(rng.normal(size=3) * 0.1 + np.array([0.0, 0.4, 0.2]), rng.uniform(-0.1, 0.1, 3))
    area = projected_areas(body, WIDE, T)[0]
    _, shapes = ellipses(dual_conics(*in_camera_frame(body, T), WIDE))
    assert area == pytest.approx(np.pi * np.sqrt(np.linalg.det(shapes[0])), rel=1e-9)
    assert area == pytest.approx(outline(body, WIDE, T).volume, rel=DISCRETE)


@pytest.mark.parametrize("seed", range(8))
def test_clipped_area_is_that_of_projected_surface_points(seed):
    """Clipped by the image: the hull of the projected surface, cut by the image's four half-planes."""
    rng = np.random.default_rng([seed, 1])
    body = ellipsoid([0.02, 0.01, 0.05], rng.uniform(0.06, 0.15, 3), rng.uniform(-3, 3, 3))
    aside = Rotation.from_euler("xy", [rng.uniform(0.3, 0.5), rng.uniform(-0.6, 0.6)])
    T = look_at(np.array([0.1, 0.35, 0.25]), np.zeros(3)) * RigidTransform.from_rotation(aside)
    hull = outline(body, SENSOR, T)
    expected = clipped_area(hull, rng)
    assert expected < 0.999 * hull.volume
    assert projected_areas(body, SENSOR, T)[0] == pytest.approx(expected, rel=DISCRETE)


def test_clipping_in_closed_form():
    """Half a circle beyond an edge, three quarters beyond a corner, all of it beyond, and the image within it."""
    radius = 6.0
    centres = np.array([[-0.5, 20.0], [59.5, 39.5], [-20.0, 20.0], [29.5, 19.5], [30.0, 39.5 - radius / 2]])
    shapes = np.tile(radius**2 * np.eye(2), (5, 1, 1))
    shapes[3] *= 100.0
    segment = radius**2 * (np.pi / 3 - np.sqrt(3) / 4)  # beyond a chord at half the radius
    full = np.pi * radius**2
    np.testing.assert_allclose(
        ellipse_areas_in_image(centres, shapes, SENSOR), [full / 2, full / 4, 0.0, 2400.0, full - segment], atol=1e-9
    )


def test_turned_ellipse_is_clipped_along_its_own_axes():
    """A slim ellipse at 30 deg across the upper edge, against its midpoint sum over a fine grid of the image.

    Taking the angle of an ellipse for radians where it is in degrees would put the clipped part elsewhere.
    """
    turn = Rotation.from_euler("z", 30, degrees=True).as_matrix()[:2, :2]
    shape = turn @ np.diag([15.0**2, 3.0**2]) @ turn.T
    centre = np.array([20.0, 2.0])
    u, v = np.meshgrid((np.arange(2400) + 0.5) / 40 - 0.5, (np.arange(1600) + 0.5) / 40 - 0.5)
    offset = np.stack([u, v], -1) - centre
    inside = np.einsum("...i,ij,...j->...", offset, np.linalg.inv(shape), offset) <= 1
    area = ellipse_areas_in_image(centre[None], shape[None], SENSOR)[0]
    assert area == pytest.approx(inside.mean() * 2400.0, rel=1e-3)


def brute_force_hits(rays, body: Ellipsoids, k: int = 0) -> np.ndarray:
    """Which rays (camera frame = world frame) have a point in the ellipsoid, by stepping along them."""
    steps = np.linspace(1e-4, 1.5, 3000)
    inverse = np.linalg.inv(np.linalg.cholesky(body.shapes[k]))
    start, along = -inverse @ body.centres[k], rays @ inverse.T
    return np.array([np.any(np.sum((start + steps[:, None] * ray) ** 2, axis=1) <= 1) for ray in along])


@pytest.mark.parametrize(
    ("centre", "axes"),
    [
        ([0.02, 0.01, 0.05], [0.1, 0.1, 0.2]),  # around the camera
        ([0.3, 0.1, 0.05], [0.1, 0.2, 0.3]),  # beside it, reaching behind
        ([-0.2, 0.0, -0.02], [0.15, 0.1, 0.4]),  # centre behind, part in front
        ([0.0, 0.0, -0.5], [0.2, 0.1, 0.3]),  # behind
        ([0.05, -0.02, 0.3], [0.1, 0.02, 0.05]),  # in front
    ],
)
def test_rays_and_areas_around_the_camera(centre, axes):
    """Hits agree with points stepped along each ray; the area is their share of the image where there is no ellipse."""
    body = ellipsoid(centre, axes, (0.2, 0.1, -0.3))
    rays = SENSOR.pixel_directions().reshape(-1, 3)
    expected = brute_force_hits(rays, body)
    np.testing.assert_array_equal(ray_hits(rays, body.centres, body.shapes)[0], expected)
    np.testing.assert_array_equal(np.isfinite(first_hit_depths(rays, body.centres, body.shapes)[0]), expected)
    np.testing.assert_array_equal(silhouette(body, SENSOR, IDENTITY).ravel(), expected)
    # Pixels on the rim count as a whole or not at all: a quarter of a rim as long as the image's is far from biased.
    assert projected_areas(body, SENSOR, IDENTITY)[0] == pytest.approx(expected.sum(), abs=25.0)


def test_within_an_ellipsoid_the_whole_image_is_covered():
    """Area w h, and nothing for one that lies behind."""
    areas = projected_areas(ellipsoid([0, 0, 0.01], [0.1, 0.1, 0.1]), SENSOR, IDENTITY)
    assert areas[0] == 2400.0
    assert projected_areas(ellipsoid([0, 0, -0.2], [0.1, 0.1, 0.1]), SENSOR, IDENTITY)[0] == 0.0


def test_area_changes_little_where_the_ray_count_takes_over():
    """An ellipsoid that all but reaches the camera's plane, just before and behind the switch: no jump."""
    before, behind = (
        projected_areas(ellipsoid([0.15, 0.0, z], [0.1, 0.08, 0.1]), SENSOR, IDENTITY, supersampling=16)[0]
        for z in (0.1015, 0.1005)
    )
    assert before == pytest.approx(behind, rel=0.02)


def test_overlaps_add_and_batches_agree():
    """Each ellipsoid is measured by itself; a batch of poses gives row by row what each pose gives alone."""
    parts = [ellipsoid([0.0, 0.0, 0.02 * k], [0.05, 0.03, 0.02], (0.1 * k, 0, 0)) for k in range(4)]
    bodies = Ellipsoids(*(np.concatenate([getattr(p, n) for p in parts]) for n in ("centres", "shapes", "is_frontier")))
    poses = [look_at(np.array([0.3 * np.cos(a), 0.3 * np.sin(a), 0.2]), np.zeros(3)) for a in range(5)]
    poses.append(look_at(np.array([0.02, 0.0, 0.03]), np.array([0.0, 0.1, 0.0])))  # among them
    batch = projected_areas(bodies, SENSOR, RigidTransform.concatenate(poses))
    assert batch.shape == (6, 4)
    for row, pose in zip(batch, poses, strict=True):
        np.testing.assert_allclose(row, projected_areas(bodies, SENSOR, pose), rtol=1e-9)
        np.testing.assert_allclose(row, [projected_areas(part, SENSOR, pose)[0] for part in parts], rtol=1e-9)


def test_silhouette_of_a_sphere():
    """Pixels whose ray makes less than asin(r/D) with the line to the centre, for a camera anywhere."""
    T = look_at(np.array([0.2, -0.3, 0.25]), np.array([0.03, 0.0, 0.05]))
    centre, r = np.array([0.0, 0.02, 0.04]), 0.05
    rays = T.rotation.apply(SENSOR.pixel_directions().reshape(-1, 3))
    to_centre = centre - T.translation
    cosine = rays @ to_centre / np.linalg.norm(rays, axis=1) / np.linalg.norm(to_centre)
    expected = cosine >= np.sqrt(1 - (r / np.linalg.norm(to_centre)) ** 2)
    np.testing.assert_array_equal(silhouette(ellipsoid(centre, [r, r, r]), SENSOR, T).ravel(), expected)
    assert 50 < expected.sum() < 1000


def test_hit_depths_of_a_sphere():
    """Along the axis a sphere is met at D - r from outside and at D + r from inside; behind the camera never."""
    ray = np.array([[0.0, 0.0, 1.0]])
    for distance, depth in ((0.3, 0.25), (0.02, 0.07), (-0.02, 0.03), (-0.3, np.inf)):
        sphere = ellipsoid([0, 0, distance], [0.05, 0.05, 0.05])
        np.testing.assert_allclose(first_hit_depths(ray, sphere.centres, sphere.shapes), [[depth]])


def test_hit_points_lie_on_the_surface():
    """(x - c)^T S^-1 (x - c) = 1 at the hit, and no point of the ray before it is inside."""
    rng = np.random.default_rng(4)
    body = ellipsoid([0.02, -0.01, 0.3], [0.08, 0.03, 0.05], (0.4, -0.2, 0.9))
    rays = np.column_stack([rng.uniform(-0.2, 0.2, (200, 2)), np.ones(200)])
    depth = first_hit_depths(rays, body.centres, body.shapes)[0]
    hit = np.isfinite(depth)
    assert 20 < hit.sum() < 200
    for share, at_most in ((1.0, 1e-9), (0.99, None)):
        offset = rays[hit] * depth[hit, None] * share - body.centres[0]
        value = np.einsum("ni,ij,nj->n", offset, np.linalg.inv(body.shapes[0]), offset)
        if at_most is None:
            assert np.all(value > 1)
        else:
            np.testing.assert_allclose(value, 1.0, atol=at_most)
