"""Intervals and tests against closed forms, SciPy, and cases counted by hand."""

import numpy as np
import pytest
from scipy import stats

from studies.statistics.intervals import holm, least_p, mean_interval, paired_difference, sign_flip_p


def test_bootstrap_interval_of_many_runs_is_the_normal_one():
    """The bootstrap mean of n values scatters by s sqrt((n - 1) / n) / sqrt(n): 1.96 of that to either side."""
    values = np.random.default_rng(3).normal(0.6, 0.1, 400)
    found = mean_interval(values.tolist())
    half = 1.96 * values.std() / np.sqrt(400)
    assert found.mean == pytest.approx(values.mean())
    assert (found.low, found.high) == pytest.approx((values.mean() - half, values.mean() + half), abs=0.06 * half)
    assert found.count == 400


def test_interval_of_fifteen_runs_is_as_wide_as_students():
    """Half the width, averaged over samples of a normal law, against t(14, 97.5 %) s / sqrt(15) = 0.5538 s."""
    samples = np.random.default_rng(7).normal(0.0, 1.0, (100, 15))
    found = [mean_interval(sample.tolist()) for sample in samples]
    ratio = np.mean([(i.high - i.low) / 2 / (0.5538 * x.std(ddof=1)) for i, x in zip(found, samples, strict=True)])
    assert ratio == pytest.approx(1.0, abs=0.03)


def test_interval_of_three_runs_is_their_range():
    """A bootstrap mean cannot leave it, and Student's t of two degrees of freedom asks for more."""
    found = mean_interval([0.1, 0.4, 0.2])
    assert (found.low, found.high) == pytest.approx((0.1, 0.4))


def test_smallest_p_is_that_of_runs_that_agree():
    """Two of 2^n choices of signs are as far from zero."""
    for n in (1, 3, 5, 15):
        assert least_p(n) == pytest.approx(sign_flip_p(np.arange(1.0, n + 1)))


def test_interval_of_equal_or_single_runs_is_a_point():
    """Nothing varies."""
    assert mean_interval([0.5] * 7) == mean_interval([0.5] * 7)
    assert (mean_interval([0.5] * 7).low, mean_interval([0.4]).high) == (0.5, 0.4)
    with pytest.raises(ValueError, match="no runs"):
        mean_interval([])


def test_sign_flip_by_hand():
    """1, 2, 3 all positive: of eight sign choices two are as far from zero; 1, -1: all four sums are 0 or more."""
    assert sign_flip_p([1.0, 2.0, 3.0]) == 2 / 8
    assert sign_flip_p([1.0, -1.0]) == 1.0
    assert sign_flip_p([0.0, 0.0, 0.0]) == 1.0
    assert sign_flip_p([0.3]) == 1.0


@pytest.mark.parametrize("n", [8, 15])
def test_sign_flip_is_scipys_paired_permutation_test(n: int):
    """The exact test of the same statistic by independent code."""
    d = np.random.default_rng(n).normal(0.4, 1.0, n)
    theirs = stats.permutation_test(
        (d,), lambda x, axis: x.mean(axis=axis), permutation_type="samples", n_resamples=2**n, vectorized=True
    )
    assert sign_flip_p(d) == pytest.approx(theirs.pvalue)


def test_sign_flip_of_many_runs_approaches_the_t_test():
    """40 runs, random signs: within the scatter of 2^15 draws and the tests' difference of Student's p."""
    d = np.random.default_rng(1).normal(0.25, 1.0, 40)
    assert sign_flip_p(d) == pytest.approx(stats.ttest_1samp(d, 0.0)[1], abs=0.02)


def test_paired_difference_follows_the_pairs():
    """Runs that differ by exactly 0.1 although they scatter by more: the interval is that of the differences."""
    theirs = [0.2, 0.9, 0.5, 0.4]
    found = paired_difference([x + 0.1 for x in theirs], theirs)
    assert found.interval.low == pytest.approx(0.1)
    assert found.interval.high == pytest.approx(0.1)
    assert found.p == 2 / 16


def test_holm_by_hand():
    """0.01, 0.04, 0.03 of three: 0.03, then 0.06 for the next, which the last cannot undercut."""
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == pytest.approx([1.0, 1.0])
    assert holm([]) == []
