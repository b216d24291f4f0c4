"""What the paper says of the time of an iteration (section VI-D), held against a comparison."""

from collections.abc import Sequence
from itertools import pairwise

from studies.base.numbers_as_text import number
from studies.comparison.paper import paper_ratio
from studies.comparison.paper_verdicts import NEAR_SHARE, Finding, judged
from studies.comparison.statistics import Comparison


def time_findings(comparison: Comparison) -> list[Finding]:
    """Order, growth with the recoveries, ratios; of medians over the runs, without tests."""
    return [
        _order_of_times(comparison),
        _times_alike(comparison),
        *(_ratio(comparison, arm) for arm in ("fra", "re")),
    ]


def _order_of_times(comparison: Comparison) -> Finding:
    times = {part: [comparison.iteration_time(part, arm) for arm in ("pb", "fra", "re")] for part in "ABCD"}
    known = {part: [t.median for t in row if t] for part, row in times.items() if all(row)}
    words = [f"{part} {', '.join(f'{t:.2f}' for t in row)} s" for part, row in known.items()]
    return Finding(
        words="An iteration takes longer with FRA than with PB, and longest with RE",
        paper="PB < FRA < RE on every part",
        rule="medians in that order on all four",
        ours=f"PB, FRA, RE: {'; '.join(words)}" if words else "n/a",
        verdict=judged(len(known) == 4, lambda: all(_in_order(row) for row in known.values())),
    )


def _in_order(values: Sequence[float]) -> bool:
    return all(a < b for a, b in pairwise(values))


def _times_alike(comparison: Comparison) -> Finding:
    ratios = {part: comparison.time_ratio(part, "fra", "pb") for part in "ABCD"}
    known = {part: ratio for part, ratio in ratios.items() if ratio is not None}
    return Finding(
        words="Beside PB, FRA's iteration is about as long on A and B and longer on C and D",
        paper=", ".join(f"{part} {paper_ratio('fra', 'pb', part):.2f}" for part in "ABCD") + " times",
        rule=f"A and B within {100 * NEAR_SHARE:.0f} % of PB, C and D above both; in direction: the latter alone",
        ours=", ".join(f"{part} {number(ratio, '.2f')}" for part, ratio in ratios.items()) + " times",
        verdict=judged(
            len(known) == 4,
            lambda: _longer_on_shiny(known) and all(abs(known[part] - 1) <= NEAR_SHARE for part in "AB"),
            lambda: _longer_on_shiny(known),
        ),
    )


def _longer_on_shiny(ratios: dict[str, float]) -> bool:
    return min(ratios[part] for part in "CD") > max(ratios[part] for part in "AB")


def _ratio(comparison: Comparison, arm: str) -> Finding:
    parts = [part for part in "ABCD" if comparison.time_ratio(part, arm, "pb") is not None]
    paper = paper_ratio(arm, "pb", parts or "ABCD")
    ours = comparison.time_ratio(parts, arm, "pb")
    return Finding(
        words=f"Time of an {arm.upper()} iteration over that of a PB iteration",
        paper=f"{paper:.2f}",
        rule=f"mean over the parts, less 1, within {100 * NEAR_SHARE:.0f} % of the paper's less 1; "
        "in direction: the same side of 1",
        ours=number(ours, ".2f"),
        verdict=judged(
            len(parts) == 4,
            lambda: abs((ours or 0.0) - paper) <= NEAR_SHARE * (paper - 1),  # 1 must never agree with more
            lambda: ((ours or 0.0) > 1) == (paper > 1),
        ),
    )
