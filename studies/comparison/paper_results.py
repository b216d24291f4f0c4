"""What of the FRA-NBV paper's section VI a comparison finds again, in words.

The rules by which a sentence counts as found stand beside it. They follow from the paper's words, not from any run.
"""

from collections.abc import Sequence

from studies.base.numbers_as_text import number, percent
from studies.comparison.paper_numbers import (
    CONTRIBUTION_OF_MATTE,
    CONTRIBUTION_OF_SHINY,
    FRA_LESS_PB_ON_D,
    FRA_LESS_RE_ON_D,
)
from studies.comparison.paper_times import time_findings
from studies.comparison.paper_verdicts import (
    BASELINES,
    DIRECTION,
    FOUND,
    NEAR_SHARE,
    NOT_FOUND,
    TOO_FEW,
    UNKNOWN,
    Finding,
    adjusted_p,
    judged,
    lead_verdict,
    weakest,
)
from studies.comparison.preset import CORNER
from studies.comparison.statistics import Comparison
from studies.comparison.view_increments import Advantage, recovery_advantage
from studies.statistics.intervals import LEVEL, Difference, Interval, least_p

COMPARABLE = 0.03
"""Coverages that differ by no more are comparable, a clear gap is more (choice: the goal set for this comparison)."""
CONTRIBUTION_SLACK = 1.5
"""Factor by which "around 10 %" and "up to 30 %" may be missed (choice: they are read off a bar chart)."""


def paper_findings(comparison: Comparison) -> list[Finding]:
    """All sentences in the paper's order; the corner's stands in its conclusions."""
    adjusted = adjusted_p(comparison)
    return [
        _activations(comparison),
        _comparable(comparison, "pb"),
        _comparable(comparison, "re"),
        _slightly_higher(comparison, adjusted),
        _lead(comparison, adjusted, ("C", "pb"), "a clear gap", COMPARABLE),
        _lead(comparison, adjusted, ("C", "re"), "a clear gap", COMPARABLE),
        _lead(comparison, adjusted, ("D", "pb"), "up to 31 %", FRA_LESS_PB_ON_D),
        _lead(comparison, adjusted, ("D", "re"), "approximately 56 %", FRA_LESS_RE_ON_D),
        _contributions(comparison),
        _increments_alike(comparison),
        _increments_higher(comparison),
        *time_findings(comparison),
        _lead(comparison, adjusted, (CORNER, "pb"), "less affected", 0.0),
    ]


def points(difference: Difference | None) -> str:
    """`+31.0 points (+25.1 to +36.4)`; a single run has no interval."""
    return "n/a" if difference is None else interval_points(difference.interval)


def interval_points(i: Interval) -> str:
    """The same of a mean that is a difference."""
    interval = f"{100 * i.low:+z.1f} to {100 * i.high:+z.1f}" if i.count > 1 else "one run"
    return f"{100 * i.mean:+z.1f} points ({interval})".replace("-", "\u2212")


def _lead(
    comparison: Comparison,
    adjusted: dict[tuple[str, str], float],
    where: tuple[str, str],
    paper: str,
    more_than: float,
) -> Finding:
    """where: part and baseline. more_than: what the mean must reach."""
    part, baseline = where
    end = comparison.difference(part, "fra", baseline)
    equal = [comparison.difference(part, "fra", baseline, "acquisitions", cloud) for cloud in ("raw", "filtered")]
    place = "In the inside corner" if part == CORNER else f"On {part}"
    return Finding(
        words=f"{place} FRA covers more than {baseline.upper()}",
        paper=paper,
        rule=f"mean {'above 0' if more_than == 0 else f'at least {100 * more_than:.0f} points'}, {_SURE}",
        ours=_with_p(end, adjusted.get(where)),
        verdict=lead_verdict(end, adjusted.get(where, 1.0), len(adjusted), more_than),
        otherwise=f"{points(equal[0])}; map-filtered {points(equal[1])}" if end else "n/a",
    )


_SURE = f"adjusted p \u2264 {LEVEL:.2g}"


def _with_p(difference: Difference | None, adjusted: float | None) -> str:
    return points(difference) + (f", p {adjusted:.2g}" if adjusted is not None else "")


def _comparable(comparison: Comparison, baseline: str) -> Finding:
    found = {part: comparison.difference(part, "fra", baseline) for part in "AB"}
    known = [difference.interval.mean for difference in found.values() if difference]
    equal = {part: comparison.difference(part, "fra", baseline, "acquisitions") for part in found}
    return Finding(
        words=f"On A and B FRA and {baseline.upper()} cover alike",
        paper="comparable",
        rule=f"means within {100 * COMPARABLE:.0f} points on both",
        ours="; ".join(f"{part} {points(difference)}" for part, difference in found.items()),
        verdict=judged(len(known) == len(found), lambda: all(abs(mean) <= COMPARABLE for mean in known)),
        otherwise="; ".join(f"{part} {points(difference)}" for part, difference in equal.items()),
    )


def _slightly_higher(comparison: Comparison, adjusted: dict[tuple[str, str], float]) -> Finding:
    where = [(part, baseline) for part in "AB" for baseline in BASELINES]
    found = {place: comparison.difference(place[0], "fra", place[1]) for place in where}
    verdicts = [lead_verdict(d, adjusted.get(place, 1.0), len(adjusted), 0.0) for place, d in found.items()]
    return Finding(
        words="On A and B FRA covers slightly more than both",
        paper="slightly higher",
        rule=f"all four means above 0, {_SURE}",
        ours="; ".join(
            f"{part} \u2212 {baseline.upper()} {_with_p(d, adjusted.get((part, baseline)))}"
            for (part, baseline), d in found.items()
        ),
        verdict=weakest(verdicts),
    )


def _activations(comparison: Comparison) -> Finding:
    means = _means(comparison, "recovery_activations")
    known = [mean for mean in means if mean is not None]
    return Finding(
        words="Recoveries are few on A and B, many on C and D, and rise from part to part",
        paper="an increasing trend",
        rule="means A \u2264 B < C < D; in direction: A and B below C and D",
        ours=", ".join(f"{part} {number(mean, '.1f')}" for part, mean in zip("ABCD", means, strict=True)),
        verdict=judged(len(known) == 4, lambda: rising(known), lambda: max(known[:2]) < min(known[2:])),
    )


def rising(activations: Sequence[float]) -> bool:
    """A <= B < C < D."""
    a, b, c, d = activations
    return a <= b < c < d


def _contributions(comparison: Comparison) -> Finding:
    means = _means(comparison, "recovery_share")
    known = [mean for mean in means if mean is not None]
    matte, shiny = CONTRIBUTION_SLACK * CONTRIBUTION_OF_MATTE, CONTRIBUTION_OF_SHINY / CONTRIBUTION_SLACK

    def higher() -> bool:
        return min(known[2:]) > max(known[:2])

    return Finding(
        words="Recovery views bring a small share of the coverage on A and B, a larger one on C and D",
        paper="around 10 % on A and B, up to approximately 30 % on C and D",
        rule=f"A and B at most {100 * matte:.0f} %, C and D more, one of them at least {100 * shiny:.0f} %; "
        "in direction: C and D above A and B",
        ours=", ".join(f"{part} {percent(mean)}" for part, mean in zip("ABCD", means, strict=True)),
        verdict=judged(
            len(known) == 4, lambda: higher() and max(known[:2]) <= matte and max(known[2:]) >= shiny, higher
        ),
    )


def _increments_alike(comparison: Comparison) -> Finding:
    found = recovery_advantage(comparison, "B")
    verdict = UNKNOWN
    if found is not None:
        i = found.gain
        verdict = judged(True, lambda: abs(i.mean) <= NEAR_SHARE * found.pb, lambda: i.low <= 0 <= i.high)
        verdict = TOO_FEW if least_p(i.count) > LEVEL else verdict
    return Finding(
        words="On B a recovery view adds as much as a PB view at the same coverage",
        paper="comparable",
        rule=f"within {100 * NEAR_SHARE:.0f} % of what a PB view adds; in direction: not told from it",
        ours=_advantage_words(found),
        verdict=verdict,
    )


def _increments_higher(comparison: Comparison) -> Finding:
    found = recovery_advantage(comparison, "D")
    verdict = UNKNOWN
    if found is not None:
        i = found.gain
        sure = TOO_FEW if least_p(i.count) > LEVEL else FOUND if i.low > 0 else DIRECTION
        verdict = sure if i.mean > 0 else NOT_FOUND
    return Finding(
        words="On D a recovery view adds more than a PB view at the same coverage",
        paper="statistically higher",
        rule="95 % interval above 0, whole runs drawn",
        ours=_advantage_words(found),
        verdict=verdict,
    )


def _advantage_words(found: Advantage | None) -> str:
    if found is None:
        return "too few views"
    return f"{interval_points(found.gain)} a view beside PB's {100 * found.pb:.1f}, {found.gain.count} runs"


def _means(comparison: Comparison, name: str) -> list[float | None]:
    found = [comparison.figure(part, "fra", name) for part in "ABCD"]
    return [interval.mean if interval else None for interval in found]
