"""Learn-then-Test and the monitor: against the binomial distribution, and by counting how often they are wrong."""

import numpy as np
import pytest
from scipy.stats import binom

from studies.thresholds.risk_control import certified, least_draws, least_level, watched

LEVELS = {"too low": 0.2, "too high": 0.25}
CONFIDENCE = 0.9
KNOBS = np.linspace(0, 1, 16)
"""Of the settings below."""
CHANCES = {"too low": 0.3 * (1 - KNOBS), "too high": 0.4 * KNOBS**2}
"""Probability that a draw exceeds, by risk and setting: a low setting breaks one, a high one the other."""


def drawn(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Exceeded by n draws, of which a third says nothing of the second risk."""
    found = {name: (rng.random((n, 1)) < chances).astype(float) for name, chances in CHANCES.items()}
    found["too high"][rng.random(n) < 1 / 3] = np.nan
    return found


def broken(setting: int) -> bool:
    """Whether a setting is in truth beyond a level."""
    return any(CHANCES[name][setting] > level for name, level in LEVELS.items())


def test_what_a_number_of_draws_can_certify():
    """Without a failure by the closed form 1 - (1 - confidence)^(1 / n); with some, no lower than the binomial's."""
    for n in (20, 60, 300):
        assert least_level(n, 0.95) == pytest.approx(1 - 0.05 ** (1 / n), abs=1e-4)
    assert least_draws(0.05, 0.95) == 59  # the rule of three
    assert least_draws(0.01, 0.9) == 230
    level = least_level(200, 0.95, exceeding=9)
    assert binom.cdf(9, 200, level) <= 0.05 + 1e-4
    assert least_level(200, 0.95, exceeding=10) > level
    assert least_level(5, 0.95, exceeding=5) == least_level(0, 0.95) == 1.0


def test_certified_settings_are_seldom_wrong():
    """A setting beyond a level is among those certified in no more runs than 1 - confidence and two standard errors;
    the lowest setting whose own shares are within the levels is wrong more often."""
    rng, n_runs, wrong, naive_wrong, empty = np.random.default_rng(5), 100, 0, 0, 0
    for _ in range(n_runs):
        learn, test = drawn(rng, 150), drawn(rng, 300)
        found = certified(learn, test, LEVELS, CONFIDENCE)
        wrong += any(map(broken, found))
        empty += not found
        within = [
            all(np.nanmean(test[name][:, k]) <= level for name, level in LEVELS.items()) for k in range(len(KNOBS))
        ]
        naive_wrong += bool(np.any(within)) and broken(int(np.flatnonzero(within)[0]))
    allowed = (1 - CONFIDENCE) * n_runs
    by_chance = 2 * np.sqrt(allowed * CONFIDENCE)
    assert wrong <= allowed + by_chance
    assert naive_wrong > allowed + by_chance
    assert empty < n_runs / 2  # it is no test that never says yes


def test_one_risk_alone():
    """Sixty draws without a failure certify 5 % and not 4 %."""
    none = {"risk": np.zeros((60, 1))}
    assert certified(none, none, {"risk": 0.05}, 0.95) == (0,)
    assert certified(none, none, {"risk": 0.04}, 0.95) == ()


def test_a_setting_has_draws_of_its_own():
    """Those that are silent under it do not count for it: sixty that speak certify 5 %, fifty do not, whatever others
    have; a setting of which all are silent is not certified and spoils nothing."""
    found = np.zeros((90, 4))
    found[60:, 0], found[50:, 1], found[:, 2] = np.nan, np.nan, np.nan
    found[::2, 3] = 1
    assert certified({"risk": found}, {"risk": found}, {"risk": 0.05}, 0.95) == (0,)
    second = {"risk": found[:, 1:3], "other": np.zeros((90, 2))}
    assert certified(second, second, {"risk": 0.05, "other": 0.05}, 0.9) == (0,)  # with two risks as with one
    assert certified({"risk": found[:, [0, 2]]}, {"risk": found[:, [2, 0]]}, {"risk": 0.05}, 0.95) == ()


def test_a_risk_that_no_draw_speaks_of():
    """Is refused by name."""
    known, silent = np.zeros((9, 2)), np.full((9, 2), np.nan)
    with pytest.raises(ValueError, match="too high: no draw says anything"):
        certified({"too low": known, "too high": silent}, {"too low": known, "too high": known}, LEVELS, 0.9)


def test_the_monitor_by_counting():
    """Inside, false alarms within the bound over 200 streams; outside, nearly every stream raises one."""
    rng, false_alarms, late = np.random.default_rng(3), 0, 0
    for _ in range(200):
        reference = rng.random(400) < 0.1
        false_alarms += watched(reference, rng.random(120) < 0.1, 0.1, 0.0).alarm is not None
        late += watched(reference, rng.random(120) < 0.6, 0.1, 0.0).alarm is None
    assert false_alarms <= 20 + 2 * np.sqrt(20 * 0.9)
    assert late < 10


def test_a_stream_that_has_not_begun():
    """No observation, no alarm; the limit is known."""
    found = watched(np.arange(100) < 10, np.zeros(0, bool), 0.1, 0.05)
    assert found.alarm is None
    assert 0.15 < found.limit < 0.4
