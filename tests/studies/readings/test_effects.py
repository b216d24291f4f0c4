"""Effects, errors and margins against planted ones, closed forms and numbers worked by hand."""

from itertools import product

import numpy as np
import pytest

from studies.readings.design import level_signs
from studies.readings.effects import effect_error, effects_of, lenth_margin, main_effects, median_variance

PLANTED = np.array([0.30, -0.20, 0.0, 0.05, 0, 0, 0.12, 0, 0, -0.08, 0, 0.02, 0])
"""Full differences between the levels of thirteen decisions."""


def planted_cells() -> np.ndarray:
    """0.5 + sum of half differences times -1 or +1: a linear model without noise."""
    return 0.5 + level_signs() @ PLANTED / 2


def test_planted_effects_come_back():
    """Without noise exactly: the columns are orthogonal."""
    assert main_effects(level_signs(), planted_cells()) == pytest.approx(PLANTED, abs=1e-12)


def test_effect_is_the_difference_of_two_means():
    """Counted cell by cell, as a reader of the page would."""
    cells = np.arange(16.0) ** 1.5
    for column, effect in zip(level_signs().T, main_effects(level_signs(), cells), strict=True):
        assert effect == pytest.approx(cells[column > 0].mean() - cells[column < 0].mean())


def test_noisy_effects_lie_within_their_margins():
    """Medians of three normal starts a cell, 400 studies: 95 % of the intervals hold what was planted, as such
    intervals do. The share of 5200, 13 of them from the same cells, has an error of up to 0.4 points; four are
    allowed."""
    rng = np.random.default_rng(4)
    held, slack = [], 0.015
    for _ in range(400):
        single = planted_cells()[:, None] + rng.normal(0.0, 0.05, (16, 3))
        found = effects_of(level_signs(), np.median(single, axis=1), single)
        held += [abs(e.value - truth) <= (e.margin or 0.0) for e, truth in zip(found, PLANTED, strict=True)]
    assert np.mean(held) == pytest.approx(0.95, abs=slack)


def test_error_worked_by_hand():
    """Two starts that differ by 2 in every cell: variance 2 of a start, 1 of a cell's mean; an effect adds 16 of them
    over 8: 4 / 8. One degree of freedom a cell. Margin: t at 97.5 %."""
    single = np.tile([[4.0, 6.0]], (16, 1))
    assert effect_error(single) == (pytest.approx(0.5), 16)
    effect = effects_of(level_signs(), single.mean(axis=1), single)[0]
    assert effect.margin == pytest.approx(0.5 * 2.1199, rel=1e-4)


def test_missing_starts_count_where_they_are():
    """A cell with one start gives no spread and a wider error: 15 cells of variance 1, one of 2, over 8."""
    single = np.tile([[4.0, 6.0]], (16, 1))
    single[3, 1] = np.nan
    assert effect_error(single) == (pytest.approx(np.sqrt(15 + 2) / 8), 15)


def test_one_start_leaves_lenth_alone():
    """No spread: the effect has to exceed Lenth's margin."""
    single = planted_cells()[:, None]
    effects = effects_of(level_signs(), single[:, 0], single)
    assert all(e.error is None and e.margin is None and e.beyond == e.lenth_margin for e in effects)


def test_lenth_worked_by_hand():
    """|effects| 1 to 13, and 40 and 60. Median 8, so s0 = 12 and all below 30 remain: their median is 7, PSE 10.5. Five
    degrees of freedom: t = 2.5706."""
    effects = np.array([*range(1, 14), -40, 60], float)
    assert lenth_margin(effects) == pytest.approx(2.5706 * 10.5, rel=1e-4)
    assert lenth_margin(np.zeros(15)) == 0.0


@pytest.mark.parametrize("n", [1, 2, 3, 5, 15])
def test_variance_of_medians(n: int):
    """Against 200,000 medians of normal samples: right for one to three, not too small beyond, and at most a tenth too
    large."""
    drawn = np.median(np.random.default_rng(n).normal(size=(200_000, n)), axis=1).var()
    sampling = 4 * np.sqrt(2 / 200_000)  # four standard errors of a variance
    told = median_variance(n)
    assert drawn * (1 - sampling) <= told <= drawn * (1.0 if n <= 3 else 1.11) * (1 + sampling)


def test_level_signs_are_a_design_of_numbers():
    """Second level +1; so an effect is positive where the second level is higher."""
    assert {tuple(pair) for pair in product((-1, 1), repeat=2)} == {(int(a), int(b)) for a, b in level_signs()[:, :2]}
    assert main_effects(level_signs(), level_signs()[:, 4].astype(float)) == pytest.approx(2.0 * np.eye(13)[4])


def test_margin_is_of_students_law():
    """The table's t: 2.0369 for the 32 degrees of freedom of three starts in sixteen cells."""
    single = np.tile([[4.0, 5.0, 6.0]], (16, 1))
    effect = effects_of(level_signs(), np.median(single, axis=1), single)[0]
    assert effect.margin is not None
    assert effect.error is not None
    assert effect.margin / effect.error == pytest.approx(2.0369, abs=1e-4)
