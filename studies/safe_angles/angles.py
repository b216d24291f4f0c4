"""From the counts of views to safe angles: bins of incidence with their bounds, and ranges in which all are safe."""

from collections.abc import Iterable, Sequence
from itertools import groupby

import numpy as np

from franbv.surfaces.safe_angles import AngleBin, RollAngles, SafeRange
from render.labels.causes import HOLES
from studies.safe_angles.bounds import effective_views, least_views, most_below, share_bound
from studies.sensitivity.columns import FALSE_DEPTHS, cause_column
from studies.sensitivity.counts import INCIDENCE_BIN_DEG
from studies.sensitivity.shares import (
    Row,
    column_sum,
    false_by_reflection,
    false_depth,
    holes,
    part_pixels,
    pooled_share,
    reflection_holes,
)

LEAST_BIN_PX = 200
"""Pixels that a view must have in a bin to count (choice: a patch of 14 x 14, as in the sensitivity study's report;
smaller ones are roundings of edges, whose depth the edges decide)."""
RIGHT_ANGLE_DEG = 90.0
"""Where the bins end."""


def roll_angles(roll_deg: float, rows: Iterable[Row], target_share: float, confidence: float) -> RollAngles:
    """Bins and ranges of the rows of `incidence.parquet` of one material at one roll."""
    by_middle: dict[float, list[Row]] = {}
    for row in rows:
        by_middle.setdefault(row["incidence_deg"], []).append(row)
    middles = np.arange(INCIDENCE_BIN_DEG / 2, RIGHT_ANGLE_DEG, INCIDENCE_BIN_DEG).tolist()
    bins = tuple(angle_bin(middle, by_middle.get(middle, []), target_share, confidence) for middle in middles)
    return RollAngles(roll_deg, safe_ranges(bins, target_share), bins)


def angle_bin(middle_deg: float, rows: Iterable[Row], target_share: float, confidence: float) -> AngleBin:
    """The bin about this angle, of one row a view."""
    counted = [row for row in rows if part_pixels(row) >= LEAST_BIN_PX]
    seen = np.array([part_pixels(row) for row in counted], int)
    right = np.array([right_pixels(row) for row in counted], int)
    below = int(np.count_nonzero(right < target_share * seen))
    known = effective_views(seen) >= least_views(confidence)
    return AngleBin(
        from_deg=middle_deg - INCIDENCE_BIN_DEG / 2,
        to_deg=middle_deg + INCIDENCE_BIN_DEG / 2,
        views=len(counted),
        effective_views=effective_views(seen),
        part_pixels=int(seen.sum()),
        right_pixels=int(right.sum()),
        share=pooled_share(counted, right_pixels, part_pixels),
        lower_bound=share_bound(right, seen, confidence) if known else None,
        matte_share=pooled_share(counted, _right_if_matte, part_pixels),
        views_below=below,
        views_below_at_most=most_below(below, len(counted), confidence) if known else None,
        lost_to=_commonest_loss(counted),
    )


def right_pixels(row: Row) -> int:
    """Pixels of the part with depth, and that right."""
    return part_pixels(row) - holes(row) - false_depth(row)


def _right_if_matte(row: Row) -> int:
    return right_pixels(row) + reflection_holes(row) + false_by_reflection(row)


def _commonest_loss(rows: Sequence[Row]) -> str | None:
    counts = {cause_column(cause): column_sum(rows, cause_column(cause)) for cause in (*HOLES, *FALSE_DEPTHS)}
    worst = max(counts, key=lambda name: counts[name])
    return worst if counts[worst] else None


def is_safe_bin(found: AngleBin, target_share: float) -> bool:
    """Known, and its lower bound no smaller than the share asked for."""
    return found.lower_bound is not None and found.lower_bound >= target_share


def safe_ranges(bins: Sequence[AngleBin], target_share: float) -> tuple[SafeRange, ...]:
    """Runs of neighbouring safe bins, the widest first, the flatter of equals.

    That every bin of a range named beforehand is safe needs no smaller risk for each (Berger 1982, intersection-union):
    a bad one among them must pass by itself. A range that was searched for has two ends, at each of which the first bad
    bin may pass, so that its risk is twice that of a bin at the most where a material is safe in one range.
    """
    runs = [list(run) for safe, run in groupby(bins, key=lambda found: is_safe_bin(found, target_share)) if safe]
    ranges = [
        SafeRange(
            run[0].from_deg,
            run[-1].to_deg,
            sum(found.right_pixels for found in run) / sum(found.part_pixels for found in run),
            min(found.lower_bound for found in run if found.lower_bound is not None),
        )
        for run in runs
    ]
    return tuple(sorted(ranges, key=lambda span: (span.from_deg - span.to_deg, span.from_deg)))
