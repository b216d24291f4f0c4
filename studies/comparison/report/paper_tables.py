"""Rows of the tables that set the paper's figures beside ours."""

from collections.abc import Sequence
from typing import Any

from studies.comparison.goals import MET, NOT_MET, Estimates, JudgedGoal
from studies.comparison.paper import ACTIVATIONS, CONTRIBUTION, FINAL_COVERAGE, INCREMENTS, paper_lead
from studies.comparison.records import CONTRIBUTED
from studies.comparison.statistics import Comparison
from studies.comparison.view_increments import FEWEST_VIEWS, binned_increments
from studies.drawing.cells import NO_NUMBER, POINTS, median_and_range, signs
from studies.run.acquisition_table import NBV, RAW_COVERAGE, RECOVERY
from studies.statistics.boxes import TukeyBox, box_of
from studies.statistics.medians import MedianEstimate, first_less_second

GOAL_CLASSES = {MET: "found", NOT_MET: "missing"}
"""Classes of the verdicts; all others are unknown."""


def coverage_rows(comparison: Comparison, parts: Sequence[str], arms: Sequence[str]) -> list[dict[str, Any]]:
    """A row per part and method: the paper's median, box and whiskers, ours, the distance, our raw cloud."""
    return [
        {
            "part": part,
            "first": arm == arms[0],
            "arm": arm,
            **_paper_cells(paper.scaled(POINTS) if paper else None, ".2f", ".0f"),
            **_our_cells(comparison.median(part, arm), comparison.box(part, arm), POINTS, ".1f"),
            "apart": _apart(comparison.box(part, arm), paper, POINTS, "+z.1f"),
            "raw": median_and_range(comparison.median(part, arm, RAW_COVERAGE), POINTS, ".1f"),
        }
        for part in parts
        for arm in arms
        for paper in [FINAL_COVERAGE.get(part, {}).get(arm)]
        if comparison.runs(part, arm)
    ]


def recovered_rows(comparison: Comparison, parts: Sequence[str]) -> list[dict[str, Any]]:
    """FRA's recoveries a run and what they brought: a row per part and figure."""
    figures = (
        ("recoveries a run", "recovery_activations", ACTIVATIONS, 1.0, "g"),
        ("brought by recovery [points]", CONTRIBUTED, CONTRIBUTION, POINTS, "z.1f"),
    )
    return [
        {
            "part": part,
            "first": words == figures[0][0],
            "words": words,
            **_paper_cells(paper.scaled(scale) if paper else None, "g", "g"),
            **_our_cells(comparison.median(part, "fra", name), comparison.box(part, "fra", name), scale, form),
            "apart": _apart(comparison.box(part, "fra", name), paper, scale, f"+{form}"),
        }
        for part in parts
        for words, name, theirs, scale, form in figures
        for paper in [theirs.get(part)]
        if comparison.runs(part, "fra")
    ]


def lead_rows(comparison: Comparison, parts: Sequence[str], baselines: Sequence[str]) -> list[dict[str, Any]]:
    """FRA less each baseline, median less median: the paper's and ours."""
    rows = []
    for part in parts:
        for baseline in baselines:
            found = comparison.of_medians(part, ("fra", baseline), first_less_second)
            known = baseline in FINAL_COVERAGE.get(part, {})
            if found:
                rows.append(
                    {
                        "part": part,
                        "first": baseline == baselines[0],
                        "baseline": baseline,
                        "paper": f"{100 * paper_lead(part, baseline):+.1f}" if known else NO_NUMBER,
                        "ours": median_and_range(found, POINTS, "+z.1f"),
                        "starts": found.count,
                    }
                )
    return rows


def increment_rows(comparison: Comparison, parts: Sequence[str]) -> list[dict[str, Any]]:
    """Medians of what views add at each level of which the paper has one: its own and ours."""
    rows = []
    for part in parts:
        ours = {
            name: binned_increments(comparison, part, arm, kind)
            for name, arm, kind in (("pb", "pb", NBV), ("recovery", "fra", RECOVERY))
        }
        levels = INCREMENTS.get(part, {})
        for level, theirs in levels.items():
            cells = {}
            for (name, bins), paper in zip(ours.items(), theirs, strict=True):
                cells[f"paper_{name}"] = NO_NUMBER if paper is None else signs(f"{100 * paper:.1f}")
                cells[f"our_{name}"] = _median_of_views(bins[level // 10])
            rows.append({"part": part, "first": level == min(levels), "level": f"{level}\u2013{level + 10} %", **cells})
    return rows


def goal_rows(judged: Sequence[JudgedGoal]) -> list[dict[str, Any]]:
    """What was wanted, what the runs say, the verdict."""
    return [
        {
            "words": j.goal.words,
            "wanted": j.goal.wanted,
            "ours": _goal_figures(j.found, j.goal.scale, j.goal.form),
            "runs": min((estimate.count if estimate else 0 for estimate in j.found), default=0),
            "verdict": j.verdict,
            "klass": GOAL_CLASSES.get(j.verdict, "unknown"),
        }
        for j in judged
    ]


def _goal_figures(found: Estimates, scale: float, form: str) -> str:
    return "; ".join(
        signs(f"{scale * e.value:{form}} ({scale * e.low:{form}} to {scale * e.high:{form}})") if e else "n/a"
        for e in found
    )


def _paper_cells(box: TukeyBox | None, form: str, ends: str) -> dict[str, str]:
    if box is None:
        return dict.fromkeys(("paper", "paper_box", "paper_whiskers"), NO_NUMBER)
    return {
        "paper": signs(format(box.median, form)),
        "paper_box": _span(box.lower, box.upper, ends),
        "paper_whiskers": _span(box.low, box.high, ends),
    }


def _our_cells(estimate: MedianEstimate | None, box: TukeyBox | None, scale: float, form: str) -> dict[str, Any]:
    scaled = box.scaled(scale) if box else TukeyBox(0.0)
    return {
        "ours": median_and_range(estimate, scale, form),
        "our_box": _span(scaled.lower, scaled.upper, form),
        "our_whiskers": _span(scaled.low, scaled.high, form),
        "runs": estimate.count if estimate else 0,
    }


def _span(low: float | None, high: float | None, form: str) -> str:
    """`68 to 88`, `to 12`."""
    if high is None:
        return NO_NUMBER
    return signs(f"{'' if low is None else f'{low:{form}} '}to {high:{form}}")


def _apart(ours: TukeyBox | None, paper: TukeyBox | None, scale: float, form: str) -> str:
    """Ours less the paper's."""
    return signs(format(scale * (ours.median - paper.median), form)) if ours and paper else NO_NUMBER


def _median_of_views(added: Sequence[float]) -> str:
    if len(added) < FEWEST_VIEWS:
        return f"too few ({len(added)})" if added else NO_NUMBER
    return signs(f"{100 * box_of(added).median:z.1f} ({len(added)})")
