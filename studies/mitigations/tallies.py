"""Every remedy over all cases: in how many it helps, is level, trades or hurts, and what it gains in the median."""

from collections.abc import Sequence
from dataclasses import dataclass

from studies.advise.advice import WORTH_IT, RemedyScore
from studies.mitigations.answers import CaseAnswer
from studies.statistics.medians import MedianEstimate, median_interval

TOLD_VERDICTS = ("helps", "level", "trades", "hurts")
"""Of a remedy on a case, as `told_verdict` says them."""


@dataclass(frozen=True)
class RemedyTally:
    """One remedy over the cases in which it was tried."""

    name: str
    """`factor: level`."""
    words: str
    """What to do."""
    cost: str
    is_ceiling: bool
    cases: int
    counts: dict[str, int]
    """Cases by verdict, of all four."""
    wins: int
    """Cases in which it is what is advised."""
    gain: MedianEstimate
    """Right share beyond the camera as it is set, median over cases with its 95 % interval over them."""


def tallies(answers: Sequence[CaseAnswer]) -> list[RemedyTally]:
    """Those that win most cases first, then by their median gain."""
    by_name: dict[str, list[tuple[CaseAnswer, RemedyScore]]] = {}
    for answer in answers:
        for name, score in answer.scores.items():
            by_name.setdefault(name, []).append((answer, score))
    found = [_tally(name, pairs) for name, pairs in by_name.items()]
    return sorted(found, key=lambda one: (one.is_ceiling, -one.wins, -one.gain.value, one.name))


def _tally(name: str, pairs: Sequence[tuple[CaseAnswer, RemedyScore]]) -> RemedyTally:
    scores = [score for _, score in pairs]
    return RemedyTally(
        name,
        scores[0].words,
        scores[0].cost,
        scores[0].is_ceiling,
        len(scores),
        counted_verdicts(scores),
        sum(is_winner(answer, score) for answer, score in pairs),
        median_interval([score.gain for score in scores]),
    )


def is_winner(answer: CaseAnswer, score: RemedyScore) -> bool:
    """Whether this is what is advised on the case."""
    winner = answer.winner
    return winner is not None and (winner.name, winner.level) == (score.name, score.level)


def told_verdict(score: RemedyScore) -> str:
    """Of a remedy on a case: that of the advice, but `level` where it helps or hurts by less than is worth it."""
    small = score.verdict in ("helps", "hurts") and abs(score.gain) < WORTH_IT
    return "level" if small else score.verdict


def counted_verdicts(scores: Sequence[RemedyScore]) -> dict[str, int]:
    """How many there are of each."""
    told = [told_verdict(score) for score in scores]
    return {verdict: told.count(verdict) for verdict in TOLD_VERDICTS}
