"""Bounds over views against closed forms, and how often they hold, by drawing views from laws that are known."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy import stats

from studies.safe_angles.bounds import RARE, effective_views, least_views, most_below, share_bound

CONFIDENCE = 0.9
TRIALS = 400
COVERAGE_SLACK = 0.05
"""What the bound may fall short of its confidence by, and the error of 400 trials: three times 0.015."""
VIEW_PX = 1000


@pytest.mark.parametrize(("right", "views"), [(21, 22), (20, 22), (40, 45), (5, 10)])
def test_bound_of_all_or_nothing_is_clopper_pearson(right: int, views: int):
    """Views of one size that are all right or all wrong, one of them wrong: the share's weights are those of a Beta law
    with parameters k and n - k + 1, whose quantile is Clopper and Pearson's lower end."""
    counts = np.where(np.arange(views) < right, VIEW_PX, 0)
    found = share_bound(counts, np.full(views, VIEW_PX), CONFIDENCE)
    assert found == pytest.approx(stats.beta.ppf(1 - CONFIDENCE, right, views - right + 1), abs=0.005)
    exact = stats.binomtest(right, views).proportion_ci(2 * CONFIDENCE - 1, "exact").low
    assert found == pytest.approx(exact, abs=0.005)


def test_bound_of_equal_views_is_their_share():
    """Where every view has the same share there is nothing to be unsure of, whatever their sizes."""
    seen = np.array([100, 2000, 700, 10_000])
    assert share_bound(seen * 3 // 4, seen, CONFIDENCE) == pytest.approx(0.75)


def test_a_view_counts_by_its_pixels():
    """Twice the pixels in every view change nothing; a bad view lowers the bound more, the more pixels it has."""
    right, seen = np.array([990, 950, 400]), np.array([1000, 1000, 1000])
    assert share_bound(2 * right, 2 * seen, CONFIDENCE) == pytest.approx(share_bound(right, seen, CONFIDENCE))
    small = share_bound(np.array([990, 950, 40]), np.array([1000, 1000, 100]), CONFIDENCE)
    assert small > share_bound(right, seen, CONFIDENCE)


def sizes(rng: np.random.Generator, n: int) -> np.ndarray:
    """Pixels of the views: from some hundred to some thousand."""
    return rng.lognormal(7.0, 0.8, n).astype(int) + 100


def spread(mean: float, parts: float) -> Callable[[np.random.Generator, int], np.ndarray]:
    """Shares of a Beta law; fewer parts spread more."""
    return lambda rng, n: rng.beta(mean * parts, (1 - mean) * parts, n)


def mixed(bad: float, share: float) -> Callable[[np.random.Generator, int], np.ndarray]:
    """A kind of view, `bad` of all, in which only `share` is right, among views of 99 %."""
    return lambda rng, n: np.where(rng.random(n) < bad, share, 0.99)


LAWS = {
    "narrow": (spread(0.95, 100), 0.95),
    "wide": (spread(0.95, 20), 0.95),
    "one in ten half wrong": (mixed(RARE, 0.59), 0.95),
    "one in five a quarter wrong": (mixed(0.2, 0.79), 0.95),
    "one in ten wrong": (mixed(RARE, 0.0), 0.891),
}
"""Shares of a view by name, and the true pooled share: sizes are drawn apart from them."""


UNEQUAL_VIEWS = 44
"""Views of such sizes that are worth as many equal ones as make a bin known: twice those, since the mean square of the
sizes is about twice the square of their mean, exp(0.8^2)."""


def held(law: Callable, truth: float, bound: Callable[[np.ndarray, np.ndarray], float]) -> float:
    """How often the bound lies below the truth, of as many views as make a bin known."""
    rng, n = np.random.default_rng(5), UNEQUAL_VIEWS
    times = 0
    for _ in range(TRIALS):
        seen = sizes(rng, n)
        right = np.rint(seen * law(rng, n)).astype(int)
        times += bound(right, seen) <= truth + 1e-3  # of rounding to pixels
    return times / TRIALS


@pytest.mark.parametrize("name", LAWS)
def test_bound_holds_as_often_as_it_says(name: str):
    """Drawn from laws of known share, at the fewest views that a bin is known by."""
    law, truth = LAWS[name]
    assert held(law, truth, lambda right, seen: share_bound(right, seen, CONFIDENCE)) >= CONFIDENCE - COVERAGE_SLACK


def test_the_plain_bootstrap_would_promise_too_much():
    """The reason for the view that is added: without it the bound of views with a bad one in ten holds in fewer than 85
    of 100 cases."""
    law, truth = LAWS["one in ten wrong"]
    rng = np.random.default_rng(6)

    def plain(right: np.ndarray, seen: np.ndarray) -> float:
        drawn = rng.integers(len(seen), size=(500, len(seen)))
        return float(np.quantile(right[drawn].sum(axis=1) / seen[drawn].sum(axis=1), 1 - CONFIDENCE))

    assert held(law, truth, plain) < 0.85


@pytest.mark.parametrize(("confidence", "views"), [(0.9, 22), (0.95, 29), (0.5, 7)])
def test_least_views_do_not_miss_a_kind_of_view(confidence: float, views: int):
    """0.9^n is the chance that n views hold none of a kind that makes up a tenth: it falls below the risk at n."""
    assert least_views(confidence) == views
    assert 0.9**views <= 1 - confidence < 0.9 ** (views - 1)


def test_effective_views_are_those_of_one_size():
    """n equal views are n; beside one that sees all the rest hardly count; by Kish's formula 1, 2 and 3 are 36 / 14."""
    assert effective_views(np.full(7, 300)) == pytest.approx(7)
    assert effective_views(np.array([10_000, 1, 1, 1])) == pytest.approx(1, abs=0.001)
    assert effective_views(np.array([100, 200, 300])) == pytest.approx(36 / 14)
    assert effective_views(np.array([], int)) == 0


def test_views_below_have_an_exact_bound():
    """None of n: 1 - (1 - C)^(1 / n). Of k of n: no more than k would be seen with the risk. All of n: all."""
    assert most_below(0, 30, CONFIDENCE) == pytest.approx(1 - 0.1 ** (1 / 30))
    assert stats.binom.cdf(3, 30, most_below(3, 30, CONFIDENCE)) == pytest.approx(1 - CONFIDENCE)
    assert most_below(30, 30, CONFIDENCE) == 1.0
