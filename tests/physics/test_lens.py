"""Laws of lens and rectification: energy, width of the blur, natural vignetting, mixing of neighbours."""

import numpy as np
import pytest

from render.imager.lens import blur_sigma_px, mix_neighbours, through_lens, vignetting
from render.imager.settings import ImagerSettings


@pytest.mark.parametrize("width", [640, 1280])
def test_point_spread(width):
    """A point keeps its energy; its variance is the lens's (2.25 um) plus 1/6 px^2 of bilinear rectification."""
    settings = ImagerSettings(vignetting_exponent=0.0, veiling_glare=0.0)
    point = np.zeros((41, width), np.float32)
    point[20, 100] = 1000.0
    spread = through_lens(point, settings)
    assert spread.sum() == pytest.approx(1000, rel=1e-5)
    u = np.arange(width) - 100
    variance = float((spread.sum(axis=0) * u**2).sum() / spread.sum())
    expected = (2.25 / (3.0 * 1280 / width)) ** 2 + 1 / 6
    assert variance == pytest.approx(expected, rel=0.02)
    assert blur_sigma_px(width, settings) ** 2 == pytest.approx(expected)


def test_vignetting_is_cosine_to_the_fourth():
    """321 px off the axis at 640 x 360 the field angle is 45 deg: cos^4 = 1/4; on the axis nothing is lost."""
    share = vignetting(361, 643, 4.0)
    assert share[180, 321] == 1.0
    assert share[180, 321 - 321] == pytest.approx(0.25, abs=0.003)
    np.testing.assert_allclose(share, share[::-1, ::-1], rtol=1e-6)


def test_flat_light_stays_flat_up_to_vignetting():
    """Blur of a constant is the constant, edges included."""
    flat = np.full((90, 160), 3.0, np.float32)
    settings = ImagerSettings(veiling_glare=0.0)
    np.testing.assert_allclose(through_lens(flat, settings), 3.0 * vignetting(90, 160, 4.0), rtol=1e-5)


def test_mixed_neighbours():
    """White noise keeps its mean and 4/9 of its variance, the average of bilinear interpolation over even phases.

    The average is taken here by interpolating with random phases.
    """
    rng = np.random.default_rng(0)
    white = rng.normal(5.0, 1.0, (401, 801)).astype(np.float32)
    mixed = mix_neighbours(white)
    t, s = rng.random((2, 400, 800))
    rows = (1 - s) * white[:-1, :-1] + s * white[1:, :-1]
    below = (1 - s) * white[:-1, 1:] + s * white[1:, 1:]
    interpolated = (1 - t) * rows + t * below
    assert mixed.mean() == pytest.approx(5.0, abs=0.01)
    assert mixed.var() == pytest.approx(4 / 9, rel=0.02)
    assert mixed.var() == pytest.approx(interpolated.var(), rel=0.02)
