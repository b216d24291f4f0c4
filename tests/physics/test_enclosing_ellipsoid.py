"""Smallest enclosing ellipsoids against closed forms and against a general-purpose convex solver."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from franbv.geometry.enclosing_ellipsoid import enclosing_ellipsoids

TOLERANCE = 0.01
CUBE = np.array(list(product([-0.5, 0.5], repeat=3)))


def one(points, tolerance=TOLERANCE):
    """Centre and shape around a single set."""
    centres, shapes = enclosing_ellipsoids(points, np.zeros(len(points), int), tolerance)
    return centres[0], shapes[0]


def volume(shape):
    """4/3 pi a b c."""
    return 4.0 / 3.0 * np.pi * np.sqrt(np.linalg.det(shape))


def reach(points, centre, shape):
    """(x - c)^T S^-1 (x - c) of every point."""
    offset = points - centre
    return np.einsum("ni,ij,nj->n", offset, np.linalg.inv(shape), offset)


def smallest_volume(points):
    """By sequential quadratic programming: least -ln det A with |A x - b| <= 1 for all points, A lower triangular."""
    lower = np.tril_indices(3)

    def unpack(p):
        A = np.zeros((3, 3))
        A[lower] = p[:6]
        return A, p[6:]

    def slack(p):
        A, b = unpack(p)
        return 1.0 - np.sum((points @ A.T - b) ** 2, axis=1)

    start = np.zeros(9)
    radius = np.linalg.norm(points - points.mean(axis=0), axis=1).max()
    start[[0, 2, 5]] = 1.0 / radius
    start[6:] = points.mean(axis=0) / radius
    best = minimize(
        lambda p: -np.sum(np.log(np.abs(np.diag(unpack(p)[0])))),
        start,
        constraints={"type": "ineq", "fun": slack},
        method="SLSQP",
        options={"maxiter": 500, "ftol": 1e-10},
    )
    assert best.success
    assert slack(best.x).min() > -1e-7
    return 4.0 / 3.0 * np.pi * np.exp(best.fun)


def test_cube_has_its_circumscribed_sphere():
    """A cube of side 1: the sphere of radius sqrt(3)/2 about its centre."""
    centre, shape = one(CUBE + np.array([3.0, -2.0, 5.0]))
    np.testing.assert_allclose(centre, [3.0, -2.0, 5.0], atol=1e-9)
    np.testing.assert_allclose(shape, 0.75 * np.eye(3), rtol=TOLERANCE, atol=1e-9)


def test_turned_box_has_semi_axes_sqrt3_times_its_half_sides():
    """Smallest ellipsoids go along with affine maps: a box is the image of a cube. Sides 1 mm to 1 m."""
    half = np.array([0.5, 0.02, 0.0005])
    turn = Rotation.from_euler("xyz", [0.3, -0.8, 1.9]).as_matrix()
    centre, shape = one((2.0 * CUBE * half) @ turn.T + [0.1, 0.2, 0.3])
    np.testing.assert_allclose(centre, [0.1, 0.2, 0.3], atol=1e-9)
    np.testing.assert_allclose(np.sort(np.sqrt(np.linalg.eigvalsh(shape)))[::-1], np.sqrt(3.0) * half, rtol=TOLERANCE)


def test_regular_simplex_has_its_circumscribed_sphere():
    """Four alternate corners of the cube: the same sphere; no weight can be spared."""
    simplex = CUBE[np.prod(CUBE, axis=1) > 0]
    assert len(simplex) == 4
    np.testing.assert_allclose(one(simplex)[1], 0.75 * np.eye(3), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("n", [5, 12, 60])
def test_random_points_agree_with_a_convex_solver(seed, n):
    """Every point is inside, at least one on the surface, and the volume is within 1 % of the solver's."""
    rng = np.random.default_rng([seed, n])
    points = rng.normal(size=(n, 3)) @ rng.normal(size=(3, 3)) + rng.normal(size=3)
    centre, shape = one(points)
    assert reach(points, centre, shape).max() == pytest.approx(1.0, abs=1e-9)
    ratio = volume(shape) / smallest_volume(points)
    assert 1.0 - 1e-5 <= ratio <= 1.0 + TOLERANCE + 1e-5


def test_tighter_tolerance_gives_a_tighter_ellipsoid():
    """The proven bound is on the volume: at 1e-6 the solver's volume is met to 1e-5."""
    points = np.random.default_rng(3).normal(size=(40, 3))
    assert volume(one(points, 1e-6)[1]) == pytest.approx(smallest_volume(points), rel=1e-5)


def test_no_brute_force_change_makes_it_smaller():
    """Nudging centre and shape at random, then growing to hold all points, never wins more than the tolerance."""
    rng = np.random.default_rng(8)
    points = rng.uniform(size=(30, 3)) * [4.0, 2.0, 1.0]
    centre, shape = one(points)
    for size in (0.3, 0.1, 0.03, 0.01):
        for _ in range(300):
            warp = np.eye(3) + size * rng.normal(size=(3, 3))
            other = warp @ shape @ warp.T
            grown = other * reach(points, centre + size * rng.normal(size=3), other).max()
            assert volume(grown) >= volume(shape) / (1.0 + TOLERANCE)


def test_many_sets_at_once_are_as_each_alone():
    """Sets of unequal size are filled up with copies of one point; that changes nothing. Labels need no order."""
    rng = np.random.default_rng(9)
    labels = rng.permutation(np.repeat(np.arange(5), [4, 9, 30, 8, 100]))
    points = rng.normal(size=(len(labels), 3)) * [1.0, 3.0, 0.2] + 10.0 * labels[:, None]
    centres, shapes = enclosing_ellipsoids(points, labels, 1e-7)
    for k in range(5):
        centre, shape = one(points[labels == k], 1e-7)
        np.testing.assert_allclose(centres[k], centre, atol=1e-3)
        assert volume(shapes[k]) == pytest.approx(volume(shape), rel=1e-6)
        assert reach(points[labels == k], centres[k], shapes[k]).max() == pytest.approx(1.0, abs=1e-9)


def test_only_the_hull_matters():
    """Adding points inside the hull leaves the volume within the tolerance."""
    rng = np.random.default_rng(10)
    points = rng.normal(size=(200, 3))
    outer = points[ConvexHull(points).vertices]
    assert volume(one(outer, 1e-6)[1]) == pytest.approx(volume(one(points, 1e-6)[1]), rel=1e-5)


def test_start_in_a_plane_is_left():
    """The outermost points along the 13 start directions may lie in a plane while the set does not."""
    square = np.array([[x, y, 0.37 * x + 0.21 * y] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    points = np.concatenate([square, [[0.0, 0.0, 0.1]]])
    centre, shape = one(points)
    assert reach(points, centre, shape).max() == pytest.approx(1.0, abs=1e-9)
    assert volume(shape) == pytest.approx(smallest_volume(points), rel=0.011)


@pytest.mark.parametrize("points", [CUBE * [1.0, 1.0, 0.0], CUBE * 0.0, CUBE[:3]], ids=["square", "point", "triangle"])
def test_flat_sets_are_refused(points):
    """Points in a plane have enclosing ellipsoids as small as one likes; the caller must give them thickness."""
    with pytest.raises(ValueError, match="lie in a plane"):
        one(points)


def test_no_sets():
    """No points, no ellipsoids."""
    centres, shapes = enclosing_ellipsoids(np.zeros((0, 3)), np.zeros(0, int), TOLERANCE)
    assert centres.shape == (0, 3)
    assert shapes.shape == (0, 3, 3)
