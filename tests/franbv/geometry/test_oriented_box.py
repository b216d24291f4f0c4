"""Oriented boxes: closed-form boxes are found back at any turn, and flat, line-like and single points get a volume."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from franbv.geometry.oriented_box import OrientedBox, axis_aligned_box, oriented_box

HALF = np.array([0.03, 0.02, 0.01])


def _turned(points, seed):
    rotation = Rotation.random(rng=seed).as_matrix()
    return points @ rotation.T + [0.1, -0.2, 0.3], rotation


def _corner_points(half):
    return np.stack(np.meshgrid(*([-h, h] for h in half), indexing="ij"), axis=-1).reshape(-1, 3)


@pytest.mark.parametrize("seed", range(5))
def test_box_of_a_turned_cuboid_is_the_cuboid(seed):
    """The corners of a cuboid have the cuboid itself as their smallest box, whatever else lies inside."""
    inside = np.random.default_rng(seed).uniform(-1, 1, (200, 3)) * HALF
    points, rotation = _turned(np.concatenate([_corner_points(HALF), inside]), seed)
    box = oriented_box(points)
    np.testing.assert_allclose(box.half_extents, HALF, atol=1e-9)
    np.testing.assert_allclose(box.centre, [0.1, -0.2, 0.3], atol=1e-9)
    np.testing.assert_allclose(np.abs(box.axes.T @ rotation), np.eye(3), atol=1e-6)
    assert box.volume == pytest.approx(8 * np.prod(HALF))


@pytest.mark.parametrize("seed", range(5))
def test_no_sampled_frame_beats_the_box_by_much(seed):
    """The smallest box is at most a little larger than the best of 4000 random turns, and encloses every point.

    Random turns are an independent search; the flush-face family can miss the optimum, by a few per cent at most.
    """
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(60, 3)) * [3.0, 2.0, 1.0]
    box = oriented_box(points)
    along = points @ Rotation.random(4000, rng=rng).as_matrix()
    sampled = np.prod(along.max(axis=1) - along.min(axis=1), axis=1).min()
    assert box.contains(points).all()
    assert box.volume <= 1.02 * sampled


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("half", "expected"),
    [
        ((0.03, 0.02, 0.0), (0.03, 0.02, 0.004)),
        ((0.03, 0.0, 0.0), (0.03, 0.004, 0.004)),
        ((0.0, 0.0, 0.0), (0.004, 0.004, 0.004)),
        ((0.03, 0.02, 1e-5), (0.03, 0.02, 0.004)),
    ],
)
def test_flat_sets_get_the_minimum_side(half, expected, seed):
    """A sheet, a line, a point and an almost flat sheet keep their sides, and the missing ones become 8 mm."""
    points, _ = _turned(_corner_points(half), seed)
    box = oriented_box(points, minimum_side=0.008)
    np.testing.assert_allclose(box.half_extents, expected, atol=1e-9)
    np.testing.assert_allclose(box.centre, [0.1, -0.2, 0.3], atol=1e-9)
    assert np.linalg.det(box.axes) == pytest.approx(1.0)


def test_three_points_lie_in_their_triangle_s_rectangle():
    """A right triangle's smallest rectangle has its legs as sides: 3 x 4."""
    box = oriented_box(np.array([[0.0, 0, 0], [3, 0, 0], [0, 4, 0]]), minimum_side=1.0)
    np.testing.assert_allclose(box.half_extents, [2.0, 1.5, 0.5], atol=1e-9)


def test_no_points_are_refused():
    """A box around nothing has no meaning; a silent zero box would steer the camera."""
    with pytest.raises(ValueError, match="no points"):
        oriented_box(np.zeros((0, 3)))


def test_growing_contains_and_diagonal():
    """Every face moves outwards by the margin; the half diagonal is that of a 2 x 4 x 4 box grown by 1: |(2, 3, 3)|."""
    box = axis_aligned_box(np.array([-1.0, -2, -2]), np.array([1.0, 2, 2]))
    grown = box.grown(1.0)
    assert grown.half_diagonal == pytest.approx(np.sqrt(4 + 9 + 9))
    probes = np.array([[1.9, 0, 0], [2.1, 0, 0], [0, 2.9, -2.9], [0, 3.1, 0]])
    np.testing.assert_array_equal(grown.contains(probes), [True, False, True, False])
    np.testing.assert_array_equal(box.contains(probes), [False] * 4)


def test_corners_are_all_sign_combinations():
    """The eight corners of a turned box, back in its own axes, are all (+-a, +-b, +-c)."""
    rotation = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
    box = OrientedBox(np.array([1.0, 2, 3]), rotation, HALF)
    local = (box.corners() - box.centre) @ box.axes
    np.testing.assert_allclose(np.abs(local), np.tile(HALF, (8, 1)))
    assert len(np.unique(np.sign(local), axis=0)) == 8
