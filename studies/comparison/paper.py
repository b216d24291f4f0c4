"""What the authors of FRA-NBV measured on their bench, as data.

Sources: the paper, section VI and Table I, and the figures of its project page (merlinlaboratory.github.io/FRA-NBV,
2026-07), of which only facts are taken. Medians of coverage, recoveries and contribution are printed in the charts;
boxes, whiskers and increments are read off the pictures. Fifteen runs of each method on each object.
"""

from collections.abc import Iterable

import numpy as np

from studies.statistics.boxes import TukeyBox

READING_ERROR = 0.01
"""Of what is read off the pictures [-]: about one point of coverage to either side."""
PAPER_RUNS = 15
"""Of each method on each object."""


def _percent(median: float, box: tuple[float, float], whiskers: tuple[float, float]) -> TukeyBox:
    return TukeyBox(median, *box, *whiskers).scaled(0.01)


FINAL_COVERAGE: dict[str, dict[str, TukeyBox]] = {
    "A": {
        "fra": _percent(93.45, (90, 95), (89, 98)),
        "pb": _percent(84.01, (68, 88), (65, 91)),
        "re": _percent(89.33, (82, 92), (74, 97)),
    },
    "B": {
        "fra": _percent(85.00, (81, 88), (72, 93)),
        "pb": _percent(77.13, (75, 79), (72, 83)),
        "re": _percent(72.28, (70, 77), (65, 86)),
    },
    "C": {
        "fra": _percent(84.74, (82, 90), (77, 93)),
        "pb": _percent(67.95, (61, 70), (56, 75)),
        "re": _percent(64.52, (62, 73), (56, 77)),
    },
    "D": {
        "fra": _percent(76.85, (66, 78), (61, 80)),
        "pb": _percent(45.39, (38, 51), (34, 63)),
        "re": _percent(20.97, (17, 26), (8, 36)),
    },
}
"""Share of the surface that is covered at the end of a run [-], by object and method."""
PAPER_PARTS = tuple(FINAL_COVERAGE)
"""Its objects."""
PAPER_METHODS = tuple(FINAL_COVERAGE["A"])
"""Its planners, by the names that ours have."""
ACTIVATIONS: dict[str, TukeyBox] = {
    "A": TukeyBox(2, 1.5, 3),
    "B": TukeyBox(3, 2, 4),
    "C": TukeyBox(6, 5, 8, high=12),
    "D": TukeyBox(7, 5.5, 9, high=12),
}
"""Recoveries that a run of FRA sets off [-]."""
CONTRIBUTION: dict[str, TukeyBox] = {
    "A": TukeyBox(6.96, low=-3, high=27).scaled(0.01),
    "B": TukeyBox(12.09, low=-1, high=26).scaled(0.01),
    "C": TukeyBox(24.77, low=6, high=48).scaled(0.01),
    "D": TukeyBox(34.56, low=20, high=71).scaled(0.01),
}
"""Coverage that the recovery views of a run add in all [-]. It falls below zero, as single increments do (to -0.14 on B
and -0.06 on D): what their coverage counts can be lost again, so it is not a cloud that only grows."""
INCREMENTS: dict[str, dict[int, tuple[float | None, float | None]]] = {
    "B": {
        20: (0.207, None), 30: (0.162, None), 40: (0.055, 0.067), 50: (0.046, 0.049), 60: (0.018, 0.029),
        70: (0.004, 0.005), 80: (-0.016, 0.003),
    },
    "D": {
        10: (0.026, 0.112), 20: (0.020, 0.077), 30: (0.005, 0.039), 40: (0.006, 0.035), 50: (0.005, 0.016),
        60: (None, 0.012), 70: (None, 0.010),
    },
}  # fmt: skip
"""Median coverage that a view adds [-], by the coverage before it in ranges of 10 points, named by their lower end [%]:
views of PB, recovery views of FRA; None where the paper has too few views."""
ITERATION_S = {
    "A": {"fra": (18.84, 23.09, 25.79), "pb": (18.81, 20.45, 26.11), "re": (45.65, 47.48, 48.70)},
    "B": {"fra": (22.40, 25.28, 28.19), "pb": (20.78, 21.72, 24.92), "re": (47.50, 51.76, 54.71)},
    "C": {"fra": (29.40, 31.87, 38.01), "pb": (20.64, 21.62, 22.52), "re": (45.66, 46.76, 48.01)},
    "D": {"fra": (29.01, 33.10, 34.53), "pb": (13.97, 16.51, 18.47), "re": (45.77, 46.66, 49.10)},
}
"""Table I: lower quartile, median and upper quartile [s]. Section VI-D calls it the average time of an iteration with
its recoveries, the caption the time per acquisition."""

CONTRIBUTION_OF_MATTE, CONTRIBUTION_OF_SHINY = 0.10, 0.30
"""Coverage that recoveries brought, "around 10 %" on A and B, "up to approximately 30 %" on C and D."""


def paper_lead(part: str, baseline: str) -> float:
    """Median coverage of FRA less that of a baseline [-]: on D "up to 31 %" and "approximately 56 %" in the text."""
    return FINAL_COVERAGE[part]["fra"].median - FINAL_COVERAGE[part][baseline].median


def paper_order(part: str) -> tuple[str, ...]:
    """The three methods by their median coverage, the best first."""
    methods = FINAL_COVERAGE[part]
    return tuple(sorted(methods, key=lambda arm: -methods[arm].median))


def paper_ratio(ours: str, theirs: str, parts: Iterable[str] = "ABCD") -> float:
    """Mean over the parts of the ratio of the paper's median times."""
    return float(np.mean([ITERATION_S[part][ours][1] / ITERATION_S[part][theirs][1] for part in parts]))
