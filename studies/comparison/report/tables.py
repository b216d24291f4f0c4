"""Rows of the tables in a comparison's report."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from studies.comparison.paper import ITERATION_S, paper_ratio
from studies.comparison.paper_verdicts import adjusted_p
from studies.comparison.records import CONTRIBUTED
from studies.comparison.statistics import ATS, CLOUDS, Comparison
from studies.drawing.cells import NO_NUMBER, POINTS, mean, mean_and_range, probability, seconds, signed, with_range
from studies.run.acquisition_table import MAP_COVERAGE, RAW_COVERAGE

ARM_CELLS = {
    "coverage": (mean_and_range, MAP_COVERAGE, POINTS, ".1f"),
    "raw": (mean_and_range, RAW_COVERAGE, POINTS, ".1f"),
    "accuracy": (mean, "accuracy_mm", 1.0, ".1f"),
    "f_score": (mean, "f_score", 1.0, ".2f"),
    "wrongly_free": (mean, "wrongly_free_share", POINTS, ".0f"),
    "wrongly_occupied": (mean, "wrongly_occupied_share", POINTS, ".0f"),
    "acquisitions": (mean, "acquisitions", 1.0, ".1f"),
    "iterations": (mean, "nbv_iterations", 1.0, ".1f"),
    "activations": (mean_and_range, "recovery_activations", 1.0, ".1f"),
    "contribution": (mean_and_range, CONTRIBUTED, POINTS, "z.1f"),
}
"""How each figure is written, what it is called in the summaries, its scale and digits."""
OF_RECOVERY = ("activations", "contribution")
"""Figures that only FRA has."""


def arm_rows(comparison: Comparison, parts: Sequence[str], arms: Sequence[str]) -> list[dict[str, Any]]:
    """One row per part and arm: what its runs reached on average."""
    return [
        {
            "part": part,
            "arm": arm,
            "first": arm == arms[0],
            "runs": len(comparison.runs(part, arm)),
            **{
                cell: write(comparison.figure(part, arm, name), scale, form)
                for cell, (write, name, scale, form) in ARM_CELLS.items()
            },
            **({} if arm == "fra" else dict.fromkeys(OF_RECOVERY, NO_NUMBER)),
        }
        for part in parts
        for arm in arms
        if comparison.runs(part, arm)
    ]


def difference_rows(comparison: Comparison, parts: Sequence[str], baselines: Sequence[str]) -> list[dict[str, Any]]:
    """FRA less each baseline on each part: at the end, at equal iterations and acquisitions, of map and raw cloud."""
    adjusted = adjusted_p(comparison)
    rows = []
    for part in parts:
        for baseline in baselines:
            end = comparison.difference(part, "fra", baseline)
            if end is not None:
                rows.append(
                    {
                        "part": part,
                        "baseline": baseline,
                        "first": baseline == baselines[0],
                        "pairs": end.interval.count,
                        "p": probability(end.p),
                        "adjusted": probability(adjusted.get((part, baseline))),
                        **{
                            f"{at}_{cloud}": signed(comparison.difference(part, "fra", baseline, at, cloud))
                            for at in ATS
                            for cloud in CLOUDS
                        },
                    }
                )
    return rows


def time_rows(comparison: Comparison, parts: Sequence[str], arms: Sequence[str]) -> list[dict[str, Any]]:
    """Time of a run's average NBV iteration with its recoveries, and by what it is spent on, beside the paper's."""
    rows = []
    for part in parts:
        for arm in arms:
            total = comparison.iteration_time(part, arm)
            if total is None:
                continue
            theirs = ITERATION_S.get(part, {}).get(arm)
            rows.append(
                {
                    "part": part,
                    "arm": arm,
                    "first": arm == arms[0],
                    "runs": total.count,
                    "total": seconds(total),
                    **{s: seconds(comparison.iteration_time(part, arm, s)) for s in ("planning", "motion", "exposure")},
                    "single": seconds(comparison.single_iteration_time(part, arm)),
                    "paper": with_range(theirs[1], theirs[0], theirs[2], ".2f") if theirs else NO_NUMBER,
                }
            )
    return rows


def overhead_words(comparison: Comparison) -> str:
    """What the model leaves out of PB's iterations of one view, and what as much in every view does to the ratios."""
    medians = {part: comparison.iteration_time(part, "pb") for part in ITERATION_S}
    excess = {part: ITERATION_S[part]["pb"][1] - pb.median for part, pb in medians.items() if pb}
    ratios = {}
    for arm in ("fra", "re"):
        times = {part: comparison.iteration_time(part, arm, overhead_s=s) for part, s in excess.items()}
        found = {part: time.median / ITERATION_S[part]["pb"][1] for part, time in times.items() if time}
        if not found:
            return ""
        ratios[arm] = f"{np.mean(list(found.values())):.2f}", f"{paper_ratio(arm, 'pb', found):.2f}"
    seconds_of = ", ".join(f"{part} {s:.1f} s" for part, s in excess.items())
    return (
        f"The paper's PB iterations of one view last longer than ours by {seconds_of}, which our model does not "
        "explain. If every view cost as much more, whatever it is spent on, "
        f"FRA would take {ratios['fra'][0]} times and RE {ratios['re'][0]} times as long as PB "
        f"(paper: {ratios['fra'][1]} and {ratios['re'][1]})."
    )


def loss_rows(comparison: Comparison, parts: Sequence[str]) -> list[dict[str, Any]]:
    """Where FRA's chain loses what it is meant to find: means of a run's counts, and the largest Gamma of any run."""
    rows = []
    for part in parts:
        runs = comparison.runs(part, "fra")
        if runs:
            totals = [run.losses for run in runs]
            means = {key: float(np.mean([t[key] for t in totals])) for key in totals[0]}
            rows.append({"part": part, **means, "largest_gamma": max(t["largest_gamma"] for t in totals)})
    return rows
