"""What of the FRA-NBV paper's section VI a comparison finds again, in words.

The rules by which a sentence counts as found stand beside it. They follow from the paper's words, not from any run.
"""

from studies.base.numbers_as_text import number
from studies.comparison.goals import rising
from studies.comparison.paper import CONTRIBUTION_OF_MATTE, CONTRIBUTION_OF_SHINY, paper_lead
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
from studies.comparison.records import CONTRIBUTED
from studies.comparison.statistics import Comparison
from studies.comparison.view_increments import Advantage, recovery_advantage
from studies.statistics.intervals import LEVEL, Difference, Interval, least_p

CONTRIBUTION_SLACK = 1.5
"""Factor by which "around 10 %" and "up to 30 %" may be missed (choice: the paper's own median on A lies 1.44
below its words)."""


def paper_findings(comparison: Comparison) -> list[Finding]:
    """All sentences in the paper's order; the corner's stands in its conclusions, and is told where it was run.

    That A and B are covered alike is none of them: the paper's medians differ by up to 13 points there.
    """
    adjusted = adjusted_p(comparison)
    corner = [_lead(comparison, adjusted, (CORNER, "pb"), "less affected", 0.0)] if comparison.has(CORNER) else []
    return [
        _activations(comparison),
        _slightly_higher(comparison, adjusted),
        _lead(comparison, adjusted, ("C", "pb"), "a clear gap", 0.0),
        _lead(comparison, adjusted, ("C", "re"), "a clear gap", 0.0),
        _lead(comparison, adjusted, ("D", "pb"), "up to 31 %", _whole_points("D", "pb")),
        _lead(comparison, adjusted, ("D", "re"), "approximately 56 %", _whole_points("D", "re")),
        _contributions(comparison),
        _increments_alike(comparison),
        _increments_higher(comparison),
        *time_findings(comparison),
        *corner,
    ]


def _whole_points(part: str, baseline: str) -> float:
    """The paper's lead, in whole points [-]: of what it rounds nothing is asked."""
    return int(100 * paper_lead(part, baseline)) / 100


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
    equal = comparison.difference(part, "fra", baseline, "acquisitions")
    raw = comparison.difference(part, "fra", baseline, cloud="raw")
    place = "In the inside corner" if part == CORNER else f"On {part}"
    return Finding(
        words=f"{place} FRA covers more than {baseline.upper()}",
        paper=paper,
        rule=f"mean {'above 0' if more_than == 0 else f'at least {100 * more_than:.0f} points'}, {_SURE}",
        ours=_with_p(end, adjusted.get(where)),
        verdict=lead_verdict(end, adjusted.get(where, 1.0), len(adjusted), more_than),
        otherwise=f"{points(equal)}; raw cloud at the end {points(raw)}" if end else "n/a",
    )


_SURE = f"adjusted p \u2264 {LEVEL:.2g}"


def _with_p(difference: Difference | None, adjusted: float | None) -> str:
    return points(difference) + (f", p {adjusted:.2g}" if adjusted is not None else "")


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
    medians = _medians(comparison, "recovery_activations")
    known = [median for median in medians if median is not None]
    return Finding(
        words="Recoveries are few on A and B, many on C and D, and rise from part to part",
        paper="an increasing trend",
        rule="medians A \u2264 B < C \u2264 D; in direction: A and B below C and D",
        ours=", ".join(f"{part} {number(median, 'g')}" for part, median in zip("ABCD", medians, strict=True)),
        verdict=judged(len(known) == 4, lambda: rising(known), lambda: max(known[:2]) < min(known[2:])),
    )


def _contributions(comparison: Comparison) -> Finding:
    medians = _medians(comparison, CONTRIBUTED)
    known = [median for median in medians if median is not None]
    matte, shiny = CONTRIBUTION_SLACK * CONTRIBUTION_OF_MATTE, CONTRIBUTION_OF_SHINY / CONTRIBUTION_SLACK

    def higher() -> bool:
        return min(known[2:]) > max(known[:2])

    return Finding(
        words="Recovery views bring little of the coverage on A and B, more on C and D",
        paper="around 10 % on A and B, up to approximately 30 % on C and D",
        rule=f"medians of A and B at most {100 * matte:.0f} points, C and D more, one of them at least "
        f"{100 * shiny:.0f}; "
        "in direction: C and D above A and B",
        ours=", ".join(f"{part} {_in_points(median)}" for part, median in zip("ABCD", medians, strict=True)),
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


def _medians(comparison: Comparison, name: str) -> list[float | None]:
    found = [comparison.median(part, "fra", name) for part in "ABCD"]
    return [estimate.value if estimate else None for estimate in found]


def _in_points(share: float | None) -> str:
    return number(None if share is None else 100 * share, "z.1f").replace("-", "\u2212")
