"""Part E4: two galvanised U brackets on each other, as the paper shows them. For pictures: right in kind only."""

# pyright: reportMissingImports=false
from build123d import Axis, Box, Pos, Rot, Shape, Solid, fillet

from scenes.authoring.drawing import DrawnBody, DrawnPart
from scenes.authoring.folded_sheet import GALVANISED, WHY_GALVANISED, folded

_POST, _WIDTH, _DEPTH, _LIP = 115.0, 62.0, 60.0, 10.0
"""Lower bracket: an upright channel with lips, open towards -y [mm]."""
_UPPER, _SHEET = 60.0, 3.0
"""Height of the upper bracket and thickness of its sheet [mm]."""


def part_e4() -> DrawnPart:
    """Brackets of 180 mm height; a plate juts out by 85 mm towards -y."""
    return DrawnPart(
        "E4",
        "two galvanised U brackets",
        (
            DrawnBody("post", (_post(), _lid()), GALVANISED, WHY_GALVANISED),
            DrawnBody("angle", (_web(), _shelf()), GALVANISED, WHY_GALVANISED),
        ),
    )


def _post() -> Shape:
    """Channel with rows of punched holes in its walls and back."""
    x, y = _WIDTH / 2, _DEPTH / 2
    channel = folded([(-x + _LIP, -y), (-x, -y), (-x, y), (x, y), (x, -y), (x - _LIP, -y)], 2.5, _POST, 2.0)
    for up in range(20, 105, 14):
        channel = channel - Pos(-50, 14, up) * Rot(0, 90, 0) * Solid.make_cylinder(2.5, 100)
        channel = channel - Pos(12, 50, up) * Rot(90, 0, 0) * Solid.make_cylinder(2.5, 40)
    for up in (35, 80):
        channel = channel - Pos(-50, -8, up) * Rot(0, 90, 0) * Solid.make_cylinder(3.0, 100)
    return channel


def _lid() -> Shape:
    """Plate on the channel."""
    lid = fillet(Box(_WIDTH + 4, _DEPTH + 4, 4).edges().filter_by(Axis.Z), 6.0)
    return Pos(0, 0, _POST + 2) * lid


def _web() -> Shape:
    """Upright plate with three holes, its upper flange bent back over +y, bored three times."""
    foot = _POST + 4
    # The path lies in the plane across x: along z, then along y.
    bent = folded([(0, 0), (_UPPER, 0), (_UPPER, 40)], _SHEET, _WIDTH, 3.0)
    web = Pos(-_WIDTH / 2, -18, foot) * Rot(0, -90, 0) * Pos(0, 0, -_WIDTH) * bent
    for x, up in ((-18, 16), (18, 16), (0, 42)):
        web = web - Pos(x, 20, foot + up) * Rot(90, 0, 0) * Solid.make_cylinder(5.5, 80)
    for x in (-20, 0, 20):
        web = web - Pos(x, 12, foot) * Solid.make_cylinder(3.0, 80)
    return web


def _shelf() -> Shape:
    """Thick angle in front of the web: its upper plate juts out, with two holes."""
    foot = _POST + 4 + 4
    bent = folded([(0, 0), (_UPPER - 4, 0), (_UPPER - 4, -85)], 5.0, _WIDTH - 6, 3.0)
    shelf = Pos(-_WIDTH / 2 + 3, -22.5, foot) * Rot(0, -90, 0) * Pos(0, 0, -_WIDTH + 6) * bent
    for x, up in ((-16, 14), (16, 14), (0, 36)):
        shelf = shelf - Pos(x, 0, foot + up) * Rot(90, 0, 0) * Solid.make_cylinder(6.5, 40)
    for y in (-62, -82):
        shelf = shelf - Pos(0, y, foot) * Solid.make_cylinder(5.0, 80)
    return shelf
