"""Area of a projected box: pinhole geometry by hand, hulls and clips by hand, and points of the box by the thousand."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics, look_at, project
from franbv.geometry.oriented_box import OrientedBox, oriented_box
from franbv.geometry.projected_box import clipped_polygon, convex_hull, polygon_area, projected_box_area

SENSOR = Intrinsics(60, 40, 40.0, 40.0, 29.5, 19.5)
IDENTITY = RigidTransform.identity()


def box(centre, half) -> OrientedBox:
    """Axis-aligned box."""
    return OrientedBox(np.array(centre, float), np.eye(3), np.array(half, float))


def test_face_towards_the_camera():
    """A cube of side 4 cm, its near face 20 cm away: that face hides the rest, (40 * 0.04 / 0.2)^2 = 64 px^2."""
    assert projected_box_area(box([0, 0, 0.22], [0.02, 0.02, 0.02]), SENSOR, IDENTITY) == pytest.approx(64.0)


def test_box_beside_the_axis_shows_two_faces():
    """x from 0.1 to 0.14, z from 0.2 to 0.4: the near face spans u = 20 to 28, the far edge of the left side is at 10.

    The hull has corners (10, +-2), (20, +-4), (28, +-4): a trapezium of 10 (4 + 8) / 2 and a rectangle of 8 x 8 px.
    """
    slab = box([0.12, 0, 0.3], [0.02, 0.02, 0.1])
    assert projected_box_area(slab, SENSOR, IDENTITY) == pytest.approx(60.0 + 64.0)


def test_clipped_by_the_image():
    """Centred on the right edge of the image half of the 8 x 8 px remains; the whole image is the most there can be."""
    edge = (59.5 - 29.5) / 40.0 * 0.2
    assert projected_box_area(box([edge, 0, 0.2], [0.02, 0.02, 1e-9]), SENSOR, IDENTITY) == pytest.approx(32.0)
    assert projected_box_area(box([0, 0, 0.2], [1.0, 1.0, 0.01]), SENSOR, IDENTITY) == pytest.approx(2400.0)
    assert projected_box_area(box([1.0, 0, 0.2], [0.02, 0.02, 0.01]), SENSOR, IDENTITY) == 0.0


def test_behind_and_around_the_camera():
    """Behind it a box has no area; around it, or right before its whole plane, it fills the image.

    A wall along the right of the axis, x from 0.1 on, from behind the camera to z = 0.4, begins at u = 10 px + cx
    where it ends and covers everything to its right; above and below it ends at v = +-y/z f: y = 10 m covers all.
    """
    assert projected_box_area(box([0, 0, -0.2], [0.1, 0.1, 0.1]), SENSOR, IDENTITY) == 0.0
    assert projected_box_area(box([0, 0, 0], [0.1, 0.1, 0.1]), SENSOR, IDENTITY) == pytest.approx(2400.0)
    wall = box([1.1, 0, 0], [1.0, 10.0, 0.4])
    assert projected_box_area(wall, SENSOR, IDENTITY) == pytest.approx((30.0 - 10.0) * 40.0)


@pytest.mark.parametrize("seed", range(4))
def test_turned_box_against_its_points(seed):
    """The hull of a thousand projected points of a turned box, its corners among them, unclipped."""
    rng = np.random.default_rng(seed)
    region = oriented_box(rng.normal(size=(30, 3)) * [0.02, 0.01, 0.005])
    T = look_at(rng.normal(size=3) * 0.05 + np.array([0.0, -0.3, 0.2]), np.zeros(3))
    inside = region.centre + (rng.uniform(-1, 1, (1000, 3)) * region.half_extents) @ region.axes.T
    wide = Intrinsics(2000, 2000, 300.0, 300.0, 1000.0, 1000.0)
    hull = ConvexHull(project(T.inv().apply(np.concatenate([inside, region.corners()])), wide))
    assert projected_box_area(region, wide, T) == pytest.approx(hull.volume, rel=1e-9)


def test_convex_hull_by_hand():
    """A square with points inside, on its edges and twice: four vertices; two points span no area."""
    points = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 1], [1, 0], [2, 2], [0, 1]], float)
    hull = convex_hull(points)
    assert {tuple(vertex) for vertex in hull.tolist()} == {(0, 0), (2, 0), (2, 2), (0, 2)}
    assert len(hull) == 4
    assert polygon_area(hull) == 4.0
    assert polygon_area(convex_hull(np.array([[0.0, 0], [3, 4]]))) == 0.0
    assert polygon_area(convex_hull(np.zeros((0, 2)))) == 0.0


@pytest.mark.parametrize("reverse", [False, True])
def test_clipped_polygon_by_hand(reverse):
    """A diamond of half diagonal 4 px about the upper left corner keeps its quarter in the image, in either sense."""
    diamond = np.array([[4, 0], [0, 4], [-4, 0], [0, -4]], float) - 0.5
    diamond = diamond[::-1] if reverse else diamond
    assert polygon_area(clipped_polygon(diamond, SENSOR)) == pytest.approx(8.0)
