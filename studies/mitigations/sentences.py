"""A study of mitigations in plain words, all of them made from its figures."""

from collections.abc import Sequence
from statistics import median

from studies.advise.advice import WORTH_IT, joined_words
from studies.advise.sentences import POSES_FOR_INTERVALS
from studies.base.numbers_as_text import counted
from studies.mitigations.answers import CaseAnswer
from studies.mitigations.common_advice import DEPENDS, MAJORITY, SELDOM, UNTRIED, JudgedAdvice
from studies.mitigations.tallies import RemedyTally
from studies.sensitivity.trust import spoken

MOST_WINNERS = 3
"""Remedies that the first sentence names (choice: what is remembered)."""


def study_paragraph(answers: Sequence[CaseAnswer], found: Sequence[RemedyTally]) -> str:
    """What wins where, in a few sentences."""
    if not answers:
        return "No case is measured yet."
    needing = [answer for answer in answers if answer.needs_help]
    won = [answer for answer in needing if answer.winner]
    words = [_need_words(answers, needing, won)]
    winners = [one for one in found if one.wins][:MOST_WINNERS]
    if winners:
        listed = joined_words([f"{one.words} ({one.wins})" for one in winners])
        words.append(f"What wins most cases: {listed}.")
        gains = [answer.winner.gain for answer in won if answer.winner]
        base, best = _mean([a.advice.base.right_share for a in won]), _mean([a.advice.best.right_share for a in won])
        words.append(
            f"Where a remedy wins, right depth goes from {100 * base:.0f} % to {100 * best:.0f} % in the mean, by "
            f"{100 * median(gains):.0f} points in the median{_spray_words(won)}."
        )
    return " ".join(words)


def _need_words(answers: Sequence[CaseAnswer], needing: Sequence[CaseAnswer], won: Sequence[CaseAnswer]) -> str:
    rest = len(answers) - len(needing)
    only = sum(answer.advice.kind == "only spray" for answer in needing)
    words = f"In {len(won)} of {counted(len(answers), 'case')} a remedy helps that leaves the part as it is"
    words += f", in {only} nothing but spray does" if only else ""
    return words + (f", in {rest} nothing is needed." if rest else ".")


def _spray_words(won: Sequence[CaseAnswer]) -> str:
    sprayed = [answer.advice.ceiling.right_share for answer in won if answer.advice.ceiling]
    return f"; spray gives {100 * _mean(sprayed):.0f} %" if sprayed else ""


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def advice_lines(found: Sequence[JudgedAdvice]) -> list[str]:
    """Every piece that was tried, one line each."""
    return [f"{one.words}: {advice_verdict_words(one)}" for one in found if one.verdict != UNTRIED]


def advice_verdict_words(one: JudgedAdvice) -> str:
    """Its verdict, the figures that it rests on, and what it depends on."""
    if one.verdict == UNTRIED or one.gain is None:
        return "not tried on any case that needs help"
    clauses = [_counts_words(one), *harm_words(one), depends_words(one)]
    return f"{one.verdict}: {'; '.join(filter(None, clauses))}."


def _counts_words(one: JudgedAdvice) -> str:
    assert one.gain is not None
    interval = f"{100 * one.low:.0f}-{100 * one.high:.0f}"
    gain = f"{100 * one.gain.value:+.1f} points in the median ({100 * one.gain.low:+.1f} to {100 * one.gain.high:+.1f})"
    part = "" if len(one.remedies) == 1 else f" with {len(one.remedies)} ways of doing it"
    return f"helps in {100 * one.share:.0f} % ({interval}) of {counted(one.cases, 'case')}{part}, {gain}"


def harm_words(one: JudgedAdvice) -> list[str]:
    """In how many cases it hurts or makes depth up; nothing of what it does nowhere."""
    whole = sum(one.counts.values())
    return [
        f"{words} in {100 * one.counts[name] / whole:.0f} %"
        for name, words in (("hurts", "hurts"), ("trades", "adds more false depth than right depth"))
        if one.counts[name]
    ]


def depends_words(one: JudgedAdvice) -> str:
    """Where it helps and where not; empty where nothing stands out."""
    if one.verdict != DEPENDS or not one.by:
        return ""
    mostly = [spoken(name) for name, share, _ in one.groups if share >= MAJORITY]
    seldom = [spoken(name) for name, share, _ in one.groups if share <= SELDOM]
    words = [f"mostly on {joined_words(mostly)}"] if mostly else []
    words += [f"seldom on {joined_words(seldom)}"] if seldom else []
    return f"what decides most is the {one.by}: {', '.join(words)}" if words else ""


def poses_caveat(poses: int) -> str:
    """How far the verdict on a single case can be trusted; empty with poses enough."""
    if poses >= POSES_FOR_INTERVALS:
        return ""
    chance = 1 / 2**poses
    return (
        f"Each case has {counted(poses, 'pose')}: where a remedy changes nothing but noise, all of them agree by "
        f"chance in {100 * chance:.0f} % of cases that it helps, and in as many that it hurts. So a gain counts from "
        f"{100 * WORTH_IT:.0f} points on, and what is said rests on many cases, not on one."
    )
