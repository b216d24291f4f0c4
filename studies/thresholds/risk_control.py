"""Learn-then-Test and its drift monitor, as MAPIE has them: the one place that knows that package.

A *draw* is what is exchangeable: a scene and a view of it, or a scene and a whole reconstruction. Under a setting it
either exceeds what is borne of a risk or does not; a setting's risk is the probability that a draw exceeds.

Sources: A. N. Angelopoulos et al., Learn then Test (2021), with several risks by the largest of their p-values
(Hoeffding-Bentkus), and the settings' order learned on draws of its own; A. Podkopaev and A. Ramdas, Tracking the risk
of a deployed model (ICLR 2022), for the monitor.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int, Num
from mapie.exchangeability_testing import RiskMonitoring
from mapie.risk_control import BinaryClassificationController, BinaryRisk
from mapie.risk_control.methods import compute_hoeffding_bentkus_p_value
from scipy.optimize import root_scalar

Exceeded = Mapping[str, Float[np.ndarray, "_ k"]]
"""By risk: 1 where a draw exceeds what is borne, 0 where it does not, NaN where the draw says nothing of the risk under
the setting. The number of draws may differ from risk to risk. What a setting is certified for is the probability of the
draws that say something under it."""


def certified(learn: Exceeded, test: Exceeded, levels: Mapping[str, float], confidence: float) -> tuple[int, ...]:
    """The settings that keep every risk within its level, all of them at once with this confidence; the most promising
    first.

    learn, test: the same risks and settings on draws that have nothing in common; levels: largest share of draws that
    may exceed, by risk; confidence: of the whole answer [0, 1]. A setting under which no draw says anything of a risk
    is not certified. ValueError for a risk of which no draw says anything under any.
    """
    names = tuple(levels)
    risks = [BinaryRisk(_exceeds, partial(_is_of, risk=k), higher_is_better=False) for k in range(len(names))]
    alone = len(risks) == 1
    rows = [_rows(exceeded, names) for exceeded in (learn, test)]
    known = [~np.isnan(exceeded[name]).all(axis=0) for exceeded in (learn, test) for name in names]
    settings = np.flatnonzero(np.all(known, axis=0))  # MAPIE's p-value of no draws is NaN, and spoils the order
    if len(settings) == 0:
        return ()

    def outcome(of: Any, *setting: Any) -> Any:  # MAPIE asks for each setting by its number
        which, row = np.asarray(of).T
        return rows[which[0]].exceeds[row, int(setting[0])]

    controller = BinaryClassificationController(
        outcome,
        risks[0] if alone else risks,
        float(levels[names[0]]) if alone else [float(levels[name]) for name in names],
        confidence,
        risks[0],
        settings[:, None],
        "split_fixed_sequence",
    )
    with warnings.catch_warnings():  # that none is certified, or all are, is an answer and no mishap
        warnings.simplefilter("ignore", UserWarning)
        controller.learn_fixed_sequence_order(rows[0].numbers(0), rows[0].risk, binary=True)
        controller.calibrate(rows[1].numbers(1), rows[1].risk)
    return tuple(int(setting) for setting in np.ravel(controller.valid_predict_params))


def least_level(n_draws: int, confidence: float, exceeding: int = 0) -> float:
    """The smallest level that a setting could be certified for if `exceeding` of `n_draws` draws exceeded."""
    if n_draws < 1 or exceeding >= n_draws:
        return 1.0

    def excess(level: float) -> float:
        share = np.array([exceeding / n_draws])
        return float(compute_hoeffding_bentkus_p_value(share, n_draws, level, binary=True)[0, 0]) - (1 - confidence)

    bracket = (max(exceeding / n_draws, 1e-9), 1 - 1e-9)
    return float(root_scalar(excess, bracket=bracket, xtol=1e-6).root) if excess(bracket[1]) < 0 else 1.0


def least_draws(level: float, confidence: float) -> int:
    """How many draws, none of them exceeding, certify a level."""
    low, high = 1, 1
    while least_level(high, confidence) > level:
        low, high = high, 2 * high
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if least_level(middle, confidence) <= level else (middle + 1, high)
    return low


@dataclass(frozen=True, eq=False)
class Watched:
    """A stream of yes and no against what the declared domain shows."""

    limit: float
    """Share above which the domain is left: the reference's upper bound and the tolerance."""
    lower_bounds: Float[np.ndarray, "n"]
    """Of the stream's share after each of its observations, all at once with the confidence asked for."""

    @property
    def alarm(self) -> int | None:
        """Number of the observation, from 0, at which the domain is known to be left; None = still inside."""
        beyond = np.flatnonzero(self.lower_bounds > self.limit)
        return int(beyond[0]) if len(beyond) else None


def watched(
    reference: Bool[np.ndarray, "n_reference"], stream: Bool[np.ndarray, "n"], false_alarms: float, tolerance: float
) -> Watched:
    """Hold a stream against a reference.

    false_alarms: probability that a stream of the reference's own domain, however long, ever raises an alarm;
    tolerance: what the share may rise by [-].
    """
    risk = BinaryRisk(_exceeds, lambda true, found: np.ones(len(found), bool), higher_is_better=False)
    monitor = RiskMonitoring(risk, false_alarms, tolerance, warn=False)
    monitor.compute_threshold(np.zeros(len(reference), int), reference.astype(int))
    assert monitor.threshold is not None
    if len(stream):
        monitor.update(np.zeros(len(stream), int), stream.astype(int))
    return Watched(float(monitor.threshold), monitor.online_risk_lower_bound_sequence_history)


@dataclass(frozen=True, eq=False)
class _Rows:
    """Draws of all risks below each other."""

    risk: Int[np.ndarray, "n"]
    exceeds: Float[np.ndarray, "n k"]

    def numbers(self, which: int) -> Int[np.ndarray, "n 2"]:
        return np.stack([np.full(len(self.risk), which), np.arange(len(self.risk))], axis=1)


def _rows(exceeded: Exceeded, names: Sequence[str]) -> _Rows:
    known = [exceeded[name][~np.isnan(exceeded[name]).all(axis=1)] for name in names]
    for name, found in zip(names, known, strict=True):
        if len(found) == 0:
            raise ValueError(f"{name}: no draw says anything of it; draw more, or leave the risk out")
    return _Rows(np.repeat(np.arange(len(names)), [len(found) for found in known]), np.concatenate(known))


def _exceeds(_true: Int[np.ndarray, "n"], found: Num[np.ndarray, "n"]) -> Bool[np.ndarray, "n"]:
    return np.asarray(found) == 1


def _is_of(true: Int[np.ndarray, "n"], found: Float[np.ndarray, "n"], risk: int) -> Bool[np.ndarray, "n"]:
    """Draws of the risk that say something of it under the setting."""
    return (np.asarray(true) == risk) & ~np.isnan(found)
