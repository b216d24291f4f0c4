"""Rows of the tables about what was changed: ablations, variants of the baseline RE, links before the planner."""

from collections.abc import Sequence
from typing import Any

from studies.comparison.links import LINKED_PLANNERS, LINKS, arm_name
from studies.comparison.records import CONTRIBUTED
from studies.comparison.statistics import Comparison
from studies.drawing.cells import POINTS, mean, signed
from studies.run.ablation import ABLATIONS
from studies.run.acquisition_table import MAP_COVERAGE, RAW_COVERAGE


def ablation_rows(comparison: Comparison, parts: Sequence[str]) -> list[dict[str, Any]]:
    """Each ablation that has runs, less the whole method over the same starts."""
    rows = []
    for part in parts:
        for name, (words, planner, _) in ABLATIONS.items():
            difference = comparison.difference(part, name, planner)
            if difference is not None:
                found = {
                    key: comparison.figure_difference(part, name, planner, key)
                    for key in ("acquisitions", "recovery_activations")
                }
                rows.append(
                    {
                        "part": part,
                        "words": words,
                        "planner": planner,
                        "pairs": difference.interval.count,
                        "coverage": signed(difference),
                        "raw": signed(comparison.difference(part, name, planner, cloud="raw")),
                        "acquisitions": signed(found["acquisitions"], 1.0),
                        "activations": signed(found["recovery_activations"], 1.0),
                    }
                )
    return rows


def variant_rows(comparison: Comparison, parts: Sequence[str]) -> list[dict[str, Any]]:
    """FRA less RE and each of its variants that has runs, over the same starts; the best covers most."""
    variants = [name for name, ablation in ABLATIONS.items() if ablation.planner == "re"]
    rows = []
    for part in parts:
        ran = [name for name in variants if comparison.pairs(part, "fra", name)]
        shared = comparison.of_starts({run.run for name in ran for run in comparison.runs(part, name)})
        found = {
            name: interval
            for name in (["re", *ran] if ran else [])
            if shared.pairs(part, "fra", name) and (interval := shared.figure(part, name, MAP_COVERAGE))
        }
        best = max(found, key=lambda name: found[name].mean, default=None)
        rows += [
            {
                "part": part,
                "first": name == next(iter(found)),
                "words": "RE as in the comparison" if name == "re" else ABLATIONS[name].words,
                "best": name == best,
                "pairs": len(shared.pairs(part, "fra", name)),
                "covers": mean(interval, POINTS, ".1f"),
                "end": signed(shared.difference(part, "fra", name)),
                "acquisitions": signed(shared.difference(part, "fra", name, "acquisitions")),
                "raw": signed(shared.difference(part, "fra", name, "end", "raw")),
            }
            for name, interval in found.items()
        ]
    return rows


def changed_link_rows(comparison: Comparison, parts: Sequence[str]) -> list[dict[str, Any]]:
    """FRA and PB under each changed link that has runs, after the same starts with nothing changed."""
    rows = []
    for part in parts:
        changed = {
            link.words: arms
            for name, link in LINKS.items()
            if comparison.pairs(part, *(arms := (arm_name("fra", name), arm_name("pb", name))))
        }
        starts = {run.run for arms in changed.values() for arm in arms for run in comparison.runs(part, arm)}
        shared = comparison.of_starts(starts)
        for words, arms in [("nothing changed", LINKED_PLANNERS), *changed.items()] if changed else []:
            fra, pb = arms
            end = shared.difference(part, fra, pb)
            rows.append(
                {
                    "part": part,
                    "first": arms == LINKED_PLANNERS,
                    "words": words,
                    "pairs": end.interval.count if end else 0,
                    "fra": mean(shared.figure(part, fra, MAP_COVERAGE), POINTS, ".1f"),
                    "pb": mean(shared.figure(part, pb, MAP_COVERAGE), POINTS, ".1f"),
                    "fra_raw": mean(shared.figure(part, fra, RAW_COVERAGE), POINTS, ".1f"),
                    "pb_raw": mean(shared.figure(part, pb, RAW_COVERAGE), POINTS, ".1f"),
                    "end": signed(end),
                    "change": ""
                    if arms == LINKED_PLANNERS
                    else signed(shared.change_of_lead(part, (fra, pb), LINKED_PLANNERS)),
                    "acquisitions": signed(shared.difference(part, fra, pb, "acquisitions")),
                    "activations": mean(shared.figure(part, fra, "recovery_activations"), 1.0, ".1f"),
                    "contribution": mean(shared.figure(part, fra, CONTRIBUTED), POINTS, "z.1f"),
                }
            )
    return rows
