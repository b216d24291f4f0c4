"""An advice in plain words."""

from collections.abc import Mapping, Sequence

from studies.advise.advice import WORTH_IT, Advice, RemedyScore
from studies.base.numbers_as_text import counted

MOST_SHOWN = 8
"""Remedies that the terminal lists (choice: a screen; the page has all)."""

POSES_FOR_INTERVALS = 6
"""From which on a bootstrap's range holds a mean with 95 % (`studies.statistics.intervals`)."""


def advice_sentence(advice: Advice, lost_to: Mapping[str, float]) -> str:
    """What to do, in a sentence or two. lost_to: what the camera as it is set loses surface to, as shares of the part's
    surface by cause; may be empty."""
    base, best, spray = advice.base, advice.best, advice.ceiling
    why = f" What is missing: {loss_words(lost_to)}." if lost_to else ""
    if advice.kind == "remedy":
        would = f"; {_spray_words(spray)} would give {_whole(spray.right_share)} %" if spray else ""
        right = f"right depth on {with_interval(best)} instead of {_whole(base.right_share)} %"
        matte = "" if advice.shine_matters or not spray else " Shine is not what is in the way."
        return _sentence(f"{best.words}: {right}{_false_words(base, best)}{would}.{matte}")
    if advice.kind == "only spray" and spray:
        none = "no other remedy is told apart from the camera as it is set, or adds two points"
        return (
            f"Nothing but spray helps: right depth on {with_interval(base)} as the camera is set, "
            f"{with_interval(spray)} with {_spray_words(spray)}; {none}.{why}"
        )
    if advice.kind == "nothing needed" and spray:
        beside = advice.beside
        more = _sentence(f"{beside.words}: {_whole(beside.right_share)} %, as on matte parts.") if beside else ""
        return (
            f"Nothing is needed against shine: right depth on {with_interval(base)} as the camera is set, and spray "
            f"adds nothing to any setting, {_whole(spray.right_share)} % at the best. {more}".strip()
        )
    return f"No remedy that was tried helps: right depth on {with_interval(base)} as the camera is set.{why}"


def _sentence(text: str) -> str:
    return text[0].upper() + text[1:]


def _spray_words(spray: RemedyScore) -> str:
    """What was done beside spraying, too."""
    beside = [f"{name} {level}" for name, level in zip(spray.name.split(" + "), spray.level.split(" + "), strict=True)]
    return " and ".join(["spray", *beside[1:]])


def _false_words(base: RemedyScore, best: RemedyScore) -> str:
    """What becomes of false depth, where that changes."""
    if abs(best.false_share - base.false_share) < WORTH_IT:
        return ""
    return f", false depth on {_whole(best.false_share)} % instead of {_whole(base.false_share)} %"


def with_interval(score: RemedyScore) -> str:
    """`81 % (76-85)`."""
    return f"{_whole(score.right_share)} % ({_whole(score.lo)}-{_whole(score.hi)})"


def loss_words(lost_to: Mapping[str, float]) -> str:
    """The three largest causes."""
    largest = sorted(lost_to.items(), key=lambda pair: -pair[1])[:3]
    return ", ".join(f"{100 * share:.0f} % {name.replace('_', ' ')}" for name, share in largest if share >= 0.005)


def ranking_lines(advice: Advice) -> list[str]:
    """The best single remedies, and what is known of the rest."""
    shown = advice.remedies[:MOST_SHOWN]
    lines = [
        f"{one.rank:>3}. {one.name}: {one.level}: {with_interval(one)}, {_gain(one)}; "
        f"false {_whole(one.false_share)} %, none {_whole(one.hole_share)} %; costs {one.cost}"
        for one in shown
    ]
    hurt = sum(one.verdict == "hurts" for one in advice.remedies)
    enough = advice.poses >= POSES_FOR_INTERVALS
    few = "" if enough else f" Fewer than {POSES_FOR_INTERVALS} poses: intervals are too narrow."
    level = sum(one.verdict == "level" for one in advice.remedies)
    trade = sum(one.verdict == "trades" for one in advice.remedies)
    rest = (
        f"Of {counted(len(advice.remedies), 'remedy', 'remedies')} {level} are level with the camera as it is set, "
        f"{trade} add more false depth than right depth, "
    )
    return [*lines, f"{rest}{hurt} hurt. {counted(advice.settings, 'setting')} compared at {advice.poses} poses.{few}"]


def untried_line(names: Sequence[str]) -> str:
    """What time did not allow."""
    return f"Not tried for want of time: {', '.join(names)}; give more --minutes." if names else ""


def impossible_line(names: Sequence[str]) -> str:
    """Where the camera cannot stand."""
    return f"Left out, since no camera can stand there from one of the poses: {', '.join(names)}." if names else ""


def _gain(one: RemedyScore) -> str:
    points = f"{100 * one.gain:+.0f} points ({100 * one.gain_lo:+.0f} to {100 * one.gain_hi:+.0f})"
    return f"{points}, {one.verdict}"


def _whole(share: float) -> str:
    return f"{100 * share:.0f}"
