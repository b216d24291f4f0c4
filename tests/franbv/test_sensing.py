"""The planner's door: one rule for "no depth", metres alone, one depth image of a burst."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst, metric_depths

ROW = Intrinsics(5, 1, 1.0, 1.0, 0.0, 0.0)
IDENTITY = RigidTransform.identity()


def test_burst_depth_is_the_median_of_valid_frames():
    """Pixels: always valid; half invalid (eta = 0.5: invalid); a quarter invalid; never valid; odd count of valid."""
    depths = np.array(
        [
            [[1.0, 1.0, 1.0, 0.0, 9.0]],
            [[2.0, 0.0, 0.0, 0.0, 3.0]],
            [[3.0, 0.0, 5.0, 0.0, 4.0]],
            [[9.0, 3.0, 3.0, 0.0, 0.0]],
        ],
        np.float32,
    )
    T = RigidTransform.identity()
    np.testing.assert_allclose(
        DepthBurst(depths, Intrinsics(5, 1, 1.0, 1.0, 0.0, 0.0), T).median_depth(), [[2.5, 0, 3, 0, 4]]
    )


@pytest.mark.parametrize("code", [0.0, np.nan, np.inf, -np.inf, -1.0])
def test_every_code_for_no_depth_is_the_same(code: float):
    """0 (librealsense), NaN and infinities (REP 118), negative numbers: afterwards 0, the rest untouched."""
    depths = np.array([[[0.3, code, 0.5, code, 0.2]]], np.float32)
    found = DepthBurst(depths, ROW, IDENTITY).depths
    np.testing.assert_array_equal(found, np.float32([[[0.3, 0.0, 0.5, 0.0, 0.2]]]))
    assert found.dtype == np.float32


def test_sound_frames_are_not_copied():
    """A burst of metres with zeros is kept as it came."""
    depths = np.array([[[0.3, 0.0, 0.5, 0.0, 0.2]]], np.float32)
    assert DepthBurst(depths, ROW, IDENTITY).depths is depths


@pytest.mark.parametrize("depths", [np.full((2, 1, 5), 300, np.uint16), np.full((2, 1, 5), 300.0, np.float32)])
def test_millimetres_are_refused(depths: np.ndarray):
    """16-bit integers, and the same numbers as floats: 300 m is no depth of a part in front of an arm."""
    with pytest.raises(ValueError, match=r"metres.*millimetres.*divide by 1000"):
        metric_depths(depths)


def test_one_far_pixel_is_no_reason():
    """A mismatch that seems 65 m away stands beside right depths."""
    depths = np.array([[[0.3, 65.0, 0.5, 0.4, 0.2]]], np.float32)
    assert DepthBurst(depths, ROW, IDENTITY).depths is depths


def test_a_single_frame_is_no_burst():
    """Two axes are rows and columns, and say nothing of how often they were measured."""
    with pytest.raises(ValueError, match="shape"):
        metric_depths(np.full((1, 5), 0.3, np.float32))


@pytest.mark.parametrize("shape", [(1, 5, 1), (1, 2, 5)])
def test_shapes_that_do_not_fit_are_refused(shape: tuple[int, ...]):
    """Rows and columns swapped, another image's intrinsics."""
    with pytest.raises(ValueError, match="shape"):
        DepthBurst(np.full(shape, 0.3, np.float32), ROW, IDENTITY)
