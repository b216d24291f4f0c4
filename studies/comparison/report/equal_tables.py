"""Rows of the tables and the sentences about planners after equally many acquisitions."""

from collections.abc import Sequence
from typing import Any

from studies.base.numbers_as_text import counted
from studies.comparison.equal_acquisitions import (
    Needed,
    compared_arms,
    is_compared_so,
    lead_after,
    mean_after,
    mean_seconds_each,
    needed,
    reached_levels,
    seconds_ratio,
)
from studies.comparison.equal_summary import targets
from studies.comparison.method_names import method_name
from studies.comparison.paper_results import points
from studies.comparison.report.equal_figure import equal_figure
from studies.comparison.report.headline import short_words
from studies.comparison.statistics import Comparison
from studies.drawing.cells import NO_NUMBER, POINTS, mean, mean_and_range, probability, signed
from studies.statistics.intervals import Difference, Interval, holm


def equal_section(comparison: Comparison, parts: Sequence[str], planners: Sequence[str]) -> dict[str, Any] | None:
    """What the page shows of it; None where the study has nothing to say."""
    if not is_compared_so(comparison, parts, planners):
        return None
    levels = reached_levels(comparison, parts, planners)
    return {
        "levels": levels,
        "words": equal_words(comparison, parts, planners),
        "figure": equal_figure(comparison, parts, planners, levels[-1]),
        "covered": covered_rows(comparison, parts, planners, levels),
        "leads": equal_lead_rows(comparison, parts, planners, levels),
        "needed": needed_rows(comparison, parts, planners),
        "prices": price_rows(comparison, parts, planners),
    }


def covered_rows(
    comparison: Comparison, parts: Sequence[str], planners: Sequence[str], levels: Sequence[int]
) -> list[dict[str, Any]]:
    """A row per part and planner: coverage after each of the levels, and how many acquisitions its runs took."""
    return [
        {
            "part": part,
            "first": planner == there[0],
            "arm": planner,
            "runs": len(comparison.runs(part, planner)),
            "acquisitions": mean(comparison.figure(part, planner, "acquisitions"), 1.0, ".1f"),
            "after": [mean_and_range(mean_after(comparison, part, planner, n), POINTS, ".1f") for n in levels],
        }
        for part in parts
        for there in [[planner for planner in planners if comparison.runs(part, planner)]]
        for planner in there
    ]


def equal_lead_rows(
    comparison: Comparison, parts: Sequence[str], planners: Sequence[str], levels: Sequence[int]
) -> list[dict[str, Any]]:
    """A row per part and two planners: one less the other after each of the levels, with the test after the last."""
    rows, tests = [], []
    for part in parts:
        for ours, theirs in compared_arms(planners):
            found = [lead for n in levels if (lead := lead_after(comparison, part, ours, theirs, n))]
            if found:
                tests.append(found[-1].p)
                rows.append(
                    {
                        **_row_head(part, ours, theirs, rows),
                        "pairs": found[-1].interval.count,
                        "after": [signed(lead) for lead in found],
                    }
                )
    for row, p, adjusted in zip(rows, tests, holm(tests), strict=True):
        row.update(p=probability(p), adjusted=probability(adjusted))
    return rows


def needed_rows(comparison: Comparison, parts: Sequence[str], planners: Sequence[str]) -> list[dict[str, Any]]:
    """A row per part and planner: acquisitions until the paper's coverage of FRA, and until FRA's own end here."""
    rows = []
    for part in parts:
        shares = targets(comparison, part)
        for planner in planners:
            if comparison.runs(part, planner):
                rows.append(
                    {
                        "part": part,
                        "first": not rows or rows[-1]["part"] != part,
                        "arm": planner,
                        **{f"{name}_share": _share(share) for name, share in shares.items()},
                        **{name: needed_words(needed(comparison, part, planner, s)) for name, s in shares.items()},
                        "planning": mean_and_range(
                            mean_seconds_each(comparison, part, planner, "planning"), 1.0, ".3f"
                        ),
                        "processor": mean_and_range(
                            mean_seconds_each(comparison, part, planner, "processor"), 1.0, ".2f"
                        ),
                    }
                )
    return rows


def price_rows(comparison: Comparison, parts: Sequence[str], planners: Sequence[str]) -> list[dict[str, Any]]:
    """A row per part and two planners: ratios of their times, differences of the errors of their final maps."""
    rows: list[dict[str, Any]] = []
    for part in parts:
        for ours, theirs in compared_arms(planners):
            if comparison.pairs(part, ours, theirs):

                def apart(name: str, pair: tuple[str, str, str] = (part, ours, theirs)) -> Difference | None:
                    return comparison.figure_difference(*pair, name)

                rows.append(
                    {
                        **_row_head(part, ours, theirs, rows, "beside"),
                        "planning": _ratio(seconds_ratio(comparison, part, ours, theirs, "planning")),
                        "processor": _ratio(seconds_ratio(comparison, part, ours, theirs, "processor")),
                        "wrongly_free": signed(apart("wrongly_free_share")),
                        "f_score": signed(apart("f_score"), 1.0, "+z.3f"),
                        "accuracy": signed(apart("accuracy_mm"), 1.0, "+z.1f"),
                    }
                )
    return rows


def _row_head(
    part: str, ours: str, theirs: str, above: Sequence[dict[str, Any]], joined_by: str = "less"
) -> dict[str, Any]:
    words = f"{method_name(ours)} {joined_by} {method_name(theirs)}"
    return {"part": part, "first": not above or above[-1]["part"] != part, "words": words}


def equal_words(comparison: Comparison, parts: Sequence[str], planners: Sequence[str]) -> list[str]:
    """What the runs say of each part after the last level, in a few sentences; none where nothing is compared so."""
    if not is_compared_so(comparison, parts, planners):
        return []
    last = reached_levels(comparison, parts, planners)[-1]
    return [words for part in parts if (words := _words_of(comparison, part, planners, last))]


def _words_of(comparison: Comparison, part: str, planners: Sequence[str], acquisitions: int) -> str:
    """Of one part; empty without runs."""
    there = [planner for planner in planners if comparison.runs(part, planner)]
    if not there:
        return ""
    covered = [
        f"{method_name(planner)} {mean(mean_after(comparison, part, planner, acquisitions), POINTS, '.1f')} %"
        for planner in there
    ]
    leads = [
        f"{method_name(ours)} less {method_name(theirs)} {points(lead)}"
        for ours, theirs in compared_arms(planners)
        if (lead := lead_after(comparison, part, ours, theirs, acquisitions))
    ]
    place = f"{short_words(part)}, after {acquisitions} acquisitions:"
    told = f" {'; '.join(leads)}." if leads else ""
    return f"{place} {', '.join(covered)}.{told}{_reached_words(comparison, part, there)}"


def _reached_words(comparison: Comparison, part: str, planners: Sequence[str]) -> str:
    """` What FRA covers in the paper, 84.74 %, is first reached by fra-robust after 9 acquisitions (15 of 15 ...`."""
    share = targets(comparison, part)["paper_fra"]
    found = [(planner, counts) for planner in planners if (counts := needed(comparison, part, planner, share))]
    if share is None or not found:
        return ""
    told = [f"by {method_name(planner)} {_after_words(counts)}" for planner, counts in found]
    return f" What FRA covers in the paper, {100 * share:.2f} %, is first reached {', '.join(told)}."


def _after_words(counts: Needed) -> str:
    """`after 9 acquisitions (15 of 15 starts)`, `from 2 of 15 starts alone`, `from none of 15 starts`."""
    if counts.median is not None:
        return f"after {counts.median:g} acquisitions ({counts.reached} of {counted(counts.starts, 'start')})"
    return f"from {f'{counts.reached}' if counts.reached else 'none'} of {counted(counts.starts, 'start')}"


def needed_words(counts: Needed | None) -> str:
    """`9 (15 of 15)`; the median of few that reach it is none."""
    if counts is None:
        return NO_NUMBER
    median = NO_NUMBER if counts.median is None else f"{counts.median:g}"
    return f"{median} ({counts.reached} of {counts.starts})"


def _share(share: float | None) -> str:
    return NO_NUMBER if share is None else f"{100 * share:.2f} %"


def _ratio(interval: Interval | None) -> str:
    return mean_and_range(interval, 1.0, ".2f")
