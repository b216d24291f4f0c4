"""Decimation against librealsense's own filter, run without a camera, and against hand-made blocks."""

import numpy as np
import pytest

from franbv.frames import Intrinsics, back_project, block_centre_intrinsics, decimated_intrinsics
from materials.input_error import InputError
from render.depth.decimation import FACTORS, crop_centre, decimate, padded
from tests.render.depth.software_camera import software_camera

SIZES = [(360, 640), (361, 643), (239, 423), (45, 71)]
"""Rows and columns: the paper's stream, and sizes that neither the factors nor the padding divide."""


def librealsense_decimated(z16: np.ndarray, intrinsics: Intrinsics, factor: int):
    """The image and intrinsics that librealsense's filter makes of a frame of its software device."""
    with software_camera(intrinsics) as camera:
        filtered = camera.sdk.decimation_filter(factor).process(camera.depth(z16))
        return np.array(filtered.get_data()), filtered.get_profile().as_video_stream_profile().get_intrinsics()


def holey(height: int, width: int, hole_share: float) -> np.ndarray:
    """All 16-bit values, with holes."""
    rng = np.random.default_rng(height + int(100 * hole_share))
    z16 = rng.integers(1, 2**16, (height, width)).astype(np.uint16)
    z16[rng.random((height, width)) < hole_share] = 0
    return z16


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("hole_share", [0.0, 0.7, 0.97])
def test_equals_librealsense(factor, size, hole_share):
    """Every bit is that of librealsense's filter, padding included, for full, holey and nearly empty images."""
    z16 = holey(*size, hole_share)
    theirs, _ = librealsense_decimated(z16, Intrinsics(size[1], size[0], 321.0, 321.0, 319.5, 179.5), factor)
    np.testing.assert_array_equal(padded(decimate(z16[None], factor))[0], theirs)


@pytest.mark.parametrize("factor", FACTORS)
def test_intrinsics_equal_librealsense(factor):
    """The decimated intrinsics are those that librealsense attaches to its frame, in its 32-bit floats."""
    source = Intrinsics(640, 360, 321.25, 320.5, 318.75, 181.125)
    _, theirs = librealsense_decimated(holey(360, 640, 0.1), source, factor)
    ours = decimated_intrinsics(source, factor)
    for mine, other in ((ours.fx, theirs.fx), (ours.fy, theirs.fy), (ours.cx, theirs.ppx), (ours.cy, theirs.ppy)):
        assert np.float32(mine) == np.float32(other)


def test_hand_made_blocks():
    """Zeros are left out: lower median of 2 x 2, truncated mean of 4 x 4, 0 only where all are 0."""
    z16 = np.zeros((1, 4, 8), np.uint16)
    z16[0, :2, :2] = [[0, 9], [5, 0]]
    z16[0, 0, 2] = 7
    np.testing.assert_array_equal(decimate(z16, 2)[0], [[5, 7, 0, 0], [0, 0, 0, 0]])
    np.testing.assert_array_equal(decimate(z16, 4)[0], [[(9 + 5 + 7) // 3, 0]])
    pair = np.zeros((1, 4, 4), np.uint16)
    pair[0, 0, :2] = [2, 3]
    assert decimate(pair, 4)[0, 0, 0] == 2


def test_frames_are_independent():
    """A burst is decimated frame by frame."""
    burst = np.stack([holey(48, 64, share) for share in (0.1, 0.5, 0.9)])
    np.testing.assert_array_equal(decimate(burst, 8), np.concatenate([decimate(frame[None], 8) for frame in burst]))


def test_paper_crop():
    """640 x 360 by 8 is 80 x 45; its middle 60 x 40 starts 10 columns in and 2 rows down, and so do its intrinsics."""
    source = Intrinsics(640, 360, 321.0, 321.0, 319.5, 179.5)
    small = decimate(holey(360, 640, 0.3)[None], 8)
    cropped, intrinsics = crop_centre(small, decimated_intrinsics(source, 8))
    np.testing.assert_array_equal(cropped, small[:, 2:42, 10:70])
    assert (intrinsics.width, intrinsics.height) == (60, 40)
    assert (intrinsics.cx, intrinsics.cy) == (319.5 / 8 - 10, 179.5 / 8 - 2)


def test_block_centres_look_where_their_pixels_do():
    """A decimated pixel looks along its block's mean direction; librealsense's intrinsics miss that by 0.44 px."""
    source = Intrinsics(640, 360, 321.0, 321.0, 319.5, 179.5)
    blocks = source.pixel_directions().reshape(45, 8, 80, 8, 3).mean(axis=(1, 3))
    np.testing.assert_allclose(block_centre_intrinsics(source, 8).pixel_directions(), blocks, atol=1e-12)
    missed = (decimated_intrinsics(source, 8).pixel_directions() - blocks)[..., :2] * 321.0 / 8
    np.testing.assert_allclose(missed, -7 / 16, atol=1e-9)


def test_flat_wall_stays_in_place():
    """The corners of a decimated wall at 1 m are the means of the corner blocks' own points."""
    source = Intrinsics(640, 360, 321.0, 321.0, 319.5, 179.5)
    wall = np.full((1, 360, 640), 1000, np.uint16)
    points = back_project(decimate(wall, 8)[0] * 1e-3, block_centre_intrinsics(source, 8))
    fine = back_project(wall[0] * 1e-3, source).reshape(360, 640, 3)
    np.testing.assert_allclose(points[0], fine[:8, :8].mean(axis=(0, 1)), atol=1e-9)
    np.testing.assert_allclose(points[-1], fine[-8:, -8:].mean(axis=(0, 1)), atol=1e-9)


@pytest.mark.parametrize("factor", [0, 1, 9])
def test_unknown_factor_is_refused(factor):
    """What librealsense does not offer, or passes through, is an input error."""
    with pytest.raises(InputError, match="use one of them"):
        decimate(np.zeros((1, 16, 16), np.uint16), factor)


def test_too_large_crop_is_refused():
    """A crop beyond the image names both sizes."""
    small = np.zeros((1, 30, 53), np.uint16)
    with pytest.raises(InputError, match=r"60x40.*53x30"):
        crop_centre(small, Intrinsics(53, 30, 30.0, 30.0, 26.0, 14.5))
