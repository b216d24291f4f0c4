"""Shares of surface with intervals, and differences over the same poses."""

import numpy as np
import pytest

from studies.advise.paired_shares import SurfaceShares
from studies.advise.scoring import SurfaceCount
from tests.studies.advise.made_up import shares


def test_shares_are_by_surface_and_not_by_view():
    """3 of 4 m^2 right in a near view and 0 of 1 in a far one are 3 of 5."""
    pooled = SurfaceShares.of([(SurfaceCount(4.0, 3.0, 0.5, 2.0),), (SurfaceCount(1.0, 0.0, 1.0, 10.0),)])
    assert pooled.right_share == pytest.approx(3 / 5)
    assert pooled.false_share == pytest.approx(1.5 / 5)
    assert pooled.hole_share == pytest.approx(0.5 / 5)
    assert pooled.error_mm == pytest.approx((3.5 * 2 + 1 * 10) / 4.5)


def test_a_constant_gain_is_told_apart_whatever_the_poses_differ_by():
    """Paired: every pose gains five points, so every bootstrap sample does."""
    before = [0.1, 0.3, 0.5, 0.7, 0.8, 0.9]
    gain, low, high = shares([share + 0.05 for share in before]).gain_over(shares(before))
    assert (gain, low, high) == pytest.approx((0.05, 0.05, 0.05))
    assert np.ptp(shares(before).interval) > 0.2


def test_a_gain_that_comes_and_goes_is_not_told_apart():
    """Half of the poses win what the others lose."""
    gain, low, high = shares([0.6, 0.4, 0.6, 0.4]).gain_over(shares([0.4, 0.6, 0.4, 0.6]))
    assert gain == pytest.approx(0.0)
    assert low < 0 < high


def test_a_part_that_no_pose_sees_has_no_right_depth():
    """0 of 0 is 0 here, and no warning."""
    unseen = SurfaceShares.of([(SurfaceCount(0.0, 0.0, 0.0, None),)] * 2)
    assert (unseen.right_share, unseen.error_mm) == (0.0, None)
    assert unseen.interval == (0.0, 0.0)
