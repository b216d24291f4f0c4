"""Which link of the chain differs from the paper's, part by part: sentences about what the runs say, and no guesses.

The chain: what the camera misses, what the detector keeps of it, what a recovery adds, what false depth undoes. What
can be changed by itself was changed (the ablations); those that move a result beyond its interval are named.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from studies.ablation import NamedAblation
from studies.comparison_statistics import Comparison
from studies.paired_statistics import Difference
from studies.paper_numbers import FRA_LESS_PB_ON_D
from studies.paper_results import points
from studies.run_words import counted, percent


def link_words(
    comparison: Comparison, parts: Sequence[str], ablations: Mapping[str, NamedAblation], recovered_share: float
) -> list[tuple[str, list[str]]]:
    """Sentences of each part on which FRA and PB have runs."""
    return [
        (part, [*_room(comparison, part), *_chain(comparison, part, recovered_share), *_false_depth(comparison, part),
                *_moved(comparison, part, ablations)])
        for part in parts
        if comparison.pairs(part, "fra", "pb")
    ]  # fmt: skip


def _room(comparison: Comparison, part: str) -> Iterator[str]:
    """How far above PB anybody can be."""
    found = comparison.figure(part, "pb", "coverage_5mm")
    if found is None:
        return
    bound = f" The paper's lead of {100 * FRA_LESS_PB_ON_D:.0f} points cannot be reached." if part == "D" else ""
    room = 1 - found.mean
    yield (
        f"PB alone covers {percent(found.mean)} of what can be seen, so nothing can lead it by more than "
        f"{100 * room:.1f} points.{bound if room < FRA_LESS_PB_ON_D else ''}"
    )


def _chain(comparison: Comparison, part: str, recovered_share: float) -> Iterator[str]:
    """What the detector kept, and how recoveries ended."""
    runs = [run.losses for run in comparison.runs(part, "fra")]
    mean = {key: float(np.mean([run[key] for run in runs])) for key in runs[0]}
    yield (
        f"In {mean['views']:.0f} views of a run FRA found {mean['candidate_pixels']:.0f} pixels without depth well "
        f"inside the silhouette; {mean['reflective_pixels']:.0f} of them passed the frontier test, and "
        f"{mean['activations']:.1f} recoveries of {mean['recovery_views']:.1f} views in all came of it."
    )
    if any(run["recovery_views"] for run in runs):
        largest = max(run["largest_gamma"] for run in runs)
        ended = "at least one recovery ended early" if largest > recovered_share else "no recovery ended early"
        yield f"The largest \u0393 of any recovery was {largest:.3f} (\u03c4_rec {recovered_share}): {ended}."


def _false_depth(comparison: Comparison, part: str) -> Iterator[str]:
    """What raw coverage does not show."""
    raw, filtered, free = (
        comparison.figure(part, "fra", name) for name in ("coverage_5mm", "filtered_coverage_5mm", "wrongly_free_share")
    )
    if raw and filtered and free:
        yield (
            f"False depth carved {percent(free.mean)} of the surface's voxels free in FRA's maps; without the points "
            f"that lie there its coverage is {percent(filtered.mean)} instead of {percent(raw.mean)}."
        )


def _moved(comparison: Comparison, part: str, ablations: Mapping[str, NamedAblation]) -> Iterator[str]:
    """Changes of one thing that move coverage or activations beyond the interval."""
    tried, moved = 0, []
    for name, (words, planner, _) in ablations.items():
        difference = comparison.difference(part, name, planner)
        if difference is None:
            continue
        tried += 1
        if _beyond(difference):
            moved.append(f"{words} ({planner.upper()}), coverage {points(difference)}")
        activations = comparison.figure_difference(part, name, planner, "recovery_activations")
        if activations and _beyond(activations):
            moved.append(f"{words} ({planner.upper()}), activations {activations.interval.mean:+.1f}")
    if tried:
        moves = "; ".join(moved) if moved else "none of them moves coverage or activations beyond its interval"
        yield f"{counted(tried, 'ablation')}: {moves}."


def _beyond(difference: Difference) -> bool:
    """Whether zero lies outside the interval; a single run has none."""
    i = difference.interval
    return i.count > 1 and (i.low > 0 or i.high < 0)
