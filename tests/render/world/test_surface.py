"""Interpolation within surfaces, on hand-made maps."""

import numpy as np

from render.world.surface import SurfaceMap


def flat_map(body, height=0.0):
    """A map of horizontal surfaces seen from above, one body index a pixel."""
    h, w = body.shape
    v, u = np.mgrid[:h, :w]
    position = np.stack([u, v, np.full(body.shape, height)], axis=-1).astype(np.float32)
    normal = np.broadcast_to(np.float32([0, 0, 1]), (h, w, 3)).copy()
    return SurfaceMap(body.astype(np.uint8), position, normal)


def test_linear_field_is_kept():
    """Bilinear interpolation reproduces a linear field exactly between its nodes."""
    fine = flat_map(np.zeros((24, 32)))
    coarse = fine.every(4)
    field = coarse.position[..., 0] * 2 + coarse.position[..., 1]
    out = fine.interpolated(field[None].astype(np.float32), 4)[0]
    expected = fine.position[..., 0] * 2 + fine.position[..., 1]
    inner = np.s_[2:-2, 2:-2]
    np.testing.assert_allclose(out[inner], expected[inner], rtol=1e-5)


def test_no_light_leaks_over_an_edge():
    """Two bodies with different values side by side: each pixel keeps its own body's value."""
    body = np.zeros((16, 32))
    body[:, 15:] = 1
    fine = flat_map(body)
    coarse = fine.every(4)
    out = fine.interpolated(coarse.body[None].astype(np.float32), 4)[0]
    np.testing.assert_allclose(out, body, atol=1e-4)


def test_no_light_leaks_over_a_step():
    """One body, but a step of 50 mm: pixels keep to the points on their own level, up to the thousandth with which the
    others are kept for want of any."""
    fine = flat_map(np.zeros((16, 32)))
    fine.position[:, 18:, 2] = 0.05
    coarse = fine.every(4)
    out = fine.interpolated(coarse.position[None, ..., 2].copy(), 4)[0]
    np.testing.assert_allclose(out, fine.position[..., 2], atol=0.003 * 0.05 * 1.01)
