"""What the FRA-NBV paper measured (section VI, Table I)."""

from collections.abc import Iterable

import numpy as np

FRA_LESS_PB_ON_D, FRA_LESS_RE_ON_D = 0.31, 0.56
"""Coverage, "up to 31 %" and "approximately 56 %" higher, read as points of coverage: the paper does not say whether
it means points or a share of the baseline's coverage, and points ask for more."""
CONTRIBUTION_OF_MATTE, CONTRIBUTION_OF_SHINY = 0.10, 0.30
"""Share of the coverage that recoveries brought, "around 10 %" on A and B, "up to approximately 30 %" on C and D."""
ITERATION_S = {
    "A": {"fra": (18.84, 23.09, 25.79), "pb": (18.81, 20.45, 26.11), "re": (45.65, 47.48, 48.70)},
    "B": {"fra": (22.40, 25.28, 28.19), "pb": (20.78, 21.72, 24.92), "re": (47.50, 51.76, 54.71)},
    "C": {"fra": (29.40, 31.87, 38.01), "pb": (20.64, 21.62, 22.52), "re": (45.66, 46.76, 48.01)},
    "D": {"fra": (29.01, 33.10, 34.53), "pb": (13.97, 16.51, 18.47), "re": (45.77, 46.66, 49.10)},
}
"""Table I: lower quartile, median and upper quartile [s]. Section VI-D calls it the average time of an iteration with
its recoveries, the caption the time per acquisition."""


def paper_ratio(ours: str, theirs: str, parts: Iterable[str] = "ABCD") -> float:
    """Mean over the parts of the ratio of the paper's medians."""
    return float(np.mean([ITERATION_S[part][ours][1] / ITERATION_S[part][theirs][1] for part in parts]))
