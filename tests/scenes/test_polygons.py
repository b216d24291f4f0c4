"""Polygons to triangles: areas from the shoelace formula, whatever the outline."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from materials.input_error import InputError
from scenes.cad.polygons import MAX_CORNERS, triangulated
from scenes.topology import face_normals

RNG = np.random.default_rng(3)


def refused(polygon: int, why: str) -> InputError:
    """The error of a reader."""
    return InputError(f"polygon {polygon}: {why}")


def star(corners: int) -> np.ndarray:
    """A random polygon that does not cross itself: corners at rising angles round the origin (n, 2)."""
    angles = np.sort(RNG.uniform(0, 2 * np.pi, corners))
    radii = RNG.uniform(0.2, 1.0, corners)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])


def comb(teeth: int) -> np.ndarray:
    """Teeth 1 wide and 5 long on a back 1 high, gaps of 1 between them: teeth * 5 + (2 teeth - 1) in area."""
    tops = [point for i in range(teeth) for point in ((2 * i, 0), (2 * i, 5), (2 * i + 1, 5), (2 * i + 1, 0))]
    return np.array([*tops, (2 * teeth - 1, -1), (0, -1)], float)[::-1]


def spiral(turns: int) -> np.ndarray:
    """A wall of one turn after another, its outer side out and its inner side back."""
    angles = np.linspace(0, 2 * np.pi * turns, 24 * turns)
    radii = 1 + angles / (2 * np.pi)
    out = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    return np.concatenate([out * 1.0, (out * (1 - 0.4 / radii)[:, None])[::-1]])


def shoelace(outline: np.ndarray) -> float:
    """Signed area of a polygon (n, 2)."""
    x, y = outline.T
    return float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2)


def cut(points: np.ndarray) -> np.ndarray:
    """Vector areas of the triangles of one polygon (n, 3)."""
    faces, owners = triangulated(points, np.arange(len(points)), np.array([len(points)]), refused)
    assert set(owners) == {0}
    return face_normals(points, faces) / 2


@pytest.mark.parametrize("outline", [*(star(n) for n in (4, 5, 8, 20, 60)), comb(2), comb(12), spiral(3)])
@pytest.mark.parametrize("first", [0, 1, 3])
def test_triangles_cover_the_outline_once(outline, first):
    """In any plane and from any first corner: n - 2 triangles, none turned over, which sum to the shoelace area."""
    outline = np.roll(outline, first, axis=0)
    turn = Rotation.from_euler("xyz", [0.4, -1.1, 2.0])
    points = turn.apply(np.column_stack([outline, np.full(len(outline), 0.7)]))
    up = turn.apply([0, 0, 1])
    areas = cut(points) @ up
    assert len(areas) == len(outline) - 2
    assert areas.min() >= -1e-12
    assert areas.sum() == pytest.approx(abs(shoelace(outline)), rel=1e-9) or shoelace(outline) < 0


def test_the_comb_has_its_area():
    """Closed form, beside the shoelace formula."""
    assert shoelace(comb(12)) == pytest.approx(12 * 5 + 23)
    assert cut(np.column_stack([comb(12), np.zeros(50)])).sum(axis=0)[2] == pytest.approx(83)


def test_a_bent_polygon_keeps_its_projected_area():
    """An L whose corners stand up to 0.3 high: seen from above it still has 3."""
    outline = np.array([(2, 1), (1, 1), (1, 2), (0, 2), (0, 0), (2, 0)], float)
    points = np.column_stack([outline, [0.0, 0.3, 0.1, 0.0, 0.2, 0.0]])
    areas = cut(points)[:, 2]
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(3.0)


def test_the_polygons_stay_in_their_order():
    """Triangles, quadrilaterals and more, mixed: owners rise, each polygon has its corners less two."""
    points = np.column_stack([RNG.random((40, 2)), np.zeros(40)])
    square = [0, 1, 2, 3]
    points[square] = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    corners = np.array([*square, 4, 5, 6, *square, 7, 8, 9, 0, 1, 2])
    faces, owners = triangulated(points, corners, np.array([4, 3, 4, 3, 3]), refused)
    assert owners.tolist() == [0, 0, 1, 2, 2, 3, 4]
    assert faces[2].tolist() == [4, 5, 6]


def test_what_has_no_inside_is_refused():
    """A bow tie covers one half the other way round; a star with crossing arms folds over itself."""
    bow_tie = np.array([(0, 0, 0), (10, 0, 0), (0, 10, 0), (12, 10, 0)], float)
    with pytest.raises(InputError, match="crosses"):
        cut(bow_tie)


def test_what_has_no_area_does_no_harm():
    """All corners on one line: triangles without area, which are dropped later."""
    line = np.column_stack([np.arange(5.0), np.zeros(5), np.zeros(5)])
    np.testing.assert_array_equal(cut(line), np.zeros((3, 3)))


def test_a_huge_polygon_is_taken_if_convex_and_refused_if_not():
    """A round cap of any number of corners is a fan; a concave one would take minutes."""
    angles = np.linspace(0, 2 * np.pi, MAX_CORNERS + 2, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    assert cut(circle).sum(axis=0)[2] == pytest.approx(np.pi, rel=1e-6)
    circle[1::2] *= 0.9
    with pytest.raises(InputError, match=f"more than {MAX_CORNERS} corners"):
        cut(circle)
