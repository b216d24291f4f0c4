"""Part E1: a perforated angle bracket on edge, as the paper shows it. For pictures: right in kind, not in detail."""

# pyright: reportMissingImports=false
from build123d import Axis, Pos, Rot, Shape, Solid, fillet

from scenes.authoring.drawing import DrawnBody, DrawnPart
from scenes.authoring.folded_sheet import GALVANISED, WHY_GALVANISED, folded

_LEG, _HEIGHT, _SHEET, _BEND = 160.0, 120.0, 3.0, 3.0
"""Angle of 160 x 160 mm, 120 mm high, of 3 mm sheet [mm]; proportions as photographed."""
_CORNER = 12.0
"""Rounding of the free corners [mm]."""
_NAILS = ((146, 106), (120, 97), (98, 110), (74, 100), (52, 111), (30, 101), (146, 82), (98, 85))
"""Holes of 8 mm: from the bend and up [mm]; the lower half mirrors them."""
_BOLT = (138, 60)
"""The hole of 18 mm [mm]."""


def part_e1() -> DrawnPart:
    """Angle bracket that stands on its cut edges, bend upright."""
    bracket = folded([(_LEG, 0), (0, 0), (0, _LEG)], _SHEET, _HEIGHT, _BEND)
    for axis, ends in ((Axis.Y, Axis.X), (Axis.X, Axis.Y)):
        bracket = fillet(bracket.edges().filter_by(axis).group_by(ends)[-1], _CORNER)
    for turned in (0, 90):  # along x, then along y
        leg = Rot(0, 0, turned)
        for along, up in (*_NAILS, *((along, _HEIGHT - up) for along, up in _NAILS)):
            bracket = bracket - leg * _hole(along, up, 4.0)
        bracket = bracket - leg * _hole(*_BOLT, 9.0)
    body = DrawnBody("bracket", (bracket,), GALVANISED, WHY_GALVANISED)
    return DrawnPart("E1", "galvanised angle bracket", (body,))


def _hole(along: float, up: float, radius: float) -> Shape:
    """What a punch takes out of the leg along x."""
    return Pos(along, 10, up) * Rot(90, 0, 0) * Solid.make_cylinder(radius, 20)
