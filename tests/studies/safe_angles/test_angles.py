"""Bins and ranges against counts made by hand."""

from dataclasses import replace

import pytest

from franbv.surfaces.safe_angles import AngleBin, SafeRange
from studies.safe_angles.angles import LEAST_BIN_PX, angle_bin, roll_angles, safe_ranges
from tests.studies.safe_angles.made_up_views import row

TARGET, CONFIDENCE = 0.95, 0.9


def test_a_bin_adds_up_its_views():
    """Two views: 200 px of which 10 have no depth for the window and 20 a false one by reflection, 300 px of which 45
    are dark. Right: 170 + 255 of 500; of a matte surface 190 + 300. Both views are below 95 %."""
    found = angle_bin(
        25.0,
        [
            row(25.0, 200, occlusion_window=10, false_depth_reflection=20),
            row(25.0, 300, reflection_dark=45),
            row(25.0, LEAST_BIN_PX - 1, occlusion=LEAST_BIN_PX - 1),  # too small to count
        ],
        TARGET,
        CONFIDENCE,
    )
    assert (found.from_deg, found.to_deg) == (20.0, 30.0)
    assert (found.views, found.part_pixels, found.right_pixels) == (2, 500, 425)
    assert found.effective_views == pytest.approx(500**2 / (200**2 + 300**2))
    assert found.share == pytest.approx(425 / 500)
    assert found.matte_share == pytest.approx(490 / 500)
    assert found.views_below == 2
    assert found.lost_to == "reflection_dark"
    assert (found.is_known, found.lower_bound, found.views_below_at_most) == (False, None, None)


def test_a_view_at_the_target_is_not_below_it():
    """190 of 200 is at least 95 %, 189 of 200 is not."""
    rows = [row(5.0, 200, occlusion=10), row(5.0, 200, occlusion=11), row(5.0, 200)]
    assert angle_bin(5.0, rows, TARGET, CONFIDENCE).views_below == 1


def test_a_bin_is_known_from_22_views_on():
    """At 90 %: 0.9^22 is the first power below a tenth. Faultless views: safe when known, not before."""
    for views, known in ((21, False), (22, True)):
        line = roll_angles(0.0, [row(35.0, 500)] * views, TARGET, CONFIDENCE)
        assert [found.is_known for found in line.bins] == [False] * 3 + [known] + [False] * 5
        assert line.ranges == ((SafeRange(30.0, 40.0, 1.0, 1.0),) if known else ())
        assert line.is_safe(35.0) is known


def test_bins_cover_the_right_angle_without_gaps():
    """Nine bins of 10 deg, those that nobody sees among them."""
    line = roll_angles(90.0, [row(85.0, 500)], TARGET, CONFIDENCE)
    assert [(found.from_deg, found.to_deg) for found in line.bins] == [(10.0 * k, 10.0 * k + 10) for k in range(9)]
    assert [found.views for found in line.bins] == [0] * 8 + [1]
    assert line.bins[0].share is None
    assert line.bins[0].lost_to is None


def bins(*bounds: float | None) -> list[AngleBin]:
    """Neighbouring bins with these lower bounds, 100 px each, two of them wrong."""
    first = AngleBin(0.0, 10.0, 30, 30.0, 100, 98, 0.98, 0.97, 1.0, 0, 0.1, None)
    return [
        replace(first, from_deg=10.0 * k, to_deg=10.0 * k + 10, lower_bound=bound) for k, bound in enumerate(bounds)
    ]


def test_ranges_are_runs_of_safe_bins():
    """The widest first; what is not known parts them as what is bad does; the bound is the least of the run's, which
    may be just the target; the share is of all its pixels."""
    found = safe_ranges(bins(0.96, 0.9, 0.95, 0.97, None, 0.99), TARGET)
    assert [(span.from_deg, span.to_deg, span.lower_bound) for span in found] == [
        (20.0, 40.0, 0.95), (0.0, 10.0, 0.96), (50.0, 60.0, 0.99),
    ]  # fmt: skip
    assert found[0].share == pytest.approx(0.98)
    assert safe_ranges(bins(0.2, None, 0.9499), TARGET) == ()
