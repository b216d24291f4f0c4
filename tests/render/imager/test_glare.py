"""Veiling glare against ISO 9358's black square, and its energy."""

import numpy as np
import pytest

from render.imager.glare import with_glare
from render.imager.settings import ImagerSettings

SETTINGS = ImagerSettings(veiling_glare=0.03)
PITCH = {1280: 3e-6, 640: 6e-6}
"""Of a pixel on the chip [m], by the stream's width."""


@pytest.mark.parametrize(("width", "side"), [(1280, 48), (1280, 160), (640, 80)])
def test_black_square_in_a_white_surround(width, side):
    """The integral method of ISO 9358: what the middle of a black square gets of the surround, in units of it, is the
    share of the light that goes astray farther than the square. Of 1 / (2 pi b^2) (1 + r^2 / b^2)^(-3/2) a square of
    half side a holds the solid angle 4 asin(a^2 / (a^2 + b^2)) that it has from height b, over 2 pi.

    The surround ends at the image's border; beyond it lies its mirror image with further squares, each a sixtieth of
    the surround at most: 3 % of the result are left for them and for the blocks.
    """
    height = width * 9 // 16
    image = np.ones((height, width), np.float32)
    top, left = (height - side) // 2, (width - side) // 2
    image[top : top + side, left : left + side] = 0
    seen = with_glare(image, SETTINGS)[height // 2 - 1 : height // 2 + 1, width // 2 - 1 : width // 2 + 1].mean()
    a, b = side / 2 * PITCH[width], 500e-6
    assert seen == pytest.approx(0.03 * (1 - 2 / np.pi * np.arcsin(a**2 / (a**2 + b**2))), rel=0.03)


def test_index_is_that_of_a_small_square():
    """Of a square that is small beside the stray light's width the index itself is left, to the light within the
    square."""
    image = np.ones((720, 1280), np.float32)
    image[356:364, 636:644] = 0
    assert with_glare(image, SETTINGS)[360, 640] == pytest.approx(0.03, rel=0.01)


@pytest.mark.parametrize("shape", [(360, 640), (270, 480), (240, 424), (480, 848), (41, 640), (7, 13)])
def test_energy_stays(shape):
    """As much light comes in over the border as goes out, in every stream and also where sides have no divisors."""
    image = np.random.default_rng(1).gamma(0.5, 2.0, shape).astype(np.float32)
    image[0, 0] = 1000.0  # stray light of a corner is the likeliest to be lost
    assert with_glare(image, SETTINGS).sum(dtype=float) == pytest.approx(image.sum(dtype=float), rel=2e-5)
    flat = np.full(shape, 2.0, np.float32)
    np.testing.assert_allclose(with_glare(flat, SETTINGS), flat, rtol=1e-5)


def test_no_share_no_change():
    """Without glare the image is the same."""
    image = np.random.default_rng(2).random((36, 64)).astype(np.float32)
    np.testing.assert_array_equal(with_glare(image, ImagerSettings(veiling_glare=0.0)), image)


def test_falls_off_with_distance_as_stated():
    """A bright block's stray light at distances of 1, 2 and 3 b, many blocks away from it, is that of the formula."""
    image = np.zeros((720, 1280), np.float32)
    image[352:368, 632:648] = 1.0
    b = 500e-6 / 3e-6
    veil = with_glare(image, SETTINGS)
    for times in (1.0, 1.5):
        r = times * b
        expected = 0.03 * 256 / (2 * np.pi * b**2) * (1 + times**2) ** -1.5
        mirrored = (
            0.03
            * 256
            / (2 * np.pi * b**2)
            * sum(
                (1 + ((640 + sx * 1280 - 640 - r) ** 2 + (sy * 720) ** 2) / b**2) ** -1.5
                for sx in range(-40, 41)
                for sy in range(-40, 41)
                if (sx, sy) != (0, 0)
            )
        )
        assert veil[360, 640 + round(r)] == pytest.approx(expected + mirrored, rel=0.03)
