"""Part D: the paper's column of bright turned fittings."""

from scenes.authoring.columns import column
from scenes.authoring.drawing import DrawnBody, DrawnPart

SLEEVES = 4
"""Four necks are to be seen; the five wide places are a foot, three joints and an open end."""
PLATED = "nickel:bright"
WHY_PLATED = (
    "turned from bar and nickel-plated, as catalogues of couplings have it: warm grey beside a white table; a bright "
    "bath levels the lathe's marks, so it has no lay. Where a mirror would show the plinth 6 to 12 deg from its edge "
    "the photo has 14 to 18 % of the light from beyond the edge, as GGX of about 0.06 to 0.10 does"
)


def part_d() -> DrawnPart:
    """Column of 31 mm width and 252 mm height."""
    fittings = DrawnBody("fittings", tuple(column(SLEEVES)), PLATED, WHY_PLATED)
    return DrawnPart("D", "column of nickel-plated fittings", (fittings,))
