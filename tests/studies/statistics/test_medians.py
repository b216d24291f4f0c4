"""Medians with their intervals and boxes, against order statistics and figures by hand."""

import numpy as np
import pytest
from scipy import stats

from studies.statistics.boxes import TukeyBox, box_of
from studies.statistics.medians import first_less_second, interval_of_medians, least_step_down, median_interval


def test_interval_of_a_median_is_about_that_of_the_order_statistics():
    """The exact interval of the median of 15 runs ends at the 4th and 12th of them (Conover 1999; 96.5 %).

    The bootstrap ends at runs too; it may be one of them farther out, as its percentiles are moved outward.
    """
    values = [float(v) for v in range(1, 16)]
    found = median_interval(values)
    assert 1 - 2 * stats.binom.cdf(3, 15, 0.5) == pytest.approx(0.965, abs=1e-3)
    assert found.value == 8.0
    assert found.low in (3.0, 4.0)
    assert found.high in (12.0, 13.0)


def test_interval_of_a_median_holds_it_as_often_as_it_says():
    """400 samples of 15 normal runs: 95 % of the intervals hold 0, with three standard errors of 1.1 %."""
    rng = np.random.default_rng(0)
    found = [median_interval(rng.normal(size=15).tolist()) for _ in range(400)]
    assert np.mean([e.low <= 0 <= e.high for e in found]) == pytest.approx(0.95, abs=0.033)


def test_a_single_run_has_no_interval_and_none_no_median():
    """Its ends are itself."""
    found = median_interval([0.4])
    assert (found.value, found.low, found.high, found.count) == (0.4, 0.4, 0.4, 1)
    with pytest.raises(ValueError, match="no runs"):
        median_interval([])


def test_starts_stay_together():
    """Two methods that scatter by 50 points alike and differ by 10 in every start: the difference is known exactly."""
    runs = np.array([[base + 0.1, base] for base in (0.2, 0.3, 0.45, 0.6, 0.7)])
    found = interval_of_medians(runs, first_less_second)
    assert (found.value, found.low, found.high) == pytest.approx((0.1, 0.1, 0.1))


def test_the_least_step_tells_the_order():
    """90, 60, 50: smallest step 10; 90, 50, 60: -10."""
    assert least_step_down(np.array([[0.9, 0.6, 0.5], [0.9, 0.5, 0.6]])) == pytest.approx([0.1, -0.1])


def test_a_box_has_tukeys_whiskers():
    """1 to 9: quartiles 3 and 7, whiskers at 1 and 9; beside them 20 lies beyond 7.75 + 1.5 * 4.5 and is left out."""
    assert box_of(range(1, 10)) == TukeyBox(5.0, 3.0, 7.0, 1.0, 9.0, 9)
    far = box_of([*range(1, 10), 20])
    assert (far.median, far.high, far.count) == (5.5, 9.0, 10)


def test_a_box_is_scaled_as_far_as_it_is_known():
    """Percent to shares; what a chart does not show stays unknown."""
    assert TukeyBox(50, 40, None, high=80).scaled(0.01) == TukeyBox(0.5, 0.4, None, high=0.8)
    assert TukeyBox(2, 1.5, 3, high=12).ends == (1.5, 12)
