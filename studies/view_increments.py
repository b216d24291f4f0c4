"""What single views add to the coverage: recovery views of FRA beside the views of PB (paper, figure 6).

Late views add less than early ones, so they are compared within ranges of the coverage before them.
"""

import numpy as np

from studies.acquisition_table import NBV, RECOVERY
from studies.comparison_statistics import Comparison

BIN = 0.2
"""Width of the ranges of prior coverage in which views are compared [-] (choice: five boxes)."""
FEWEST = 5
"""Views below which a range says nothing (choice: a box plot needs five numbers)."""


def recovery_advantage(comparison: Comparison, part: str) -> float | None:
    """What a recovery view adds more than a PB view at like prior coverage: mean over ranges, by recovery views [-]."""
    gains, weights = [], []
    for ours, theirs in zip(
        binned_increments(comparison, part, "fra", RECOVERY),
        binned_increments(comparison, part, "pb", NBV),
        strict=True,
    ):
        if min(len(ours), len(theirs)) >= FEWEST:
            gains.append(np.mean(ours) - np.mean(theirs))
            weights.append(len(ours))
    return float(np.average(gains, weights=weights)) if gains else None


def binned_increments(comparison: Comparison, part: str, arm: str, kind: str) -> list[list[float]]:
    """Coverage that views of a kind added, by the range of the coverage before them."""
    bins: list[list[float]] = [[] for _ in range(round(1 / BIN))]
    for record in comparison.runs(part, arm):
        for before, added in zip(*record.increments(kind), strict=True):
            bins[min(int(before / BIN + 1e-9), len(bins) - 1)].append(float(added))
    return bins
