"""Every filter against librealsense's own, bit for bit: 50 varied frames each, in depth and in disparity."""

from functools import partial
from typing import Any

import numpy as np
import pytest

from franbv.frames import Intrinsics
from render.depth.decimation import decimate, padded
from render.depth.filters.chain import DepthFilters, FilterChain
from render.depth.filters.disparity import depth_from_disparity, disparity_factor, disparity_from_depth
from render.depth.filters.hdr_merge import HdrFrame, HdrMerge
from render.depth.filters.hole_filling import HoleFillingSettings, holes_filled
from render.depth.filters.spatial import SpatialSettings, spatially_filtered
from render.depth.filters.temporal import PERSISTENCE, TemporalFilter, TemporalSettings
from render.depth.filters.threshold import ThresholdSettings, in_range
from tests.render.depth.filters.varied_frames import SIZE, varied_frames
from tests.render.depth.software_camera import BASELINE, UNIT, SoftwareCamera, software_camera

FOCAL = 321.37
"""Not a 32-bit number [px]."""
FACTOR = disparity_factor(FOCAL, BASELINE, UNIT)
SPATIAL = [(0.5, 20, 2, 0), (0.25, 1, 1, 1), (0.6, 50, 5, 2), (1.0, 20, 2, 3), (0.33, 7, 3, 4), (0.71, 31, 4, 5)]
"""alpha, delta, magnitude and hole filling; the defaults first."""
TEMPORAL = [(0.4, 20), (0.0, 7), (1.0, 100), (0.13, 1), (0.77, 55), (0.31, 33), (0.4, 90), (0.9, 12), (0.05, 64)]
"""alpha and delta, one for each persistence mode."""
SEQUENCE = [
    *((number, number % 2) for number in range(12)),
    *((14, 0), (15, 1), (19, 0), (20, 1), (24, 0), (26, 1), (27, 0), (28, 1)),  # gaps, one within a pair
    *((31, 0), (31, 0), (32, 1), (33, 1), (34, 1), (35, 1), (36, 1)),  # doubled, and never again a first one
    *((3, 0), (4, 1), (5, 1), (6, 0), (6, 1), (7, 0), (8, 1), (9, 0), (12, 0)),  # begun anew
]
"""Number and sequence id of the frames of an HDR stream, as cameras send them and as they do not."""


def calibration(size: tuple[int, int] = SIZE) -> Intrinsics:
    """Of images of so many rows and columns."""
    return Intrinsics(size[1], size[0], FOCAL, FOCAL, size[1] / 2, size[0] / 2)


def through(camera: SoftwareCamera, frames: np.ndarray, *blocks: Any) -> np.ndarray:
    """What librealsense makes of a sequence of depth images."""
    results = []
    for number, z16 in enumerate(frames):
        frame = camera.depth(z16, number)
        for block in blocks:
            frame = block.process(frame)
        results.append(np.array(frame.get_data()))
    return np.stack(results)


def assert_same_bits(ours: np.ndarray, theirs: np.ndarray) -> None:
    """librealsense's Python gives disparities as the words that hold them."""
    np.testing.assert_array_equal(ours.view(theirs.dtype), theirs)


def test_disparity():
    """To disparity and back, and the factor between them."""
    frames = varied_frames()
    disparity = disparity_from_depth(frames, FACTOR)
    with software_camera(calibration()) as camera:
        there, back = camera.sdk.disparity_transform(True), camera.sdk.disparity_transform(False)
        assert_same_bits(disparity, through(camera, frames, there))
        assert_same_bits(depth_from_disparity(disparity, FACTOR), through(camera, frames, there, back))


@pytest.mark.parametrize("options", SPATIAL)
def test_spatial(options):
    """On depth, on disparity, and on depth by way of disparity."""
    alpha, delta, magnitude, holes_fill = options
    settings = SpatialSettings(alpha=alpha, delta=delta, magnitude=magnitude, holes_fill=holes_fill)
    frames = varied_frames()
    frames[:, -1, -1] = 800  # see test_spatial_end_of_memory
    smooth = spatially_filtered(disparity_from_depth(frames, FACTOR), settings)
    with software_camera(calibration()) as camera:
        there, back = camera.sdk.disparity_transform(True), camera.sdk.disparity_transform(False)
        block = partial(camera.sdk.spatial_filter, *options)
        assert_same_bits(spatially_filtered(frames, settings), through(camera, frames, block()))
        assert_same_bits(smooth, through(camera, frames, there, block()))
        assert_same_bits(depth_from_disparity(smooth, FACTOR), through(camera, frames, there, block(), back))


@pytest.mark.parametrize("holes_fill", range(1, 6))
def test_spatial_end_of_memory(holes_fill):
    """Where the last row of disparity ends with a hole, librealsense reads beyond its image; all other rows agree."""
    settings = SpatialSettings(holes_fill=holes_fill)
    frames = varied_frames(1)
    frames[:, -1, 40:] = 0
    ours = spatially_filtered(disparity_from_depth(frames, FACTOR), settings)
    with software_camera(calibration()) as camera:
        options = settings.alpha, settings.delta, settings.magnitude, holes_fill
        blocks = camera.sdk.disparity_transform(True), camera.sdk.spatial_filter(*options)
        assert_same_bits(ours[:, :-1], through(camera, frames, *blocks)[:, :-1])


@pytest.mark.parametrize("size", [(2, 2), (2, 9), (9, 2), (3, 3)])
def test_spatial_small(size):
    """Images of which borders are the most part."""
    frames = varied_frames(2, size)
    frames[:, -1, -1] = 800
    settings = SpatialSettings(holes_fill=2)
    with software_camera(calibration(size)) as camera:
        there, block = camera.sdk.disparity_transform(True), camera.sdk.spatial_filter(0.5, 20, 2, 2)
        assert_same_bits(spatially_filtered(frames, settings), through(camera, frames, block))
        block = camera.sdk.spatial_filter(0.5, 20, 2, 2)
        smooth = spatially_filtered(disparity_from_depth(frames, FACTOR), settings)
        assert_same_bits(smooth, through(camera, frames, there, block))


@pytest.mark.parametrize("persistence", range(len(PERSISTENCE)))
def test_temporal(persistence):
    """50 varied frames, then 50 of one flickering surface, on depth and on disparity."""
    alpha, delta = TEMPORAL[persistence]
    settings = TemporalSettings(alpha=alpha, delta=delta, persistence=persistence)
    rng = np.random.default_rng(persistence)
    flickering = 700 + rng.integers(-40, 41, (50, *SIZE)).astype(np.uint16)
    flickering[rng.random(flickering.shape) < np.linspace(0.0, 1.0, SIZE[1])] = 0
    frames = np.concatenate([varied_frames(persistence), flickering])
    with software_camera(calibration()) as camera:
        block = camera.sdk.temporal_filter(alpha, delta, persistence)
        assert_same_bits(TemporalFilter(settings).process(frames), through(camera, frames, block))
        there, block = camera.sdk.disparity_transform(True), camera.sdk.temporal_filter(alpha, delta, persistence)
        ours = TemporalFilter(settings).process(disparity_from_depth(frames, FACTOR))
        assert_same_bits(ours, through(camera, frames, there, block))


def test_temporal_of_another_size():
    """A stream of another size forgets the one before it, and is forgotten in turn."""
    ours = TemporalFilter()
    sizes = SIZE, (SIZE[0], SIZE[1] - 1)
    with software_camera(calibration(sizes[0])) as one, software_camera(calibration(sizes[1])) as other:
        block = one.sdk.temporal_filter()
        for seed, camera, size in ((0, one, sizes[0]), (1, other, sizes[1]), (2, one, sizes[0])):
            frames = varied_frames(seed, size, 11)
            assert_same_bits(ours.process(frames), through(camera, frames, block))


@pytest.mark.parametrize("mode", range(3))
def test_hole_filling(mode):
    """On depth and on disparity."""
    settings = HoleFillingSettings(mode=mode)
    frames = varied_frames(mode)
    with software_camera(calibration()) as camera:
        block = partial(camera.sdk.hole_filling_filter, mode)
        assert_same_bits(holes_filled(frames, settings), through(camera, frames, block()))
        there = camera.sdk.disparity_transform(True)
        ours = holes_filled(disparity_from_depth(frames, FACTOR), settings)
        assert_same_bits(ours, through(camera, frames, there, block()))


@pytest.mark.parametrize(("nearest", "farthest"), [(0.1, 4.0), (0.5, 0.6), (0.0, 16.0), (0.7, 0.7)])
def test_threshold(nearest, farthest):
    """Ends that lie on whole units, where a wrong rounding would show."""
    frames = varied_frames()
    settings = ThresholdSettings(nearest=nearest, farthest=farthest)
    with software_camera(calibration()) as camera:
        theirs = through(camera, frames, camera.sdk.threshold_filter(nearest, farthest))
        assert_same_bits(in_range(frames, UNIT, settings), theirs)


@pytest.mark.parametrize("coding", [None, np.uint8, np.uint16])
def test_hdr_merge(coding):
    """A stream with gaps, doubled frames and a new beginning, without infrared and with both kinds of it."""
    rng = np.random.default_rng(5)
    ours, frames = HdrMerge(), varied_frames(4, count=len(SEQUENCE))
    with software_camera(calibration()) as camera:
        theirs = camera.sdk.hdr_merge()
        for z16, (number, sequence_id) in zip(frames, SEQUENCE, strict=True):
            streams = [camera.depth(z16, number, sequence_id)]
            grey = None
            if coding is not None:
                grey = rng.integers(0, 256 if coding == np.uint8 else 1024, SIZE).astype(coding)
                streams.append(camera.infrared(grey, number, sequence_id))
            merged = theirs.process(camera.together(streams)).as_frameset().get_depth_frame()
            given = ours.process(HdrFrame(z16, grey), number, sequence_id)
            np.testing.assert_array_equal(given, np.array(merged.get_data()), err_msg=f"frame {number}")


def test_hdr_merge_of_unlike_infrared():
    """Infrared that only one frame has, or that changes its format, does not count."""
    first, second = varied_frames(6, count=2)
    dark, bright = np.zeros(SIZE, np.uint8), np.full(SIZE, 500, np.uint16)
    for pair in ((dark, bright), (bright, dark), (dark, None), (None, dark), (dark, dark)):
        ours = HdrMerge()
        with software_camera(calibration()) as camera:
            theirs = camera.sdk.hdr_merge()
            for number, (z16, grey) in enumerate(zip((first, second), pair, strict=True)):
                streams = [camera.depth(z16, number, number)]
                if grey is not None:
                    streams.append(camera.infrared(grey, number, number))
                merged = theirs.process(camera.together(streams)).as_frameset().get_depth_frame()
                given = ours.process(HdrFrame(z16, grey), number, number)
                np.testing.assert_array_equal(given, np.array(merged.get_data()))


def test_hdr_merge_of_another_size():
    """A stream of another size gets no merged depth of the one before it, and merges with none of its frames."""
    ours = HdrMerge()
    small = SIZE[0] - 1, SIZE[1]
    with software_camera(calibration()) as one, software_camera(calibration(small)) as other:
        theirs = one.sdk.hdr_merge()
        for number, of_one in enumerate((True, True, False, False, False, True, False, True, True)):
            camera, size = (one, SIZE) if of_one else (other, small)
            (z16,) = varied_frames(number, size, 1)
            together = camera.together([camera.depth(z16, number, number % 2)])
            merged = theirs.process(together).as_frameset().get_depth_frame()
            given = ours.process(HdrFrame(z16), number, number % 2)
            np.testing.assert_array_equal(given, np.array(merged.get_data()))


@pytest.mark.parametrize("factor", [2, 4])
@pytest.mark.parametrize("in_disparity", [True, False])
def test_chain(factor, in_disparity):
    """The recommended chain behind decimation, whose focal length is the decimated one."""
    frames = varied_frames(7, (90, 158))
    chain = FilterChain(DepthFilters(in_disparity=in_disparity), FOCAL / factor, BASELINE, UNIT)
    with software_camera(calibration((90, 158))) as camera:
        sdk = camera.sdk
        filters = sdk.spatial_filter(), sdk.temporal_filter(), sdk.hole_filling_filter()
        if in_disparity:
            filters = sdk.disparity_transform(True), *filters, sdk.disparity_transform(False)
        blocks = sdk.decimation_filter(factor), sdk.threshold_filter(0.1, 4.0), *filters
        assert_same_bits(chain.process(padded(decimate(frames, factor))), through(camera, frames, *blocks))


def test_defaults_and_ranges():
    """Our settings have librealsense's defaults and ranges."""
    with software_camera(calibration()) as camera:
        sdk, option = camera.sdk, camera.sdk.option
        smooth = {"alpha": option.filter_smooth_alpha, "delta": option.filter_smooth_delta}
        settings = {
            SpatialSettings: (
                sdk.spatial_filter(),
                {**smooth, "magnitude": option.filter_magnitude, "holes_fill": option.holes_fill},
            ),
            TemporalSettings: (sdk.temporal_filter(), {**smooth, "persistence": option.holes_fill}),
            HoleFillingSettings: (sdk.hole_filling_filter(), {"mode": option.holes_fill}),
            ThresholdSettings: (
                sdk.threshold_filter(),
                {"nearest": option.min_distance, "farthest": option.max_distance},
            ),
        }
        for kind, (block, names) in settings.items():
            for name, key in names.items():
                theirs, field = block.get_option_range(key), kind.model_fields[name]
                least, most = (getattr(bound, side) for bound, side in zip(field.metadata, ("ge", "le"), strict=True))
                ours = np.array([least, most, field.default], np.float32)
                np.testing.assert_array_equal(ours, [theirs.min, theirs.max, theirs.default], err_msg=name)
