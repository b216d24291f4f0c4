"""Interpolation within surfaces, on hand-made maps."""

import numpy as np

from render.world.interpolation import interpolated
from render.world.surface import SurfaceMap


def flat_map(body, height=0.0):
    """A map of horizontal surfaces seen from above, one body index a pixel."""
    h, w = body.shape
    v, u = np.mgrid[:h, :w]
    position = np.stack([u, v, np.full(body.shape, height)], axis=-1).astype(np.float32)
    normal = np.broadcast_to(np.float32([0, 0, 1]), (h, w, 3)).copy()
    return SurfaceMap(body.astype(np.uint8), position, normal)


def recorded(field, asked):
    """`values_at` that looks values up by position, and notes for how many points it was asked."""

    def values_at(points, stride):
        asked.append(points.body.size)
        return field(points.position).astype(np.float32)

    return values_at


def nothing_beside(fine):
    return np.zeros((1, *fine.body.shape), np.float32)


def everywhere(fine):
    return np.ones(fine.body.shape, bool)


def test_linear_field_is_kept():
    """Bilinear interpolation reproduces a linear field exactly between its nodes."""
    fine = flat_map(np.zeros((24, 32)))

    def plane(position):
        return (position[..., 0] * 2 + position[..., 1])[0][None]

    out = interpolated(fine, everywhere(fine), [(4, np.inf)], recorded(plane, []), nothing_beside(fine))[0]
    expected = fine.position[..., 0] * 2 + fine.position[..., 1]
    inner = np.s_[2:-2, 2:-2]
    np.testing.assert_allclose(out[inner], expected[inner], rtol=1e-5)


def test_no_light_leaks_over_an_edge_and_small_bodies_have_points_of_their_own():
    """Two bodies side by side and a third of 2 x 2 pixels that no node of the grid meets: each pixel has its own body's
    value exactly, and finer grids are asked for few points."""
    body = np.zeros((48, 96))
    body[:, 47:], body[4:6, 4:6] = 1, 2
    fine = flat_map(body)
    at = {tuple(p): b for p, b in zip(fine.position.reshape(-1, 3), body.ravel(), strict=True)}
    asked = []

    def value_of_body(position):
        return np.array([[10.0 ** at[tuple(p)] for p in position[0]]])

    grids = [(8, np.inf), (4, np.inf), (1, np.inf)]
    out = interpolated(fine, everywhere(fine), grids, recorded(value_of_body, asked), nothing_beside(fine))[0]
    np.testing.assert_allclose(out, 10.0**body, rtol=1e-6)
    assert len(asked) == 3
    assert asked[2] < 0.02 * body.size


def test_no_light_leaks_over_a_step():
    """One body, but a step of 50 mm: pixels keep to the points on their own level."""
    fine = flat_map(np.zeros((16, 32)))
    fine.position[:, 18:, 2] = 0.05

    def height(position):
        return position[..., 2]

    grids = [(4, np.inf), (1, np.inf)]
    out = interpolated(fine, everywhere(fine), grids, recorded(height, []), nothing_beside(fine))[0]
    np.testing.assert_allclose(out, fine.position[..., 2], atol=1e-7)


def test_steep_light_is_asked_on_a_finer_grid_unless_there_is_more_beside_it():
    """A ramp of 1 to 9 over 32 pixels differs by more than a tenth within 8 pixels: the finer grid is asked; with
    hundred times as much light beside it that does not matter."""
    fine = flat_map(np.zeros((16, 32)))

    def ramp(position):
        return 1 + position[..., 0] / 4

    for beside, grids_asked in ((0.0, 2), (900.0, 1)):
        asked = []
        there = np.full((1, 16, 32), beside, np.float32)
        interpolated(fine, everywhere(fine), [(8, 0.1), (2, np.inf)], recorded(ramp, asked), there)
        assert len(asked) == grids_asked


def test_what_is_not_wanted_stays_dark_and_costs_nothing():
    """0 there, and no point is asked for."""
    fine = flat_map(np.zeros((16, 32)))
    asked = []
    out = interpolated(
        fine, ~everywhere(fine), [(4, np.inf)], recorded(lambda p: p[..., 0], asked), nothing_beside(fine)
    )
    assert not out.any()
    assert not asked


def test_even_pixels_lie_on_one_plane_of_one_body():
    """Not beside another body, nor beside a step of a millimetre, nor at the image's border."""
    body = np.zeros((9, 30))
    body[:, 10:] = 1
    fine = flat_map(body)
    fine.position[:, 20:, 2] = 1e-3
    expected = np.zeros(body.shape, bool)
    for columns in (slice(1, 9), slice(11, 19), slice(21, 29)):
        expected[1:-1, columns] = True
    assert np.array_equal(fine.even, expected)
