"""What people advise on shiny metal, held against every case: right nearly everywhere, wrong nearly everywhere, or not.

A piece of advice is a remedy or several, such as all lower laser powers; where a case has several, each counts in part.
Cases that need nothing (`studies.advise.advice.verdict_kind`) are left out: there advice cannot show itself.
Intervals of the share of cases are Clopper and Pearson's (1934) with the case as the unit: exact for one remedy a case,
and too wide rather than too narrow for several, whose verdicts on one case go together.
"""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass

from scipy import stats

from studies.advise.advice import WORTH_IT, RemedyScore
from studies.advise.setup import Setup
from studies.mitigations.answers import CaseAnswer
from studies.mitigations.tallies import TOLD_VERDICTS, counted_verdicts, told_verdict
from studies.statistics.intervals import CONFIDENCE
from studies.statistics.medians import MedianEstimate, median_interval

NEARLY, SELDOM = 0.8, 0.2
"""Shares of cases from which on advice is right nearly everywhere, and up to which it is wrong there (choice: four in
five, and one in five)."""
LEAST_EXPLAINED = 0.1
"""Variance between cases that a material's finish, metal or shape must explain to be named [0, 1] (choice: below it
looks like chance with a dozen groups)."""
MAJORITY = 0.5
"""Share of cases that is most of them."""
FEW_CASES = 6
"""Of fewer cases nothing is said (choice: all of five alike leave a half within the interval, 0.5^5 being 3.1 %)."""
NEARLY_RIGHT, NEARLY_WRONG = "right nearly everywhere", "wrong nearly everywhere"
DEPENDS, TOO_FEW_CASES, UNTRIED = "depends", "too few cases to say", "not tried"
NOT_TOLD_APART = "gains over all cases, told apart in few"
"""Verdicts. That of advice which is right or wrong nearly everywhere needs an interval on one side of a half; and what
is level in most cases, but gains in their median beyond doubt, is not called wrong: more poses would tell it apart."""

Meant = Callable[[RemedyScore, Setup, Setup], bool]
"""Whether a remedy is what the advice means; the setups are that of the camera as it is set, and with the remedy."""


@dataclass(frozen=True)
class PieceOfAdvice:
    """As people say it."""

    words: str
    meant: Meant
    bare_metal_only: bool = False
    """Given for uncoated metal alone."""


@dataclass(frozen=True)
class JudgedAdvice:
    """A piece of advice over the cases that need help."""

    words: str
    remedies: tuple[str, ...]
    """What was tried of it."""
    cases: int
    counts: dict[str, int]
    """Verdicts of all of its remedies on all cases; as many as cases where there is one remedy."""
    share: float
    """Of the cases in which it helps [0, 1]."""
    low: float
    """95 % interval of it."""
    high: float
    gain: MedianEstimate | None
    """Mean over its remedies, median over cases; None without cases."""
    verdict: str
    """NEARLY_RIGHT, NEARLY_WRONG, NOT_TOLD_APART, DEPENDS, TOO_FEW_CASES or UNTRIED."""
    by: str
    """What it depends on most: `finish`, `metal` or `coupon`; empty where nothing stands out."""
    groups: tuple[tuple[str, float, int], ...]
    """Of that: name, share in which it helps, cases."""


def _named(factor: str, *starts: str) -> Meant:
    return lambda score, _, __: score.name == factor and (not starts or score.level.startswith(starts))


def _lower_laser(score: RemedyScore, base: Setup, changed: Setup) -> bool:
    power = changed.sensor.imager.laser_power_mw
    return score.name == "laser" and 0 < power < base.sensor.imager.laser_power_mw


def _higher_laser(score: RemedyScore, base: Setup, changed: Setup) -> bool:
    return score.name == "laser" and changed.sensor.imager.laser_power_mw > base.sensor.imager.laser_power_mw


def _darker(score: RemedyScore, base: Setup, changed: Setup) -> bool:
    return score.name == "set-point" and changed.sensor.imager.set_point < base.sensor.imager.set_point


def _nearer(score: RemedyScore, base: Setup, changed: Setup) -> bool:
    return score.name == "stand-off" and changed.stand.distance < base.stand.distance


def _farther(score: RemedyScore, base: Setup, changed: Setup) -> bool:
    return score.name == "stand-off" and changed.stand.distance > base.stand.distance


COMMON_ADVICE = (
    PieceOfAdvice("Lower the laser", _lower_laser),
    PieceOfAdvice("Raise the laser", _higher_laser),
    PieceOfAdvice("Expose darker", _darker),
    PieceOfAdvice("Use the preset High Accuracy", _named("preset", "high_accuracy")),
    PieceOfAdvice("Use the preset High Density", _named("preset", "high_density")),
    PieceOfAdvice("Take an HDR pair", _named("HDR pair")),
    PieceOfAdvice("Take the median of frames", _named("frames")),
    PieceOfAdvice("Run the temporal filter", _named("filters", "temporal filter")),
    PieceOfAdvice("Fill holes", _named("filters", "hole filling")),
    PieceOfAdvice("Run the recommended chain", _named("filters", "recommended chain")),
    PieceOfAdvice("Put a polariser before the imagers, on bare metal", _named("polarisers", "on the imagers"), True),
    PieceOfAdvice("Cross polarisers, on bare metal", _named("polarisers", "crossed"), True),
    PieceOfAdvice("Put on a band-pass filter", _named("band-pass filter")),
    PieceOfAdvice("Switch the lamps off", _named("lamps", "off")),
    PieceOfAdvice("Diffuse the light", _named("placing of lamps", "diffuse")),
    PieceOfAdvice("Tilt the part", _named("tilt of the part")),
    PieceOfAdvice("Turn the camera about its axis", _named("roll")),
    PieceOfAdvice("Go nearer", _nearer),
    PieceOfAdvice("Step back", _farther),
    PieceOfAdvice("Look a second time", _named("second look")),
)
"""What is heard most; choice."""


def judged_advice(answers: Sequence[CaseAnswer]) -> list[JudgedAdvice]:
    """All pieces, in their order."""
    return [judged_piece(piece, answers) for piece in COMMON_ADVICE]


def judged_piece(piece: PieceOfAdvice, answers: Sequence[CaseAnswer]) -> JudgedAdvice:
    """One piece over the cases that need help and in which it was tried."""
    found = [
        (answer, scores)
        for answer in answers
        if answer.needs_help and (answer.case.finish or not piece.bare_metal_only)
        if (scores := _meant(piece, answer))
    ]
    if not found:
        return JudgedAdvice(piece.words, (), 0, dict.fromkeys(TOLD_VERDICTS, 0), 0.0, 0.0, 1.0, None, UNTRIED, "", ())
    helped = [sum(told_verdict(score) == "helps" for score in scores) / len(scores) for _, scores in found]
    every = [score for _, scores in found for score in scores]
    share = sum(helped) / len(helped)
    low, high = share_interval(share, len(helped))
    counts = counted_verdicts(every)
    gain = median_interval([sum(score.gain for score in scores) / len(scores) for _, scores in found])
    verdict = advice_verdict(share, low, high, len(found))
    if verdict == NEARLY_WRONG and gain.low >= WORTH_IT and counts["level"] > MAJORITY * len(every):
        verdict = NOT_TOLD_APART
    by, groups = what_explains([answer for answer, _ in found], helped) if verdict == DEPENDS else ("", ())
    return JudgedAdvice(
        piece.words,
        tuple(dict.fromkeys(f"{score.name}: {score.level}" for score in every)),
        len(found),
        counts,
        share,
        low,
        high,
        gain,
        verdict,
        by,
        groups,
    )


def advice_verdict(share: float, low: float, high: float, cases: int) -> str:
    """Of a share of cases in which advice helps, with its interval."""
    if cases < FEW_CASES:
        return TOO_FEW_CASES
    if share >= NEARLY:
        return NEARLY_RIGHT if low > MAJORITY else TOO_FEW_CASES
    if share <= SELDOM:
        return NEARLY_WRONG if high < MAJORITY else TOO_FEW_CASES
    return DEPENDS


def _meant(piece: PieceOfAdvice, answer: CaseAnswer) -> list[RemedyScore]:
    base = answer.tried[0].setup
    setups = {one.remedies[0].title: one.setup for one in answer.tried if one.remedies}
    return [score for name, score in answer.scores.items() if piece.meant(score, base, setups[name])]


def share_interval(share: float, cases: int) -> tuple[float, float]:
    """95 % interval of a share of cases; cases that count in part do so in the beta laws as well."""
    tail, found = (1 - CONFIDENCE) / 2, share * cases
    low = float(stats.beta.ppf(tail, found, cases - found + 1)) if found > 0 else 0.0
    high = float(stats.beta.ppf(1 - tail, found + 1, cases - found)) if found < cases else 1.0
    return low, high


def what_explains(
    answers: Sequence[CaseAnswer], helped: Sequence[float]
) -> tuple[str, tuple[tuple[str, float, int], ...]]:
    """Which of finish, metal and coupon explains most of the differences between cases, adjusted for how many groups
    it makes of them (Fisher's adjusted share of variance), and its groups, the best first."""
    best, best_share = "", LEAST_EXPLAINED
    for by, key in GROUPINGS.items():
        share = explained_share([key(answer) for answer in answers], helped)
        if share > best_share:
            best, best_share = by, share
    if not best:
        return "", ()
    means = _by_group([GROUPINGS[best](answer) for answer in answers], helped)
    rows = [(str(name), sum(values) / len(values), len(values)) for name, values in means.items()]
    return best, tuple(sorted(rows, key=lambda row: -row[1]))


GROUPINGS: dict[str, Callable[[CaseAnswer], Hashable]] = {
    "finish": lambda answer: answer.case.finish or answer.case.material,
    "metal": lambda answer: answer.case.metal,
    "coupon": lambda answer: answer.case.coupon,
}
"""What a piece of advice may depend on."""


def explained_share(groups: Sequence[Hashable], values: Sequence[float]) -> float:
    """Share of the values' variance that lies between groups, 1 - (within / (n - k)) / (all / (n - 1)); 0 where groups
    are one, or as many as the values."""
    n, found = len(values), _by_group(groups, values)
    whole = _squares(values)
    if not 1 < len(found) < n or whole == 0:
        return 0.0
    within = sum(_squares(one) for one in found.values())
    return 1 - (within / (n - len(found))) / (whole / (n - 1))


def _by_group(groups: Sequence[Hashable], values: Sequence[float]) -> dict[Hashable, list[float]]:
    found: dict[Hashable, list[float]] = {}
    for group, value in zip(groups, values, strict=True):
        found.setdefault(group, []).append(value)
    return found


def _squares(values: Sequence[float]) -> float:
    mean = sum(values) / len(values)
    return sum((value - mean) ** 2 for value in values)
