"""What the filters are for, on images whose answer is known without librealsense."""

import numpy as np
import pytest
from pydantic import ValidationError

from render.depth.filters.chain import DepthFilters, FilterChain
from render.depth.filters.disparity import depth_from_disparity, disparity_factor, disparity_from_depth
from render.depth.filters.hdr_merge import HdrFrame, HdrMerge, hdr_merged
from render.depth.filters.hole_filling import HoleFillingSettings, holes_filled
from render.depth.filters.spatial import RADII, SpatialSettings, spatially_filtered
from render.depth.filters.temporal import PERSISTENCE, TemporalFilter, TemporalSettings
from render.depth.filters.threshold import ThresholdSettings, in_range

FACTOR = disparity_factor(320.0, 50.0, 1e-3)
"""50 mm x 320 px x 32 / 1 mm = 512,000."""


def image(rows) -> np.ndarray:
    """One frame of depth."""
    return np.array([rows], np.uint16)


def test_disparity_of_every_depth():
    """f B / Z in 1/32 px, and every 16-bit depth comes back from its disparity."""
    assert pytest.approx(512_000.0) == FACTOR
    every = np.arange(2**16, dtype=np.uint16).reshape(1, 256, 256)
    disparity = disparity_from_depth(every, FACTOR)
    assert disparity[0, 0, 0] == 0
    np.testing.assert_allclose(disparity.ravel()[1:], 512_000 / np.arange(1, 2**16), rtol=1e-6)
    np.testing.assert_array_equal(depth_from_disparity(disparity, FACTOR), every)


@pytest.mark.parametrize("kind", [np.uint16, np.float32])
def test_spatial_keeps_steps_and_smooths_noise(kind):
    """A step of more than delta stays to the unit, more than half of smaller noise goes; the input is not touched."""
    step = np.full((1, 40, 60), 500).astype(kind)
    step[..., 30:] = 600
    np.testing.assert_array_equal(spatially_filtered(step), step)
    noisy = (step + np.random.default_rng(0).integers(-5, 6, step.shape)).astype(kind)
    before = noisy.copy()
    smooth = spatially_filtered(noisy)
    np.testing.assert_array_equal(noisy, before)
    assert (smooth.astype(float) - step).std() < 0.5 * (noisy.astype(float) - step).std()


@pytest.mark.parametrize("holes_fill", range(1, 6))
def test_spatial_fills_up_to_its_radius(holes_fill):
    """A hole in a row of disparity is filled by one pixel less than the radius from either side."""
    width, radius = 600, RADII[holes_fill]
    row = np.zeros((1, 2, width), np.float32)
    row[..., :10] = row[..., -10:] = 700
    filled = spatially_filtered(row, SpatialSettings(holes_fill=holes_fill))
    assert (np.count_nonzero(filled[0], axis=1) == 20 + 2 * (radius - 1)).all()


def test_spatial_draws_near_depth_into_holes():
    """Depth within delta of 0 is averaged with a hole below it: 16 units above a hole make one of 8."""
    column = image([[16, 16, 16], [0, 0, 0]])
    smooth = spatially_filtered(column, SpatialSettings(magnitude=1))
    assert (smooth[0, 1] == 8).all()


@pytest.mark.parametrize("persistence", range(len(PERSISTENCE)))
def test_temporal_persistence(persistence):
    """A hole is filled if enough of the frames before it were valid, by the modes' own words."""
    least, last = PERSISTENCE[persistence]
    valid = np.random.default_rng(persistence).random((60, 6, 50)) < np.linspace(0.05, 0.95, 50)
    filtered = TemporalFilter(TemporalSettings(persistence=persistence)).process(
        np.where(valid, 700, 0).astype(np.uint16)
    )
    for number in range(60):
        seen = valid[:number].any(axis=0)
        filled = seen & (valid[max(0, number - last) : number].sum(axis=0) >= least)
        np.testing.assert_array_equal(filtered[number], np.where(valid[number] | filled, 700, 0), err_msg=str(number))


def test_temporal_average():
    """alpha of the new and the rest of the old, cut to whole units; a change of delta or more is taken at once."""
    frames = np.array([1000, 1010, 1019, 1034, 1054], np.uint16).reshape(5, 1, 1)
    memory = TemporalFilter(TemporalSettings(alpha=0.5, delta=20))
    np.testing.assert_array_equal(memory.process(frames[:2]).ravel(), [1000, 1005])
    np.testing.assert_array_equal(memory.process(frames[2:]).ravel(), [1012, 1034, 1054])  # 1012: of (1019 + 1005) / 2
    of_disparity = TemporalFilter(TemporalSettings(alpha=0.5)).process(frames.astype(np.float32))
    np.testing.assert_array_equal(of_disparity.ravel(), [1000, 1005, 1012, 1034, 1054])


def test_hole_filling_by_hand():
    """Left neighbour, largest and smallest around; a hole below a hole stays one in mode 2; borders stay."""
    rows = [[0, 5, 9, 0], [4, 0, 6, 0], [3, 7, 8, 0]]
    answers = (
        [[0, 5, 9, 9], [4, 4, 6, 6], [3, 7, 8, 8]],
        [[0, 5, 9, 0], [4, 7, 6, 9], [3, 7, 8, 0]],
        [[0, 5, 9, 0], [4, 3, 6, 0], [3, 7, 8, 0]],
    )
    for mode, answer in enumerate(answers):
        np.testing.assert_array_equal(holes_filled(image(rows), HoleFillingSettings(mode=mode)), [answer])


def test_threshold_by_hand():
    """Both ends belong to the range; units of 1/1024 m make them exact."""
    limits = ThresholdSettings(nearest=0.5, farthest=0.75)
    kept = in_range(image([[511, 512, 600, 768, 769, 0]]), 2.0**-10, limits)
    np.testing.assert_array_equal(kept[0], [[0, 512, 600, 768, 0, 0]])


def test_hdr_by_hand():
    """The first where it is valid; with infrared, where its grey value tells something."""
    first, second = np.array([[10, 0, 10, 10, 0]], np.uint16), np.array([[20, 20, 20, 0, 0]], np.uint16)
    np.testing.assert_array_equal(hdr_merged(HdrFrame(first), HdrFrame(second)), [[10, 20, 10, 10, 0]])
    grey, other = np.array([[6, 100, 5, 250, 9]], np.uint8), np.array([[100, 249, 100, 100, 9]], np.uint8)
    merged = hdr_merged(HdrFrame(first, grey), HdrFrame(second, other))
    np.testing.assert_array_equal(merged, [[10, 20, 20, 0, 0]])
    small = np.zeros((2, 2), np.uint8)
    np.testing.assert_array_equal(hdr_merged(HdrFrame(first, small), HdrFrame(second, small)), [[10, 20, 10, 10, 0]])


def test_hdr_stream_by_hand():
    """Two frames make one, which stands for the next one, too."""
    merge = HdrMerge()
    given = [merge.process(HdrFrame(np.full((2, 2), number + 1, np.uint16)), number, number % 2) for number in range(6)]
    assert [int(depth[0, 0]) for depth in given] == [1, 1, 1, 3, 3, 5]


def test_chain_without_filters():
    """With all filters left out depth goes through, by disparity and without."""
    frames = np.random.default_rng(0).integers(0, 2**16, (3, 20, 30)).astype(np.uint16)
    for in_disparity in (True, False):
        nothing = DepthFilters(
            threshold=None, in_disparity=in_disparity, spatial=None, temporal=None, hole_filling=None
        )
        np.testing.assert_array_equal(FilterChain(nothing, 320.0, 50.0, 1e-3).process(frames), frames)


def test_chain_takes_the_nearer_of_both_in_disparity():
    """The "farthest" of disparity is the nearest depth: the trap of the recommended chain's order."""
    rows = image([[500, 900, 900], [500, 0, 900], [500, 900, 900]])
    answers = []
    for in_disparity in (True, False):
        filters = DepthFilters(threshold=None, in_disparity=in_disparity, spatial=None, temporal=None)
        answers.append(FilterChain(filters, 320.0, 50.0, 1e-3).process(rows)[0, 1, 1])
    assert answers == [500, 900]


@pytest.mark.parametrize(
    ("settings", "values"),
    [
        (SpatialSettings, {"alpha": 0.2}),
        (SpatialSettings, {"delta": 51}),
        (SpatialSettings, {"magnitude": 0}),
        (SpatialSettings, {"holes_fill": 6}),
        (TemporalSettings, {"persistence": 9}),
        (HoleFillingSettings, {"mode": 3}),
        (ThresholdSettings, {"farthest": 17.0}),
        (DepthFilters, {"decimation": 2}),
    ],
)
def test_out_of_range_is_refused(settings, values):
    """What librealsense refuses, and what nobody knows."""
    with pytest.raises(ValidationError):
        settings(**values)
