"""Settings chosen from scored draws: what the budget can promise, what is certified, what would be chosen naively.

Draws are split by chance: on some the order of the settings is learned, the others certify. The choice among certified
settings looks at the learning draws alone, as any choice among them may.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from materials.input_error import InputError
from studies.thresholds.config import Bearable, Budget
from studies.thresholds.risk_control import certified, least_draws, least_level

Scores = Mapping[str, Float[np.ndarray, "_ k"]]
"""Numbers of every draw under every setting, by risk; NaN where a draw says nothing of the risk."""
SPLIT_STREAM, REPEAT_STREAM = 11, 12
"""Tell the seeds of the split and of its repetitions apart (choice)."""


@dataclass(frozen=True, eq=False)
class Choice:
    """What was found on one split."""

    certified: tuple[int, ...]
    """Settings within all levels, the most promising first."""
    chosen: int | None
    """The one that costs least on the learning draws; None = none is certified."""
    naive: int | None
    """What would be chosen if the shares of the certifying draws were taken for the truth."""


@dataclass(frozen=True)
class Repetitions:
    """The choice made again and again on other splits, and judged by draws that it has not seen."""

    runs: int
    violations: int
    """Times that the chosen setting exceeded a level on the unseen draws."""
    naive_violations: int
    """Times that the naive one did."""
    silent: int
    """Times that no setting was certified: such a choice promises nothing and breaks nothing."""

    def allowed(self, confidence: float) -> float:
        """Most violations that agree with the confidence: two standard errors above their expectation."""
        share = 1 - confidence
        return self.runs * share + 2 * float(np.sqrt(self.runs * share * (1 - share)))


def exceeded(
    scores: Scores, risks: Mapping[str, Bearable], cameras: Int[np.ndarray, "k"] | None = None
) -> dict[str, Float[np.ndarray, "_ k"]]:
    """1 where a draw exceeds what is borne, 0 where not, NaN where it says nothing of the risk under some setting of
    the same camera.

    cameras: a number for the camera of each setting, since what one camera shows of a draw says nothing of what another
    does; None = all have the same.
    """
    found = {}
    for name, bearable in risks.items():
        numbers = scores[name]
        of_camera = np.zeros(numbers.shape[1], int) if cameras is None else cameras
        silent = np.isnan(numbers)
        for camera in np.unique(of_camera):
            silent[:, of_camera == camera] |= silent[:, of_camera == camera].any(axis=1, keepdims=True)
        found[name] = np.where(silent, np.nan, (numbers > bearable.most).astype(float))
    return found


def known_mean(numbers: Float[np.ndarray, "_ k"]) -> Float[np.ndarray, "k"]:
    """Mean over the draws that say something; NaN where none does."""
    known = ~np.isnan(numbers)
    n = known.sum(axis=0)
    total = np.where(known, numbers, 0.0).sum(axis=0)
    return np.divide(total, n, out=np.full(n.shape, np.nan), where=n > 0)


def check_budget(n_draws: Mapping[str, int], risks: Mapping[str, Bearable], budget: Budget, confidence: float) -> None:
    """InputError where no outcome of that many draws could certify a level. n_draws: of all, by risk."""
    for name, bearable in risks.items():
        n = n_draws[name] - round(budget.learn_share * n_draws[name])
        reached = least_level(n, confidence)
        if reached > bearable.level:
            needed = int(np.ceil(least_draws(bearable.level, confidence) / (1 - budget.learn_share)))
            raise InputError(
                f"risks: `{name}.level` = {bearable.level:g}: {n} certifying draws reach {reached:.3g} at confidence "
                f"{confidence:g}, if none exceeds; draw {needed} or more, or state {reached:.2g}"
            )


def budget_sentence(n_draws: Mapping[str, int], budget: Budget, confidence: float) -> list[str]:
    """What the budget can certify, in words, a line per risk."""
    lines = []
    for name, total in n_draws.items():
        n = total - round(budget.learn_share * total)
        lines.append(
            f"{name}: {n} of {total} draws certify; without one that exceeds they promise "
            f"{100 * least_level(n, confidence):.2g} % at confidence {confidence:g}"
        )
    return lines


def choose_setting(
    scores: Scores,
    risks: Mapping[str, Bearable],
    prefer: str,
    learn: Mapping[str, Int[np.ndarray, "_"]],
    test: Mapping[str, Int[np.ndarray, "_"]],
    confidence: float,
    cameras: Int[np.ndarray, "k"] | None = None,
) -> Choice:
    """Learn the order on some draws of each risk, certify on others.

    prefer: name of the numbers whose mean over the learning draws decides among certified settings, the lower the
    better, and among naive ones likewise. cameras: as in `exceeded`.
    """
    costs = np.nan_to_num(known_mean(scores[prefer][learn[prefer]]))  # of a domain without holes nothing is missed
    flags, levels = exceeded(scores, risks, cameras), {name: bearable.level for name, bearable in risks.items()}
    learned, tested = ({name: flags[name][rows[name]] for name in risks} for rows in (learn, test))
    valid = certified(learned, tested, levels, confidence)
    beyond = np.stack([known_mean(tested[name]) - levels[name] for name in risks])
    within = np.flatnonzero((beyond <= 0).all(axis=0))
    return Choice(valid, _cheapest(valid, costs), _cheapest(within.tolist(), costs))


def _cheapest(settings: Sequence[int], costs: Float[np.ndarray, "k"]) -> int | None:
    return min(settings, key=lambda setting: (costs[setting], setting), default=None)


def split(n: int, shares: Sequence[float], rng: np.random.Generator) -> list[Int[np.ndarray, "_"]]:
    """Numbers of n draws dealt out by these shares, which add up to 1."""
    ends = np.rint(np.cumsum([0.0, *shares]) * n).astype(int)
    order = rng.permutation(n)
    return [order[low:high] for low, high in pairwise(ends)]


def repeated(
    scores: Scores,
    risks: Mapping[str, Bearable],
    prefer: str,
    budget: Budget,
    confidence: float,
    seed: int,
    cameras: Int[np.ndarray, "k"] | None = None,
) -> Repetitions:
    """How often choices are wrong: a third of the draws judges, the rest learns and certifies, dealt anew each time.

    cameras: as in `exceeded`.
    """
    rng = np.random.default_rng([seed, REPEAT_STREAM])
    shares = (2 / 3 * budget.learn_share, 2 / 3 * (1 - budget.learn_share), 1 / 3)
    flags = exceeded(scores, risks, cameras)
    violations = naive = silent = 0
    for _ in range(budget.repetitions):
        by_number = {n: split(n, shares, rng) for n in sorted({len(numbers) for numbers in scores.values()})}
        dealt = {name: by_number[len(scores[name])] for name in (*risks, prefer)}  # a draw is dealt once for all risks
        learn, test, judge = ({name: rows[k] for name, rows in dealt.items()} for k in range(3))
        choice = choose_setting(scores, risks, prefer, learn, test, confidence, cameras)
        silent += choice.chosen is None
        violations += breaks(flags, risks, choice.chosen, judge)
        naive += breaks(flags, risks, choice.naive, judge)
    return Repetitions(budget.repetitions, violations, naive, silent)


def breaks(
    flags: Mapping[str, Float[np.ndarray, "_ k"]],
    risks: Mapping[str, Bearable],
    setting: int | None,
    rows: Mapping[str, Int[np.ndarray, "_"]],
) -> bool:
    """Whether a setting exceeds any level on these draws; no setting breaks nothing."""
    if setting is None:
        return False
    return any(float(known_mean(flags[name][rows[name]])[setting]) > risks[name].level for name in risks)
