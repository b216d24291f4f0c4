"""The statistics of depth frames on synthetic ones whose numbers follow from how they were made."""

import numpy as np
import pytest

from tests.physics.depth_statistics import (
    LAGS,
    PATCH_PX,
    Frame,
    autocorrelation,
    by_contrast,
    by_incidence,
    contrast,
    edge_profile,
    half_occluded_shares,
    hiding_disparity,
    hole_blobs,
    near_bend,
    plane_residual,
    robust_sigma,
    smooth_patches,
)
from tests.physics.real_d415_statistics import REAL, is_met, statistics

NEAR, FAR = 30.0, 20.0
"""Disparities of a near post and of what is behind it [px]."""
POST = slice(100, 140)
"""Columns of the post. The 10 columns left of it are hidden from the right imager, which sees the post there."""


def frame(true: np.ndarray, found: np.ndarray, **others: np.ndarray) -> Frame:
    """A frame that counts everywhere, seen by both imagers at normal incidence unless said otherwise."""
    every = np.ones(true.shape, bool)
    maps = {"left": np.zeros(true.shape, np.uint8), "incidence": np.zeros(true.shape)}
    maps |= {"in_right": every, "visible": every, "counted": every}
    return Frame(true=true, found=found, **(maps | others))


def post_scene() -> tuple[np.ndarray, np.ndarray]:
    """True disparity (60, 240) of the post, and where the right imager sees the same point."""
    true = np.full((60, 240), FAR)
    true[:, POST] = NEAR
    visible = np.ones(true.shape, bool)
    visible[:, POST.start - 10 : POST.start] = False
    return true, visible


def test_robust_sigma_is_that_of_the_normal_distribution():
    """Of 40,000 draws within 2 % (its standard error is 0.6 %), whatever one in a hundred gross errors are."""
    values = np.random.default_rng(0).normal(5, 0.14, 40_000)
    values[::100] = 1000
    assert robust_sigma(values) == pytest.approx(0.14, rel=0.02)


def test_plane_goes_and_noise_stays():
    """A tilted plane with noise, holes and a tenth of false matches: the residual is the noise where it is measured."""
    rng = np.random.default_rng(1)
    rows, columns = np.mgrid[:PATCH_PX, :PATCH_PX]
    noise = rng.normal(0, 0.1, rows.shape)
    found = 40 + 0.1 * rows - 0.05 * columns + noise
    kind = rng.random(rows.shape)
    found[kind < 0.1] += 7
    found[kind > 0.9] = 0
    rest = plane_residual(found)  # beyond five sigmas there is hardly a draw
    assert np.isnan(rest[(kind < 0.1) | (kind > 0.9)]).all()
    valid = np.isfinite(rest)
    assert np.abs(rest - noise)[valid].max() < 0.02
    assert robust_sigma(rest[valid]) == pytest.approx(0.1, rel=0.05)


@pytest.mark.parametrize("axis", [0, 1])
def test_autocorrelation_of_a_moving_mean_is_a_triangle(axis):
    """White noise averaged over 9 pixels along an axis correlates by 1 - lag / 9 along it, and by 0 across it."""
    white = np.random.default_rng(2).normal(size=(600, 600))
    mean = sum(np.roll(white, k, axis) for k in range(9))
    along, across = autocorrelation(mean, axis), autocorrelation(mean, 1 - axis)
    np.testing.assert_allclose(along, [max(1 - lag / 9, 0) for lag in LAGS], atol=0.03)
    np.testing.assert_allclose(across, 0, atol=0.03)


def test_smooth_patches_lie_on_one_plane():
    """Of a scene with a step in the middle, only patches beside the step; a patch of holes is none."""
    true = np.full((PATCH_PX, 4 * PATCH_PX), 20.0)
    true[:, 2 * PATCH_PX :] = 30.0
    assert len(smooth_patches(frame(true, true.copy()))) == 3 + 3  # at 0, 48, 96 and 192, 240, 288
    holes = true.copy()
    holes[:, : 2 * PATCH_PX] = 0
    assert len(smooth_patches(frame(true, holes))) == 3


def test_what_hides_a_point_is_the_post():
    """Column x of the background lands at x - 20, the post's first at 70: from column 90 on the post hides all."""
    true, visible = post_scene()
    cover = hiding_disparity(true)
    assert np.all(cover[~visible] == NEAR)
    assert np.isnan(cover[:, : POST.start - 10]).all()


def test_half_occluded_pixels_are_told_apart():
    """Of ten hidden columns four are holes, three have the post's disparity, two their own and one neither."""
    true, visible = post_scene()
    found = true.copy()
    found[:, 90:94], found[:, 94:97], found[:, 99] = 0, NEAR + 0.5, 60
    assert half_occluded_shares([frame(true, found, visible=visible)]) == pytest.approx((0.4, 0.3, 0.2, 0.1))


def test_profiles_beside_edges():
    """Left of the post holes up to 5 px and foreground at 8; right of it foreground at 0 and a hole at 4 on half of the
    rows. The other side does not matter."""
    true, visible = post_scene()
    found = true.copy()
    found[:, POST.start - 6 : POST.start], found[:, POST.start - 9] = 0, NEAR
    found[:, POST.stop], found[:30, POST.stop + 4] = NEAR, 0
    both = frame(true, found, visible=visible)
    np.testing.assert_allclose(edge_profile([both], "left"), [[1, 0], [1, 0], [0, 1], [0, 0]])
    np.testing.assert_allclose(edge_profile([both], "right"), [[0, 1], [0.5, 0], [0, 0], [0, 0]])


def test_blobs():
    """Two single pixels and one blob of 1200: median 1, all but 2 of 1202 px in large blobs; what does not count, does
    not."""
    true = np.full((100, 100), 20.0)
    found = true.copy()
    found[5, 5] = found[5, 9] = 0
    found[20:50, 20:60] = 0
    found[90:] = 0
    counted = np.ones(true.shape, bool)
    counted[90:] = False
    median, large = hole_blobs([frame(true, found, counted=counted)])
    assert median == 1
    assert large == pytest.approx(1200 / 1202)


def test_bins_of_incidence_and_contrast():
    """Half of a plane at 30 deg without holes and noise of 0.1 px, half at 75 deg with every fourth pixel a hole and
    0.3 px; stripes of +-3 DN have contrast 3."""
    rng = np.random.default_rng(3)
    true = np.full((200, 400), 20.0)
    steep = np.arange(400) >= 200
    found = true + np.where(steep, 0.3, 0.1) * rng.normal(size=true.shape)
    found[::4, 200:] = 0
    left = np.full(true.shape, 100, np.uint8)
    left[:, ::2] += np.where(steep[::2], np.uint8(6), np.uint8(0))
    degrees = np.broadcast_to(np.where(steep, 75.0, 30.0), true.shape)
    one = frame(true, found, incidence=np.radians(degrees), left=left)
    pixels, holes, sigma = by_incidence([one], (0, 65, 70, 80)).T
    np.testing.assert_array_equal(pixels, [40_000, 0, 40_000])
    np.testing.assert_allclose(holes[[0, 2]], [0, 0.25])
    np.testing.assert_allclose(sigma[[0, 2]], [0.1, 0.3], rtol=0.03)
    assert contrast(left)[100, 300] == pytest.approx(6 * np.sqrt(20 / 81))  # 4 or 5 of 9 columns are 6 DN brighter
    calm, lively = by_contrast([one], (0, 0.7, 2.5, 4))[[0, 2]]
    assert calm[1] == pytest.approx(0, abs=0.01)
    assert lively[1] == pytest.approx(0.25, abs=0.01)


def test_surfaces_end_where_disparity_bends():
    """A plane, however steep, has no end; a step of 2 px has one, 16 px wide on either side."""
    rows, columns = np.mgrid[:60, :120]
    assert not near_bend(20 + 0.9 * columns + 0.5 * rows).any()
    step = np.where(columns < 60, 20.0, 22.0)
    np.testing.assert_array_equal(np.flatnonzero(near_bend(step)[30]), np.arange(59 - 16, 60 + 17))


def test_published_numbers_are_complete():
    """Every published number has one of ours: 44 of a frame with a post, noise, texture and slopes of all bins."""
    rng = np.random.default_rng(4)
    true = np.full((120, 480), FAR)
    true[:, 400:440] = NEAR
    visible = np.ones(true.shape, bool)
    visible[:, 390:400] = False
    found = np.where(rng.random(true.shape) < 0.02, 0, true + rng.normal(0, 0.1, true.shape))
    left = rng.normal(100, np.repeat([0.3, 0.8, 3.0], 40)[:, None], true.shape).round().astype(np.uint8)
    incidence = np.radians(np.broadcast_to(np.repeat([30.0, 67.0, 75.0, 85.0], 120), true.shape))
    ours = statistics([frame(true, found, visible=visible, left=left, incidence=incidence)])
    assert list(ours) == list(REAL)
    assert np.isfinite(list(ours.values())).all()
    assert ours["noise of smooth patches, median [px]"] == pytest.approx(0.1, rel=0.05)
    assert is_met("half-occluded: hole", 0.62 * 1.24)
    assert not is_met("half-occluded: hole", 0.62 * 1.26)
