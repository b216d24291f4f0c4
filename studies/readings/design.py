"""Sixteen cells in which thirteen decisions of two levels are tried at once: a two-level fractional factorial.

The columns are those of the Hadamard matrix of order 16 but the first (Sylvester's; Plackett and Burman 1946): each
decision stands at each level in eight cells, and of the eight in which one is at a level, every other one is at its
first in four. So main effects are clear of each other. Resolution III: each is mixed with seven interactions of two
decisions, and larger ones.

The columns of FIVE are 1, 2, 4, 8 and 15, a half fraction of resolution V: what those five do alone is clear of what
any two of them do together, and each of the other columns holds exactly one such pair. So where one of the others
seems to matter, its pair is the other explanation, and the page names it.

Columns 10 and 11 are empty. Two decisions stood there that the paper's own counts refute: to recover all regions of a
burst instead of the largest, and up to three recoveries in one iteration. In the cells that had both, C and D took up
to 146 acquisitions and 43 activations (the paper has 6 and 7), and a run of them takes ten times as long.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int
from scipy.linalg import hadamard

from studies.readings.decisions import DECISIONS

N_CELLS = 16
"""Of the design."""

FIVE: Mapping[str, int] = {
    "miss_probability": 1,
    "located_on": 2,
    "occupied_probability": 4,
    "frames_into_map": 8,
    "detection_ellipsoids": 15,
}
"""Decisions that are expected to matter most, and their columns. Choice: what enters the map and stays there, and which
holes count as reflective."""
OTHERS: Mapping[str, int] = {
    "cluster": 3,
    "stagnation_against": 5,
    "silhouette_of": 6,
    "covariance": 7,
    "capacity": 9,
    "max_components": 12,
    "weighting": 13,
    "first_elevation": 14,
}
"""The others. Choice: where a pair of FIVE is likely to act together (the three of the map, the two of the detector)
stands one that is expected to matter least."""
COLUMN: Mapping[str, int] = {**FIVE, **OTHERS}
"""Of the Hadamard matrix, by decision."""


@dataclass(frozen=True)
class DesignCell:
    """One reading that is tried."""

    number: int
    """Row of the Hadamard matrix; 0 has all decisions at their first level."""
    second: frozenset[str]
    """Decisions that are at their second level."""


def level_signs() -> Int[np.ndarray, "cells decisions"]:
    """+1 where a cell has a decision at its second level, -1 at the first; decisions in the order of DECISIONS."""
    return -hadamard(N_CELLS)[:, [COLUMN[decision.name] for decision in DECISIONS]]


def design_cells() -> tuple[DesignCell, ...]:
    """All cells, by number."""
    names = [decision.name for decision in DECISIONS]
    rows = level_signs() > 0
    return tuple(
        DesignCell(number, frozenset(name for name, is_second in zip(names, row, strict=True) if is_second))
        for number, row in enumerate(rows)
    )


def mixed_with(name: str) -> tuple[tuple[str, str], ...]:
    """The seven pairs of decisions whose interaction cannot be told from this one's effect; the pair of FIVE first.

    The product of two columns of Sylvester's matrix is the column whose number is their exclusive or.
    """
    names = list(COLUMN)
    pairs = [
        (one, other)
        for k, one in enumerate(names)
        for other in names[k + 1 :]
        if COLUMN[one] ^ COLUMN[other] == COLUMN[name]
    ]
    return tuple(sorted(pairs, key=lambda pair: not set(pair) <= set(FIVE)))
