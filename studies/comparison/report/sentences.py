"""Which link of the chain differs from the paper's, part by part: sentences about what the runs say, and no guesses.

The chain: what the camera misses, what the detector keeps of it, what a recovery adds, what the map takes back. What
can be changed by itself was changed, in the method (the ablations) and before it (the links); those changes that move a
result are named, and how many would be by chance.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from studies.base.numbers_as_text import counted, percent
from studies.comparison.links import LINKED_PLANNERS, LINKS, arm_name
from studies.comparison.paper import PAPER_PARTS, paper_lead
from studies.comparison.paper_results import points
from studies.comparison.statistics import Comparison
from studies.drawing.cells import signs
from studies.run.ablation import ABLATIONS
from studies.run.acquisition_table import MAP_COVERAGE, RAW_COVERAGE
from studies.statistics.intervals import LEVEL, Difference, least_p


def link_words(comparison: Comparison, parts: Sequence[str], recovered_share: float) -> list[tuple[str, list[str]]]:
    """Sentences of each part on which FRA and PB have runs."""
    return [
        (part, [*_room(comparison, part), *_chain(comparison, part, recovered_share), *_taken_back(comparison, part),
                *_moved(comparison, part)])
        for part in parts
        if comparison.pairs(part, "fra", "pb")
    ]  # fmt: skip


def _room(comparison: Comparison, part: str) -> Iterator[str]:
    """How far above PB anybody can be."""
    found = comparison.median(part, "pb")
    if found is None:
        return
    room, paper = 1 - found.value, paper_lead(part, "pb") if part in PAPER_PARTS else 0.0
    bound = f" The paper's lead of {100 * paper:.0f} points cannot be reached." if room < paper else ""
    yield (
        f"PB alone covers {percent(found.value)} of what can be seen, so nothing can lead it by more than "
        f"{100 * room:.1f} points.{bound}"
    )


def _chain(comparison: Comparison, part: str, recovered_share: float) -> Iterator[str]:
    """What the detector kept, and how recoveries ended."""
    runs = [run.losses for run in comparison.runs(part, "fra")]
    mean = {key: float(np.mean([run[key] for run in runs])) for key in runs[0]}
    came = f"{mean['activations']:.1f} recoveries of {mean['recovery_views']:.1f} views in all"
    yield (
        f"In {mean['views']:.0f} views of a run FRA found {mean['candidate_pixels']:.0f} pixels without depth well "
        f"inside the silhouette; {mean['reflective_pixels']:.0f} of them passed the frontier test, and "
        f"{came if mean['activations'] else 'no recovery'} came of it."
    )
    if any(run["recovery_views"] for run in runs):
        largest = max(run["largest_gamma"] for run in runs)
        ended = "at least one recovery ended early" if largest > recovered_share else "no recovery ended early"
        yield f"The largest \u0393 of any run was {largest:.3f} (\u03c4_rec {recovered_share}): {ended}."


def _taken_back(comparison: Comparison, part: str) -> Iterator[str]:
    """What the map does not hold any more of what was seen, whatever the cause."""
    raw, held, free = (
        comparison.figure(part, "fra", name) for name in (RAW_COVERAGE, MAP_COVERAGE, "wrongly_free_share")
    )
    if raw and held and free:
        yield (
            f"FRA's final map calls {percent(free.mean)} of the surface's voxels free, and covers {percent(held.mean)} "
            f"on average where all points ever seen cover {percent(raw.mean)}."
        )


class _Change(NamedTuple):
    """One result under one change, beside the same without it."""

    words: str
    result: str
    difference: Difference
    told: str

    @property
    def level(self) -> float:
        """Chance that runs which differ by nothing are named."""
        return max(LEVEL, least_p(self.difference.interval.count))


def _moved(comparison: Comparison, part: str) -> Iterator[str]:
    """Changes of one thing that move a result, after a sentence that says how many would do so by chance."""
    changes = [c for c in (*_ablated(comparison, part), *_linked(comparison, part)) if c.difference.interval.count > 1]
    if not changes:
        return
    moved = [c for c in changes if c.difference.p <= c.level * (1 + 1e-9)]
    level = max(c.level for c in changes)
    tried = counted(len({c.words for c in changes}), "change")
    yield (
        f"{tried} of the method or of what it is given, {counted(len(changes), 'result')} compared: "
        f"{len(moved) or 'none'} moved with p at most {level:.2g}; by chance alone up to "
        f"{sum(c.level for c in changes):.1f} would."
    )
    for c in moved:
        yield f"{c.words}: {c.result} {c.told}"


def _ablated(comparison: Comparison, part: str) -> Iterator[_Change]:
    for name, (words, planner, _) in ABLATIONS.items():
        coverage = comparison.difference(part, name, planner)
        if coverage:
            yield _Change(words, f"coverage of {planner.upper()}", coverage, points(coverage))
        yield from _activations(comparison, part, words, name, planner)


def _linked(comparison: Comparison, part: str) -> Iterator[_Change]:
    for name, link in LINKS.items():
        fra, pb = (arm_name(planner, name) for planner in LINKED_PLANNERS)
        lead = comparison.change_of_lead(part, (fra, pb), LINKED_PLANNERS)
        if lead:
            yield _Change(link.words, "lead of FRA over PB", lead, points(lead))
        yield from _activations(comparison, part, link.words, fra, "fra")


def _activations(comparison: Comparison, part: str, words: str, arm: str, planner: str) -> Iterator[_Change]:
    found = comparison.figure_difference(part, arm, planner, "recovery_activations") if planner == "fra" else None
    if found:
        yield _Change(words, "activations", found, signs(f"{found.interval.mean:+z.1f}"))
