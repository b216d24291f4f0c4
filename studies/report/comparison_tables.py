"""Rows of the tables in a comparison's report."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from studies.ablation import NamedAblation
from studies.comparison_statistics import Comparison, Quartiles
from studies.link_change import LINKS, arm_name
from studies.paired_statistics import Interval
from studies.paper_numbers import ITERATION_S, paper_ratio
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


def time_rows(comparison: Comparison, parts: Sequence[str], arms: Sequence[str]) -> list[dict[str, Any]]:
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
            theirs = ITERATION_S.get(part, {}).get(arm)
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


def changed_link_rows(comparison: Comparison, parts: Sequence[str]) -> list[dict[str, Any]]:
    """FRA and PB under each changed link that has runs, after the same starts with nothing changed."""
    rows = []
    for part in parts:
        changed = [
            (link.words, *(arm_name(planner, name) for planner in ("fra", "pb")))
            for name, link in LINKS.items()
            if comparison.pairs(part, arm_name("fra", name), arm_name("pb", name))
        ]
        for words, fra, pb in [("nothing changed", "fra", "pb"), *changed] if changed else []:
            activations = comparison.figure(part, fra, "recovery_activations")
            rows.append(
                {
                    "part": part,
                    "words": words,
                    "fra": mean(comparison.figure(part, fra, "coverage_5mm"), POINTS, ".1f"),
                    "pb": mean(comparison.figure(part, pb, "coverage_5mm"), POINTS, ".1f"),
                    "fra_filtered": mean(comparison.figure(part, fra, "filtered_coverage_5mm"), POINTS, ".1f"),
                    "pb_filtered": mean(comparison.figure(part, pb, "filtered_coverage_5mm"), POINTS, ".1f"),
                    "pairs": len(comparison.pairs(part, fra, pb)),
                    "end": comparison.difference(part, fra, pb),
                    "acquisitions": comparison.difference(part, fra, pb, "acquisitions"),
                    "activations": mean(activations, 1.0, ".1f"),
                    "contribution": mean(comparison.figure(part, fra, "recovery_share"), POINTS, ".0f"),
                }
            )
    return rows


def speed_words(rows: Iterable[Mapping[str, Any]]) -> str:
    """Which method plans faster where, in words."""
    by_size: dict[tuple[str, int], dict[str, Mapping[str, Any]]] = {}
    for row in rows:
        by_size.setdefault((row["axis"], row["size"]), {})[row["planner"]] = row
    sentences = []
    for axis, name in (("voxels", "voxels along an edge"), ("candidates", "candidates"), ("pixels", "pixels a row")):
        ratios = {
            size: decision_s(both["re"]) / decision_s(both["pb"])
            for (a, size), both in sorted(by_size.items())
            if a == axis
        }
        sentences.append(f"{', '.join(f'{ratio:.2g} with {size}' for size, ratio in ratios.items())} {name}")
    paper = by_size["candidates", min(size for axis, size in by_size if axis == "candidates")]
    pb, re = (1000 * decision_s(paper[planner]) for planner in ("pb", "re"))
    scored = [1000 * paper[planner]["score"] for planner in ("pb", "re")]
    faster = sum(both["pb"]["score"] < both["re"]["score"] for both in by_size.values())
    return (
        f"At the paper's size (a map of {paper['pb']['map_voxels']:,} voxels, {paper['pb']['poses']} candidates, "
        f"{paper['pb']['rays']:,} pixels) a decision takes {pb:.0f} ms with PB and {re:.0f} ms with RE, of which "
        f"scoring takes {scored[0]:.1f} and {scored[1]:.1f} ms: a fast RE is {'not ' if re <= pb else ''}slower than "
        f"PB there. PB scores faster in {faster} of the {len(by_size)} settings, but must fit its ellipsoids first. "
        f"RE's decision takes so many times PB's: {'; '.join(sentences)}."
    )


def mean(interval: Interval | None, scale: float, form: str) -> str:
    """The mean alone."""
    return number(None if interval is None else scale * interval.mean, form)


def spread(interval: Interval | None, scale: float, form: str) -> str:
    """The mean with its interval, which a single run does not have."""
    if interval is None or interval.count == 1:
        return mean(interval, scale, form)
    low, high = (format(scale * end, form) for end in (interval.low, interval.high))
    return f"{mean(interval, scale, form)} [{low} to {high}]"


def signed(difference) -> str:
    """A mean difference with its sign."""
    return "n/a" if difference is None else f"{difference.interval.mean:+.1f}"


def seconds(times: Quartiles) -> str:
    """Median and quartiles."""
    return f"{times.median:.2f} [{times.lower:.2f} to {times.upper:.2f}]"
