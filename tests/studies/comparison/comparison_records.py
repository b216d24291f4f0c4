"""Runs of a comparison made by hand: what a test says of coverage, kinds and times, all else plain."""

import numpy as np

from studies.comparison.records import Record

LOSSES = {
    "views": 10, "invalid_pixels": 900, "candidate_pixels": 50, "reflective_pixels": 20, "regions": 2,
    "activations": 1, "poses": 4, "recovery_views": 4, "largest_gamma": 0.05,
}  # fmt: skip


def made_record(
    part: str = "D",
    arm: str = "fra",
    run: int = 0,
    coverage: tuple[float, ...] = (0.3, 0.5, 0.6),
    kinds: str = "fnn",
    raw: tuple[float, ...] | None = None,
    planning_s: float = 0.1,
    motion_s: float = 1.0,
    activations: int = 0,
) -> Record:
    """One run; `kinds` spells first, nbv and recovery by their initials, a recovery belongs to the view before it.

    coverage: of the map; raw: of the cloud, the same unless it is given.
    """
    names = {"f": "first", "n": "nbv", "r": "recovery"}
    iterations = np.cumsum([kind == "n" for kind in kinds])
    increments = np.diff(coverage, prepend=0.0)
    recovered = sum(step for step, kind in zip(increments, kinds, strict=True) if kind == "r")
    cloud = raw or coverage
    summary = {
        "coverage_map_5mm": coverage[-1],
        "recovery_contribution": recovered,
        "coverage_5mm": cloud[-1],
        "filtered_coverage_5mm": coverage[-1],
        "accuracy_mm": 2.0,
        "accuracy_median_mm": 1.0,
        "f_score": 0.8,
        "filtered_f_score": 0.8,
        "wrongly_free_share": 0.1,
        "wrongly_occupied_share": None,
        "acquisitions": len(kinds),
        "nbv_iterations": int(iterations[-1]),
        "recovery_activations": activations,
        "recovery_acquisitions": kinds.count("r"),
        "recovery_share": recovered / coverage[-1],
        "stop": "max_iterations",
    }
    return Record(
        part=part,
        arm=arm,
        run=run,
        case=f"{part}{arm}{run}",
        summary=summary,
        coverage=np.array(coverage),
        raw=np.array(cloud),
        kinds=tuple(names[kind] for kind in kinds),
        iterations=iterations,
        planning_s=np.full(len(kinds), planning_s),
        motion_s=np.full(len(kinds), motion_s),
        n_frames=15,
        processor_s=50.0,
        versions={"python": "3.11.7", "numpy": "2.4.6"},
        losses=LOSSES,
    )
