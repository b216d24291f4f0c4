"""What the FRA-NBV paper measured (section VI), and what of it a comparison finds again, in words.

The rules by which a sentence counts as found stand here, beside the paper's numbers, and were set before any run.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from studies.comparison_statistics import Comparison
from studies.paired_statistics import Difference
from studies.run_words import number, percent
from studies.view_increments import recovery_advantage

FRA_LESS_PB_ON_D, FRA_LESS_RE_ON_D = 0.31, 0.56
"""Coverage, "up to 31 %" and "approximately 56 %" higher."""
COMPARABLE = 0.03
"""Coverages that differ by no more are comparable (choice: the goal set for this comparison)."""
CONTRIBUTION_OF_MATTE, CONTRIBUTION_OF_SHINY = 0.10, 0.30
"""Share of the coverage that recoveries brought, "around 10 %" on A and B, "up to approximately 30 %" on C and D."""
ITERATION_S = {
    "A": {"fra": (18.84, 23.09, 25.79), "pb": (18.81, 20.45, 26.11), "re": (45.65, 47.48, 48.70)},
    "B": {"fra": (22.40, 25.28, 28.19), "pb": (20.78, 21.72, 24.92), "re": (47.50, 51.76, 54.71)},
    "C": {"fra": (29.40, 31.87, 38.01), "pb": (20.64, 21.62, 22.52), "re": (45.66, 46.76, 48.01)},
    "D": {"fra": (29.01, 33.10, 34.53), "pb": (13.97, 16.51, 18.47), "re": (45.77, 46.66, 49.10)},
}
"""Table I: lower quartile, median and upper quartile of the time of an iteration [s]."""
NEAR_RATIO = 0.25
"""Ratios of times within this share of the paper's agree with it (choice: its medians scatter by about that)."""

FOUND, DIRECTION, NOT_FOUND, UNKNOWN = "found", "in direction only", "not found", "cannot be said"


@dataclass(frozen=True)
class Finding:
    """A sentence of the paper held against our runs."""

    words: str
    paper: str
    ours: str
    verdict: str
    otherwise: str = ""
    """The same at equal acquisitions, raw and map-filtered."""


def findings(comparison: Comparison) -> list[Finding]:
    """All sentences in the paper's order."""
    return [
        _activations(comparison),
        _comparable(comparison),
        _gap(comparison, "C", "pb", None),
        _gap(comparison, "C", "re", None),
        _gap(comparison, "D", "pb", FRA_LESS_PB_ON_D),
        _gap(comparison, "D", "re", FRA_LESS_RE_ON_D),
        _contributions(comparison),
        _increments(comparison, "B"),
        _increments(comparison, "D"),
        _order_of_times(comparison),
        *(_ratio(comparison, arm) for arm in ("fra", "re")),
    ]


def paper_ratio(ours: str, theirs: str) -> float:
    """Mean over the parts of the ratio of the paper's medians."""
    return float(np.mean([row[ours][1] / row[theirs][1] for row in ITERATION_S.values()]))


def gap_verdict(difference: Difference, expected: float | None) -> str:
    """Found: at least as large as the paper's (larger than zero where it gives no number) and surely above zero."""
    if difference.interval.mean <= 0:
        return NOT_FOUND
    sure = difference.interval.low > 0 and difference.interval.count > 1
    return FOUND if sure and difference.interval.mean >= (expected or 0.0) else DIRECTION


def points(difference: Difference | None) -> str:
    """`+31.0 points (+25.1 to +36.4)`; a single run has no interval."""
    if difference is None:
        return "n/a"
    i = difference.interval
    interval = f"{100 * i.low:+.1f} to {100 * i.high:+.1f}" if i.count > 1 else "one run"
    return f"{100 * i.mean:+.1f} points ({interval})"


def _gap(comparison: Comparison, part: str, baseline: str, expected: float | None) -> Finding:
    end = comparison.difference(part, "fra", baseline)
    equal = [comparison.difference(part, "fra", baseline, "acquisitions", cloud) for cloud in ("raw", "filtered")]
    return Finding(
        words=f"On {part} FRA covers more than {baseline.upper()}",
        paper="a clear gap" if expected is None else f"+{100 * expected:.0f} points",
        ours=points(end),
        verdict=UNKNOWN if end is None else gap_verdict(end, expected),
        otherwise=f"{points(equal[0])}; map-filtered {points(equal[1])}",
    )


def _comparable(comparison: Comparison) -> Finding:
    found = {part: comparison.difference(part, "fra", "pb") for part in ("A", "B")}
    known = [difference.interval.mean for difference in found.values() if difference]
    verdict = _judge(len(known) == 2, lambda: all(abs(mean) <= COMPARABLE for mean in known))
    equal = {part: comparison.difference(part, "fra", "pb", "acquisitions") for part in found}
    return Finding(
        words="On A and B FRA and PB cover alike",
        paper=f"comparable (here: within {100 * COMPARABLE:.0f} points)",
        ours="; ".join(f"{part} {points(difference)}" for part, difference in found.items()),
        verdict=verdict,
        otherwise="; ".join(f"{part} {points(difference)}" for part, difference in equal.items()),
    )


def _activations(comparison: Comparison) -> Finding:
    means = _means(comparison, "recovery_activations")
    verdict = _judge(None not in means, lambda: _rising(means) and means[1] < means[2] < means[3])
    if verdict == NOT_FOUND and max(means[:2]) < min(means[2:]):
        verdict = DIRECTION
    return Finding(
        words="Recoveries are few on A and B, many on C and D, and rise from part to part",
        paper="A <= B < C < D",
        ours=", ".join(f"{part} {number(mean, '.1f')}" for part, mean in zip("ABCD", means, strict=True)),
        verdict=verdict,
    )


def _contributions(comparison: Comparison) -> Finding:
    means = _means(comparison, "recovery_share")
    verdict = _judge(
        None not in means,
        lambda: max(means[:2]) <= 1.5 * CONTRIBUTION_OF_MATTE and min(means[2:]) > max(means[:2])
        and max(means[2:]) >= CONTRIBUTION_OF_SHINY / 1.5,
    )  # fmt: skip
    if verdict == NOT_FOUND and min(means[2:]) > max(means[:2]):
        verdict = DIRECTION
    return Finding(
        words="Recovery views bring a small share of the coverage on A and B, a larger one on C and D",
        paper="about 10 % on A and B, up to 30 % on C and D",
        ours=", ".join(f"{part} {percent(mean)}" for part, mean in zip("ABCD", means, strict=True)),
        verdict=verdict,
    )


def _increments(comparison: Comparison, part: str) -> Finding:
    gain = recovery_advantage(comparison, part)
    if part == "B":
        words, paper = "On B a recovery view adds as much as a PB view at the same coverage", "comparable"
        verdict = _judge(gain is not None, lambda: abs(gain or 0.0) <= COMPARABLE)
    else:
        words, paper = "On D a recovery view adds more than a PB view at the same coverage", "statistically higher"
        verdict = _judge(gain is not None, lambda: (gain or 0.0) > 0)
    ours = "too few views" if gain is None else f"{100 * gain:+.1f} points a view"
    return Finding(words, paper, ours, verdict)


def _order_of_times(comparison: Comparison) -> Finding:
    times = {part: [comparison.iteration_time(part, arm) for arm in ("pb", "fra", "re")] for part in "ABCD"}
    known = {part: [t.median for t in row if t] for part, row in times.items() if all(row)}
    verdict = _judge(len(known) == 4, lambda: all(a < b < c for a, b, c in known.values()))
    return Finding(
        words="An iteration takes longer with FRA than with PB, and longest with RE",
        paper="PB < FRA < RE on every part",
        ours="; ".join(f"{part} {', '.join(f'{t:.1f}' for t in row)} s" for part, row in known.items()) or "n/a",
        verdict=verdict,
    )


def _ratio(comparison: Comparison, arm: str) -> Finding:
    ours, paper = comparison.time_ratio("ABCD", arm, "pb"), paper_ratio(arm, "pb")
    verdict = _judge(ours is not None, lambda: abs((ours or 0.0) / paper - 1) <= NEAR_RATIO)
    if verdict == NOT_FOUND and ours is not None and (ours > 1) == (paper > 1):
        verdict = DIRECTION
    return Finding(
        f"An iteration of {arm.upper()} takes so many times that of PB", f"{paper:.2f}", number(ours, ".2f"), verdict
    )


def _means(comparison: Comparison, name: str) -> list:
    found = [comparison.figure(part, "fra", name) for part in "ABCD"]
    return [interval.mean if interval else None for interval in found]


def _rising(values: Sequence[float]) -> bool:
    return all(a <= b for a, b in pairwise(values))


def _judge(known: bool, holds: Callable[[], bool]) -> str:
    if not known:
        return UNKNOWN
    return FOUND if holds() else NOT_FOUND


def verdict_words(found: Iterable[Finding]) -> str:
    """`3 of the paper's 12 sentences are found, 4 in direction only, ...`."""
    verdicts = [finding.verdict for finding in found]
    counts = {v: verdicts.count(v) for v in (FOUND, DIRECTION, NOT_FOUND, UNKNOWN)}
    words = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    return f"Of {len(verdicts)} statements of the paper: {words}."
