"""Rows of the tables in a comparison's report."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from studies.ablation import NamedAblation
from studies.comparison_statistics import Comparison, Quartiles
from studies.paired_statistics import Interval
from studies.report.speed_figure import decision_s
from studies.run_words import number

POINTS = 100.0
"""Shares as percentages."""


def arm_rows(comparison: Comparison, parts: Sequence[str], arms: Sequence[str]) -> list[dict[str, Any]]:
    """One row per part and arm: what its runs reached on average."""
    return [
        {
            "part": part,
            "arm": arm,
            "first": arm == arms[0],
            "runs": len(comparison.runs(part, arm)),
            "coverage": spread(comparison.figure(part, arm, "coverage_5mm"), POINTS, ".1f"),
            "filtered": spread(comparison.figure(part, arm, "filtered_coverage_5mm"), POINTS, ".1f"),
            "accuracy": mean(comparison.figure(part, arm, "accuracy_mm"), 1.0, ".1f"),
            "f_score": mean(comparison.figure(part, arm, "f_score"), 1.0, ".2f"),
            "wrongly_free": mean(comparison.figure(part, arm, "wrongly_free_share"), POINTS, ".0f"),
            "wrongly_occupied": mean(comparison.figure(part, arm, "wrongly_occupied_share"), POINTS, ".0f"),
            "acquisitions": mean(comparison.figure(part, arm, "acquisitions"), 1.0, ".1f"),
            "iterations": mean(comparison.figure(part, arm, "nbv_iterations"), 1.0, ".1f"),
            "activations": spread(comparison.figure(part, arm, "recovery_activations"), 1.0, ".1f"),
            "contribution": spread(comparison.figure(part, arm, "recovery_share"), POINTS, ".0f"),
        }
        for part in parts
        for arm in arms
        if comparison.runs(part, arm)
    ]


def difference_rows(comparison: Comparison, parts: Sequence[str], baselines: Sequence[str]) -> list[dict[str, Any]]:
    """FRA less each baseline on each part: at the end, at equal iterations and acquisitions, raw and map-filtered."""
    return [
        {
            "part": part,
            "baseline": baseline,
            "first": baseline == baselines[0],
            "end": comparison.difference(part, "fra", baseline),
            "iterations": comparison.difference(part, "fra", baseline, "iterations"),
            "acquisitions": comparison.difference(part, "fra", baseline, "acquisitions"),
            "end_filtered": comparison.difference(part, "fra", baseline, "end", "filtered"),
            "acquisitions_filtered": comparison.difference(part, "fra", baseline, "acquisitions", "filtered"),
        }
        for part in parts
        for baseline in baselines
        if comparison.pairs(part, "fra", baseline)
    ]


def time_rows(
    comparison: Comparison, parts: Sequence[str], arms: Sequence[str], paper: Mapping[str, Mapping[str, tuple]]
) -> list[dict[str, Any]]:
    """Time of an NBV iteration with its recoveries, in all and by what it is spent on, beside the paper's."""
    rows = []
    for part in parts:
        for arm in arms:
            total = comparison.iteration_time(part, arm)
            if total is None:
                continue
            stages = {
                stage: comparison.iteration_time(part, arm, stage) for stage in ("planning", "motion", "exposure")
            }
            theirs = paper.get(part, {}).get(arm)
            rows.append(
                {
                    "part": part,
                    "arm": arm,
                    "first": arm == arms[0],
                    "count": total.count,
                    "total": seconds(total),
                    **{stage: seconds(found) if found else "n/a" for stage, found in stages.items()},
                    "paper": f"{theirs[1]:.2f} [{theirs[0]:.2f} to {theirs[2]:.2f}]" if theirs else "n/a",
                }
            )
    return rows


def loss_rows(comparison: Comparison, parts: Sequence[str]) -> list[dict[str, Any]]:
    """Where FRA's chain loses what it is meant to find: mean counts per run, from the table of acquisitions."""
    rows = []
    for part in parts:
        runs = comparison.runs(part, "fra")
        if runs:
            totals = [run.losses for run in runs]
            rows.append({"part": part, **{key: float(np.mean([t[key] for t in totals])) for key in totals[0]}})
    return rows


def ablation_rows(
    comparison: Comparison, parts: Sequence[str], ablations: Mapping[str, NamedAblation]
) -> list[dict[str, Any]]:
    """Each ablation that has runs, less the whole method over the same starts."""
    rows = []
    for part in parts:
        for name, (words, planner, _) in ablations.items():
            difference = comparison.difference(part, name, planner)
            if difference is not None:
                found = {
                    key: comparison.figure_difference(part, name, planner, key)
                    for key in ("filtered_coverage_5mm", "acquisitions", "recovery_activations")
                }
                rows.append(
                    {
                        "part": part,
                        "words": words,
                        "planner": planner,
                        "difference": difference,
                        "filtered": found["filtered_coverage_5mm"],
                        "acquisitions": signed(found["acquisitions"]),
                        "activations": signed(found["recovery_activations"]),
                    }
                )
    return rows


def speed_words(rows: Iterable[Mapping[str, Any]]) -> str:
    """Which method plans faster where, in words."""
    by_size: dict[tuple[str, int], dict[str, float]] = {}
    for row in rows:
        by_size.setdefault((row["axis"], row["size"]), {})[row["planner"]] = decision_s(row)
    sentences = []
    for axis, name in (
        ("voxels", "edge length in voxels"),
        ("candidates", "candidates"),
        ("pixels", "times the pixels"),
    ):
        ratios = {size: times["re"] / times["pb"] for (a, size), times in sorted(by_size.items()) if a == axis}
        wins = ", ".join(f"{size}: {ratio:.2g}" for size, ratio in ratios.items())
        sentences.append(f"by {name} {wins}")
    return f"RE's decision takes so many times PB's: {'; '.join(sentences)}. Below 1 RE is the faster one."


def mean(interval: Interval | None, scale: float, form: str) -> str:
    """The mean alone."""
    return number(None if interval is None else scale * interval.mean, form)


def spread(interval: Interval | None, scale: float, form: str) -> str:
    """The mean with its interval."""
    if interval is None:
        return "n/a"
    low, high = (format(scale * end, form) for end in (interval.low, interval.high))
    return f"{mean(interval, scale, form)} [{low} to {high}]"


def signed(difference) -> str:
    """A mean difference with its sign."""
    return "n/a" if difference is None else f"{difference.interval.mean:+.1f}"


def seconds(times: Quartiles) -> str:
    """Median and quartiles."""
    return f"{times.median:.2f} [{times.lower:.2f} to {times.upper:.2f}]"
