"""How sure the share of right depth in a bin is, with the view as the unit.

Pixels of a view are right or wrong together, since one light and one geometry decide over all of them; what can be
drawn again is a view (pose and noise). So views are resampled, whole. Shares of a bin are mostly near 1 with a tail of
bad views, where the plain bootstrap promises too much (where a view in ten is bad it holds in fewer than 85 of 100
cases instead of 90). The bound here is the Bayesian bootstrap of the pooled share (Rubin 1981: weights of the
views from a flat Dirichlet law) with **the worst view that was seen once more**, the one in which most pixels are
missing to the pooled share. With the worst that is possible in its place, a view without a right pixel, it would be
Gaffke's bound, which for views that are all right or all wrong is Clopper and Pearson's: it takes no view for granted,
and knows nothing of 95 % before 45 views without a fault; a part shows few bins so often. What the worst seen view
cannot tell of is a kind of view that was not seen. Hence the second rule: a bin is known only if so many views see it
that a kind of view that makes up a tenth of them or more is among them with the same confidence; views of unequal
size count as the number of equal ones whose mean varies as much (Kish 1965).
"""

from functools import lru_cache
from math import ceil, log

import numpy as np
from jaxtyping import Float, Int
from scipy import stats

RARE = 0.1
"""Share of views that a kind of view makes up which must not be missed (choice: what spoils one view in ten; 0.05 would
double the views)."""
BOUND_SAMPLES = 10_000
"""Of the weights (choice: the bound varies by a hundredth of its distance from the share)."""
BOUND_SEED = 0
"""Of the weights: the same views give the same bound."""


def share_bound(right: Int[np.ndarray, "views"], seen: Int[np.ndarray, "views"], confidence: float) -> float:
    """Lower bound of the pooled share of right pixels, over all views that could have been taken.

    right, seen: pixels of each view; some are seen.
    """
    worst = np.argmin(right - seen * (right.sum() / seen.sum()))
    weights = _weights(len(seen) + 1)
    shares = (weights @ [*right, right[worst]]) / (weights @ [*seen, seen[worst]])
    return float(np.quantile(shares, 1 - confidence))


@lru_cache(64)
def _weights(n: int) -> Float[np.ndarray, "samples n"]:
    """Of a flat Dirichlet law, but for their sum, which falls out of every share."""
    return np.random.default_rng(BOUND_SEED).exponential(size=(BOUND_SAMPLES, n))


def least_views(confidence: float) -> int:
    """How many views hold a kind of view that makes up RARE of all with this confidence: 1 - (1 - RARE)^n."""
    return ceil(log(1 - confidence) / log(1 - RARE) - 1e-9)


def effective_views(seen: Int[np.ndarray, "views"]) -> float:
    """How many views of equal size tell as much as these, (sum n)^2 / sum n^2 (Kish 1965); 0 without any."""
    return float(seen.sum() ** 2 / (seen**2).sum()) if len(seen) else 0.0


def most_below(below: int, views: int, confidence: float) -> float:
    """Upper bound of the share of views that fall below something, of which `below` of `views` do.

    Clopper and Pearson (1934), exact for what is yes or no in each view; the bound of Learn-then-Test
    (`studies.thresholds`) is for many settings at once, and never lower.
    """
    return 1.0 if below == views else float(stats.beta.ppf(confidence, below + 1, views - below))
