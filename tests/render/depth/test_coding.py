"""Disparity to z16 and back: Z = f B / d, rounding, clamps, invalid values, search range."""

import numpy as np
import pytest

from render.depth.coding import DepthFormat, metres_from_z16, z16_from_disparity, z_range
from render.world.rig import d435i_rig

FOCAL_BASELINE = 16.05
"""f B at 640 x 360 [px m]."""


def test_depth_is_focal_baseline_over_disparity():
    """16.05 px m over 32.1 px is 0.5 m, 500 units of 1 mm."""
    disparity = np.array([[32.1, 16.05, 107.0]], np.float32)
    np.testing.assert_array_equal(z16_from_disparity(disparity, FOCAL_BASELINE), [[500, 1000, 150]])


def test_rounding_costs_half_a_unit():
    """Depth comes back within half a unit of f B / d over the whole search range, for 1 mm and for 0.1 mm."""
    disparity = (np.arange(32, 126 * 32, dtype=np.float32) / 32)[None]
    for unit in (1e-3, 1e-4):
        coding = DepthFormat(unit=unit)
        depth = metres_from_z16(z16_from_disparity(disparity, FOCAL_BASELINE, coding), coding)
        codable = FOCAL_BASELINE / disparity / unit < 65535
        error = np.abs(depth - FOCAL_BASELINE / disparity)[codable]
        assert error.max() < unit * 0.5001 + 1e-6
        assert not depth[~codable].any()


def test_invalid_stays_invalid():
    """No disparity, negative or undefined ones and depths beyond 16 bits are 0, and stay 0 in metres."""
    disparity = np.array([[0.0, -1.0, np.nan, 1e-4]], np.float32)
    z16 = z16_from_disparity(disparity, FOCAL_BASELINE)
    assert z16.dtype == np.uint16
    assert not metres_from_z16(z16).any()


def test_clamps_make_invalid():
    """Depth outside [clamp_min, clamp_max] is dropped; the bounds themselves are kept."""
    disparity = np.float32(FOCAL_BASELINE) / np.array([[0.199, 0.2, 0.6, 0.601]], np.float32)
    z16 = z16_from_disparity(disparity, FOCAL_BASELINE, DepthFormat(clamp_min=200, clamp_max=600))
    np.testing.assert_array_equal(z16, [[0, 200, 600, 0]])


@pytest.mark.parametrize(("profile", "min_z"), [("640x360", 0.127), ("848x480", 0.170), ("1280x720", 0.255)])
def test_min_z_of_the_profiles(profile, min_z):
    """Without disparity shift Min-Z is the rig's f B / 126 (127, 170 and 255 mm) and Max-Z is unbounded."""
    rig = d435i_rig(profile)
    near, far = z_range(rig.focal_baseline)
    assert near == rig.min_z
    assert near == pytest.approx(min_z, abs=1e-3)
    assert far == np.inf


def test_disparity_shift_moves_the_range_nearer():
    """A shift of 50 px searches 50 to 176 px: 91 mm to 321 mm at 640 x 360."""
    near, far = z_range(FOCAL_BASELINE, 50)
    assert near == pytest.approx(FOCAL_BASELINE / 176)
    assert far == pytest.approx(FOCAL_BASELINE / 50)
