"""The D4-like matcher: against a slow reading of the recipe, against known disparities, windows, ranges, bursts."""

from dataclasses import replace

import numpy as np
import pytest

from render.matcher.d4.decision import mean_of_surface, select, with_support
from render.matcher.d4.matcher import D4Matcher, gather
from render.matcher.d4.settings import PROTOTYPE, D4Settings
from render.matcher.interface import Window
from tests.render.matcher.d4_reference import match_reference
from tests.render.matcher.stereo_pairs import warped_pair

STEP = 1 / 32
"""Disparity step of the chip and of the matcher [px]."""
N = 126
"""Disparities searched: the chip's, so that one kernel serves all tests."""


def stepped_pair(h: int, w: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A tilted ground with a nearer square on it, a blank patch, and noise of 0.5 DN: every test has work."""
    rows, columns = np.mgrid[:h, :w]
    disparity = 7 + 0.03 * rows + 0.01 * columns
    disparity[h // 4 : 3 * h // 4, w // 2 : 3 * w // 4] = 17.3
    pair = np.stack(warped_pair(disparity, seed)).astype(float)
    pair[:, : h // 3, : w // 3] = 90
    noise = np.random.default_rng(seed).normal(0, 0.5, pair.shape)
    left, right = np.clip(np.rint(pair + noise), 0, 255).astype(np.uint8)
    return left, right


@pytest.mark.parametrize(
    "settings", [D4Settings(), replace(PROTOTYPE, subpixel="totals")], ids=["default", "prototype"]
)
def test_streaming_equals_whole_volumes(settings):
    """16-bit streaming and a float64 reading of the recipe in plain numpy find the same disparities and holes.

    Only the streamed ones are rounded to 1/32 px; integer costs turn a few ties. Both see the pixels before the
    neighbour count, which is checked on its own.
    """
    left, right = stepped_pair(48, 96, seed=1)
    reference = match_reference(left, right, N, settings)
    found = select(gather(left, right, 0, N, settings), N, settings) * STEP
    holes, reference_holes = found == 0, reference == 0
    assert 0.1 < reference_holes.mean() < 0.9
    assert np.sum(holes & reference_holes) / np.sum(holes | reference_holes) >= 0.97
    both = ~holes & ~reference_holes
    assert np.mean(np.abs(found - reference)[both] <= STEP) >= 0.99


@pytest.mark.parametrize("seed", range(3))
def test_neighbour_count_equals_brute_force(seed):
    """A pixel stays where enough of the others in the window are valid and within the tolerance."""
    rng = np.random.default_rng(seed)
    settings = D4Settings(neighbour_radius=2, neighbour_least=7, neighbour_px=1.0)
    disparity = np.where(rng.random((20, 30)) < 0.7, rng.integers(300, 400, (20, 30)), 0).astype(np.uint16)
    expected = np.zeros_like(disparity)
    for y, x in np.argwhere(disparity):
        window = disparity[max(y - 2, 0) : y + 3, max(x - 2, 0) : x + 3].astype(int)
        agreeing = np.sum((window > 0) & (np.abs(window - int(disparity[y, x])) <= 32)) - 1
        expected[y, x] = disparity[y, x] if agreeing >= 7 else 0
    np.testing.assert_array_equal(with_support(disparity, settings), expected)


@pytest.mark.parametrize("seed", range(3))
def test_mean_of_surface_equals_brute_force(seed):
    """Pairs of opposite neighbours that both lie within the tolerance are averaged with the pixel, holes stay holes."""
    rng = np.random.default_rng(seed)
    settings = D4Settings(mean_reach_u=3, mean_reach_v=2, mean_px=0.5)
    disparity = np.where(rng.random((20, 40)) < 0.8, rng.integers(300, 340, (20, 40)), 0).astype(np.uint16)
    found = mean_of_surface(disparity, settings)
    np.testing.assert_array_equal(found == 0, disparity == 0)
    for y, x in np.argwhere(disparity):
        members = [float(disparity[y, x])]
        for dy in range(-2, 3):
            for dx in range(-3, 4):
                there = [(y + s * dy, x + s * dx) for s in (1, -1)]
                if (dy, dx) == (0, 0) or not all(0 <= v < 20 and 0 <= u < 40 for v, u in there):
                    continue
                pair = [float(disparity[place]) for place in there]
                if all(value > 0 and abs(value - members[0]) <= 16 for value in pair):
                    members.append(pair[0])  # the other one comes when its turn does
        assert abs(found[y, x] - np.mean(members)) <= 0.5 + 1e-3


def test_mean_of_surface_keeps_slopes_and_steps():
    """A plane of 0.2 px per pixel before a far wall: its mean is itself, to its edge, and the step stays as sharp."""
    rows, columns = np.mgrid[:40, :64]
    plane = np.rint(32 * (40 + 0.2 * columns + 0.1 * rows))
    disparity = np.where(columns < 32, plane, 32 * 20).astype(np.uint16)
    assert np.abs(mean_of_surface(disparity, D4Settings()).astype(int) - disparity).max() <= 1


@pytest.mark.parametrize("shift", [5.0, 20.25, 60.5, 100.75])
def test_constant_shift_is_found(shift):
    """A texture shifted by a known amount has that disparity everywhere that has a partner, whatever its fraction."""
    left, right = warped_pair(np.full((80, 320), shift), seed=1)
    disparity = D4Matcher().match(left, right)
    inner = disparity[10:-10, int(shift) + 16 : -16]
    assert np.mean(inner > 0) > 0.99
    assert abs(np.median(inner) - shift) <= STEP
    assert np.mean(np.abs(inner - shift) < 0.25) > 0.99
    np.testing.assert_array_equal(inner / STEP, np.rint(inner / STEP))


def test_slope_is_followed_without_bias():
    """On a tilted plane every fraction of a pixel is true somewhere: none may be preferred, nor the plane shifted."""
    rows, columns = np.mgrid[:160, :480]
    truth = 30 + 0.02 * columns + 0.03 * rows
    left, right = warped_pair(truth, seed=2)
    found = D4Matcher().match(left, right)
    inner = (found > 0) & (columns > 60) & (columns < 460) & (rows > 8) & (rows < 152)
    error = (found - truth)[inner]
    assert inner.mean() > 0.7
    assert abs(np.median(error)) < STEP
    shares = np.histogram(found[inner] % 1, 8, (0, 1))[0] / inner.sum() * 8
    assert np.all(np.abs(shares - 1) < 0.2)


def test_left_band_is_invalid():
    """Left pixels u < d look beyond the right image's edge: no disparity, the f B / Z band of a real camera."""
    left, right = warped_pair(np.full((80, 320), 50.0), seed=2)
    disparity = D4Matcher().match(left, right)
    assert not np.any(disparity > np.arange(320) + 0.5)
    assert not np.any(np.abs(disparity[:, :49] - 50) < 1)
    assert np.mean(disparity[8:-8, 60:-10] > 0) > 0.99


def test_blank_pair_has_no_depth():
    """Noise of 0.5 DN alone carries no texture: hardly a pixel may be measured where all 126 candidates compete."""
    noise = np.random.default_rng(3).normal(60, 0.5, size=(2, 120, 320))
    left, right = np.rint(noise).astype(np.uint8)
    assert np.mean(D4Matcher().match(left, right)[:, 126:] > 0) < 0.01


def test_window_changes_nothing_inside():
    """A window restricts the result; its margins hold what its pixels need, so they come out as in the whole image."""
    left, right = stepped_pair(160, 400, seed=4)
    window = Window(180, 60, 120, 60)
    whole, part = D4Matcher().match(left, right), D4Matcher().match(left, right, window)
    inside = np.zeros(part.shape, bool)
    inside[window.slices] = True
    assert part.shape == whole.shape
    assert not part[~inside].any()
    assert np.mean(part[inside] == whole[inside]) > 0.99


def test_range_is_respected():
    """Only min .. min + n - 1 is searched; true disparities outside it are not found, those inside as ever."""
    columns = np.mgrid[:80, :400][1]
    left, right = warped_pair(np.where(columns < 200, 12.5, 40.25), seed=5)
    found = D4Matcher().match(left, right, None, 20, 100)
    assert np.all((found == 0) | ((found >= 20.5) & (found <= 118.5)))
    assert np.mean(np.abs(found[8:-8, 260:-20] - 40.25) < 0.25) > 0.99
    assert np.mean(found[:, 60:180] > 0) < 0.2
    np.testing.assert_array_equal(found, D4Matcher(shift=20).match(left, right, None, 0, 100))


def test_burst_equals_single_frames():
    """Frames of a burst are matched on several threads and must not influence each other; repeats give equal bytes."""
    pairs = [stepped_pair(60, 160, seed) for seed in range(5)]
    lefts, rights = (np.stack(images) for images in zip(*pairs, strict=True))
    burst = D4Matcher().match_burst(lefts, rights)
    np.testing.assert_array_equal(burst, D4Matcher().match_burst(lefts, rights))
    for frame, (left, right) in zip(burst, pairs, strict=True):
        np.testing.assert_array_equal(frame, D4Matcher().match(left, right))


def test_upside_down_pair_gives_other_holes():
    """The sweep runs from top to bottom, so turning both images over changes holes but not the true disparities."""
    left, right = stepped_pair(120, 320, seed=6)
    up, down = D4Matcher().match(left, right), D4Matcher().match(left[::-1], right[::-1])[::-1]
    both = (up > 0) & (down > 0)
    assert np.any((up > 0) != (down > 0))
    assert np.mean(np.abs(up - down)[both] < 0.5) > 0.98
