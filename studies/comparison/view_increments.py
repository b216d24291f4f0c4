"""What single views add to the coverage of the map: recovery views of FRA beside the views of PB (paper, figure 6).

Late views add less than early ones, so they are compared within ranges of the coverage before them. The views of one
run hang together, so that the interval comes from drawing whole starts (Efron and Tibshirani 1993, chapter 8).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from studies.comparison.records import Record
from studies.comparison.statistics import Comparison
from studies.run.acquisition_table import NBV, RECOVERY
from studies.statistics.intervals import Interval, bootstrap_ends, resampled

BIN = 0.1
"""Width of the ranges of prior coverage in which views are compared [-] (paper, figure 6)."""
FEWEST_VIEWS = 5
"""Views below which a range says nothing (choice: a box plot needs five numbers)."""


@dataclass(frozen=True)
class Advantage:
    """Recovery views of FRA less views of PB at like prior coverage."""

    gain: Interval
    """Coverage that a view adds more [-]: mean over the ranges, by recovery views. It counts runs of FRA that have a
    recovery view in them."""
    pb: float
    """What a view of PB adds in the same ranges, by the same weights [-]."""


def recovery_advantage(comparison: Comparison, part: str) -> Advantage | None:
    """None where no range has enough views of both."""
    pairs = comparison.pairs(part, "fra", "pb")
    if not pairs:
        return None
    ours, theirs = (
        np.stack([_sums(pair[side], kind) for pair in pairs]) for side, kind in ((0, RECOVERY), (1, NBV))
    )  # (starts, 2, ranges) views, what they added
    enough = np.minimum(ours.sum(0)[0], theirs.sum(0)[0]) >= FEWEST_VIEWS
    if not enough.any():
        return None
    draws = np.vstack([np.arange(len(pairs)), resampled(len(pairs))])  # the runs that there are, then samples of them
    gains, pb = _gain(ours[draws].sum(1), theirs[draws].sum(1), enough)
    runs = int((ours[:, 0, enough].sum(axis=1) > 0).sum())
    low, high = bootstrap_ends(gains[np.isfinite(gains)], runs)
    return Advantage(Interval(float(gains[0]), low, high, runs), float(pb[0]))


def _sums(record: Record, kind: str) -> Float[np.ndarray, "2 ranges"]:
    """Views of a kind in each range of prior coverage, and what they added."""
    before, added = record.increments(kind)
    places, n = _range_of(before), round(1 / BIN)
    return np.stack([np.bincount(places, minlength=n), np.bincount(places, added, minlength=n)]).astype(float)


def _range_of(before: Float[np.ndarray, "v"]):
    return np.minimum((before / BIN + 1e-9).astype(int), round(1 / BIN) - 1)


def _gain(
    ours: Float[np.ndarray, "n 2 ranges"], theirs: Float[np.ndarray, "n 2 ranges"], enough: Bool[np.ndarray, "ranges"]
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Advantage and PB's own mean increment over those ranges that have views of both; NaN without any."""
    (n_ours, by_ours), (n_theirs, by_theirs) = (np.moveaxis(sums, 1, 0) for sums in (ours, theirs))
    weights = np.where(enough & (n_theirs > 0), n_ours, 0.0)
    weights /= np.where(weights.any(1), weights.sum(1), np.nan)[:, None]
    pb = by_theirs / np.maximum(n_theirs, 1)
    gain = by_ours / np.maximum(n_ours, 1) - pb
    return (weights * gain).sum(1), (weights * pb).sum(1)


def binned_increments(comparison: Comparison, part: str, arm: str, kind: str) -> list[list[float]]:
    """Coverage that views of a kind added, by the range of the coverage before them."""
    bins: list[list[float]] = [[] for _ in range(round(1 / BIN))]
    for record in comparison.runs(part, arm):
        before, added = record.increments(kind)
        for place, value in zip(_range_of(before), added, strict=True):
            bins[place].append(float(value))
    return bins
