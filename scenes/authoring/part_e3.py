"""Part E3: a half ring of columns as D's, three sleeves high, as the paper shows it."""

# pyright: reportMissingImports=false
from build123d import Pos, Rot, Shape

from scenes.authoring.columns import column
from scenes.authoring.drawing import DrawnBody, DrawnPart
from scenes.authoring.part_d import PLATED, WHY_PLATED

_COLUMNS, _SLEEVES = 9, 3
"""As photographed."""
_RADIUS, _STEP = 80.0, 23.0
"""Of the ring [mm], and the angle from column to column [deg] (choice: 1 mm between them, as photographed)."""


def part_e3() -> DrawnPart:
    """Nine columns of 189 mm, open towards -y; three bodies, so that no mesh file is large."""
    groups = {"left": range(3), "middle": range(3, 6), "right": range(6, 9)}
    bodies = [
        DrawnBody(name, tuple(sleeve for place in places for sleeve in _at(place)), PLATED, WHY_PLATED)
        for name, places in groups.items()
    ]
    return DrawnPart("E3", "half ring of nickel-plated columns", tuple(bodies))


def _at(place: int) -> list[Shape]:
    """The column with this number, from -x over +y to +x."""
    angle = 90.0 + _STEP * ((_COLUMNS - 1) / 2 - place)
    return [Rot(0, 0, angle) * Pos(_RADIUS, 0, 0) * sleeve for sleeve in column(_SLEEVES)]
