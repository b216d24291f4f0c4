"""StereoSGBM behind the matcher interface: known disparities, the left band, windows and ranges."""

import numpy as np
import pytest

from render.matcher.interface import Window
from render.matcher.sgbm import SgbmMatcher
from tests.render.matcher.stereo_pairs import warped_pair

SUBPIXEL_PX = 0.25
"""A V- or parabola-locked matcher errs by at most a quarter pixel."""


@pytest.mark.parametrize("shift", [3.0, 20.25, 60.5])
def test_constant_shift_is_found(shift):
    """A texture shifted by a known amount has that disparity everywhere that has a partner."""
    left, right = warped_pair(np.full((80, 240), shift), seed=1)
    disparity = SgbmMatcher().match(left, right)
    inner = disparity[10:-10, int(shift) + 10 : -10]
    assert np.mean(inner > 0) > 0.98
    assert np.median(np.abs(inner[inner > 0] - shift)) < SUBPIXEL_PX


def test_left_band_is_invalid():
    """Left pixels u < d look beyond the right image's edge: no disparity, the f B / Z band of a real camera."""
    left, right = warped_pair(np.full((80, 240), 50.0), seed=2)
    disparity = SgbmMatcher().match(left, right)
    assert not np.any(disparity > np.arange(240) + 1)
    assert np.mean(np.abs(disparity[:, :45] - 50) < 1) == 0


def test_blank_pair_has_no_depth():
    """An image of pure noise of 0.5 DN carries no texture, so nothing may be measured."""
    noise = np.random.default_rng(3).normal(60, 0.5, size=(2, 80, 240))
    left, right = np.rint(noise).astype(np.uint8)
    assert not SgbmMatcher().match(left, right).any()


def test_window_is_full_size_and_zero_outside():
    """A window restricts the result and changes it little: the margins hold what its pixels need."""
    left, right = warped_pair(np.full((120, 320), 21.5), seed=4)
    window = Window(100, 40, 120, 50)
    whole, part = SgbmMatcher().match(left, right), SgbmMatcher().match(left, right, window)
    assert part.shape == whole.shape
    inside = np.zeros(part.shape, bool)
    inside[window.slices] = True
    assert not part[~inside].any()
    assert np.mean(np.abs(part - whole)[inside] <= SUBPIXEL_PX) > 0.98


def test_range_is_respected_and_burst_equals_single_frames():
    """Only min .. min + n - 1 is searched, and frames do not influence each other."""
    pairs = [warped_pair(np.full((80, 240), shift), seed=5) for shift in (12.0, 30.0, 70.0)]
    lefts, rights = (np.stack(images) for images in zip(*pairs, strict=True))
    burst = SgbmMatcher().match_burst(lefts, rights, None, 20, 30)
    assert np.all((burst == 0) | ((burst >= 20) & (burst <= 49)))
    for frame, (left, right) in zip(burst, pairs, strict=True):
        np.testing.assert_array_equal(frame, SgbmMatcher().match(left, right, None, 20, 30))
