"""When a sentence of the paper counts as found again, and when the runs are too few to say so."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from studies.comparison.preset import CORNER
from studies.comparison.statistics import Comparison
from studies.statistics.intervals import LEVEL, Difference, holm, least_p

FOUND, DIRECTION, TOO_FEW, NOT_FOUND, UNKNOWN = (
    "found",
    "in direction only",
    "too few runs",
    "not found",
    "cannot be said",
)
BASELINES = ("pb", "re")
"""What the paper compares FRA with."""
NEAR_SHARE = 0.25
"""Times and increments within this share of each other agree (choice: the quartiles of the paper's times lie about so
far apart)."""


@dataclass(frozen=True)
class Finding:
    """A sentence of the paper held against our runs."""

    words: str
    paper: str
    rule: str
    """When it counts as found."""
    ours: str
    verdict: str
    otherwise: str = ""
    """The same at equal acquisitions, and of the raw cloud."""


def adjusted_p(comparison: Comparison) -> dict[tuple[str, str], float]:
    """p of FRA's coverage at the end less each baseline's, by part and baseline, adjusted for all of them (Holm)."""
    found = {
        (part, baseline): comparison.difference(part, "fra", baseline)
        for part in (*"ABCD", CORNER)
        for baseline in BASELINES
    }
    known = {key: difference.p for key, difference in found.items() if difference}
    return dict(zip(known, holm(list(known.values())), strict=True))


def lead_verdict(difference: Difference | None, adjusted: float, tests: int, more_than: float) -> str:
    """Of a claimed lead: its mean beyond `more_than`, and told from none beside all other tests.

    adjusted: its p among `tests` tests. Too few runs: a p that small is out of reach even if all runs agree.
    """
    if difference is None:
        return UNKNOWN
    mean, count = difference.interval.mean, difference.interval.count
    if mean <= 0:
        return NOT_FOUND
    if mean < more_than:
        return DIRECTION
    if adjusted <= LEVEL:
        return FOUND
    return TOO_FEW if tests * least_p(count) > LEVEL else DIRECTION


def weakest(verdicts: Iterable[str]) -> str:
    """Of a statement with several claims: it holds as far as the weakest of them."""
    return max(verdicts, key=(FOUND, DIRECTION, TOO_FEW, UNKNOWN, NOT_FOUND).index)


def judged(known: bool, holds: Callable[[], bool], nearly: Callable[[], bool] = lambda: False) -> str:
    """Of a rule about means: found, in direction only where a weaker rule holds."""
    if not known:
        return UNKNOWN
    if holds():
        return FOUND
    return DIRECTION if nearly() else NOT_FOUND


def verdict_words(verdicts: Iterable[str]) -> str:
    """`Of 12 statements of the paper: 3 found, 4 in direction only, ...`."""
    verdicts = list(verdicts)
    counts = {verdict: verdicts.count(verdict) for verdict in (FOUND, DIRECTION, TOO_FEW, NOT_FOUND, UNKNOWN)}
    words = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    return f"Of {len(verdicts)} statements of the paper: {words}."
