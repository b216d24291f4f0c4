"""Part B: the paper's filter-regulator, standing on its knob.

Proportions are read off the published photograph at 230 mm of height, to about 15 %; what it does not show (depth, the
three other faces) is as catalogues of 3/8 inch units have it. The bowl's print is left out: ink is clear at 850 nm.
"""

# pyright: reportMissingImports=false
from bd_warehouse.fastener import SocketHeadCapScrew
from build123d import Axis, Box, Pos, Rot, Shape, Solid, fillet

from scenes.authoring.drawing import DrawnBody, DrawnPart, along, turned

_KNOB, _COLLAR, _BODY, _BOWL, _TOP = 44.0, 11.0, 48.0, 100.0, 26.0
"""Heights from the bottom up [mm]."""
_BODY_FOOT = _KNOB + _COLLAR
_BOWL_FOOT = _BODY_FOOT + _BODY
_WIDTH, _DEPTH = 54.0, 50.0
"""Of the body [mm]; the depth is a choice between bowl and width."""
_PORT_HEIGHT = _BODY_FOOT + 19.0
"""The port sits 5 mm below the middle of the body [mm]."""
_PORT_RADIUS, _PORT_MOUTH = 14.950 / 2, 16.662 / 2
"""Minor and major radius of G3/8, ISO 228-1 [mm]: the hole measures 15 mm. Its thread, in the dark, is a bore."""
_PORT_DEPTH = 13.0
_SEAT_RADIUS = 10.5
"""Of the spot face around a port [mm], as photographed."""
_TAPPED_RADIUS, _TAPPED_AT = 4.134 / 2, 20.5
"""Minor radius of the M5 holes beside the port, ISO 724, and their distance from it [mm]."""
_SCREW_AT = 20.0
"""Of the bonnet's four screws from the middle, along x and y [mm]."""


def part_b() -> DrawnPart:
    """Filter-regulator of 54 x 50 x 229 mm."""
    screws = [along(x, y, _KNOB + 5.0, "-z") * SocketHeadCapScrew("M5-0.8", 8) for x, y in _corners()]
    return DrawnPart(
        "B",
        "pneumatic filter-regulator",
        (
            DrawnBody("regulator", (_knob(), _collar()), "black_plastic", "polyamide, black by soot as usual"),
            DrawnBody(
                "body", (_body(),), "matte_paint", "die-cast and painted light grey; the catalogue's is on metal"
            ),
            DrawnBody(
                "bowl",
                (_bowl(),),
                "white_plastic",
                "white enamel has a satin gloss: titania under clear binder, as white plastic; `white_paint` has none",
            ),
            DrawnBody("drain", (_drain(),), "black_plastic", "polyamide, as the knob"),
            DrawnBody("screws", tuple(screws), "oxide", "dark in the photograph: blackened steel, which is iron oxide"),
        ),
    )


def _corners() -> list[tuple[float, float]]:
    return [(x, y) for x in (-_SCREW_AT, _SCREW_AT) for y in (-_SCREW_AT, _SCREW_AT)]


def _knob() -> Shape:
    """Knob of 33 mm with twelve finger flutes below its smooth rim."""
    knob = turned([(0, 0), (15.5, 0), (16.5, 1.0), (16.5, _KNOB - 3.0), (15.5, _KNOB - 2.0), (15.5, _KNOB), (0, _KNOB)])
    for turn in range(12):
        knob = knob - Rot(0, 0, 30 * turn) * Pos(17.5, 0, -1) * Solid.make_cylinder(2.2, 28)
    return knob


def _collar() -> Shape:
    """Bonnet flange of 50 mm over a cone."""
    flange = Pos(0, 0, _KNOB + 8.0) * fillet(Box(50, 49, 6).edges().filter_by(Axis.Z), 5.0)
    return flange + turned([(0, _KNOB), (17.0, _KNOB), (20.5, _KNOB + 4.0), (20.5, _KNOB + 6.0), (0, _KNOB + 6.0)])


def _body() -> Shape:
    """Die-cast block with a port in each upright face; those in front and back have a tapped hole on either side."""
    block = Pos(0, 0, _BODY_FOOT + _BODY / 2) * fillet(Box(_WIDTH, _DEPTH, _BODY).edges(), 1.5)
    for toward in ("+x", "-x"):
        block = block - along(_away(toward, _WIDTH), 0, _PORT_HEIGHT, toward) * _port()
    for toward in ("+y", "-y"):
        block = block - along(0, _away(toward, _DEPTH), _PORT_HEIGHT, toward) * _port()
        for x in (-_TAPPED_AT, _TAPPED_AT):
            hole = turned([(0, 1), (3.6, 1), (2.6, 0), (_TAPPED_RADIUS, -0.6), (_TAPPED_RADIUS, -9), (0, -9)])
            block = block - along(x, _away(toward, _DEPTH), _PORT_HEIGHT, toward) * hole
    return block


def _away(toward: str, length: float) -> float:
    """Where the face that looks `toward` lies [mm]."""
    return length / 2 if toward[0] == "+" else -length / 2


def _port() -> Shape:
    """What a port takes out of a face at z = 0 that looks along +z: spot face, countersink, bore."""
    sunk = _PORT_MOUTH + 0.3
    return turned(
        [
            (0, 1),
            (_SEAT_RADIUS, 1),
            (_SEAT_RADIUS, -0.8),
            (sunk, -0.8),
            (_PORT_RADIUS, -0.8 - (sunk - _PORT_RADIUS)),
            (_PORT_RADIUS, -_PORT_DEPTH),
            (0, -_PORT_DEPTH),
        ]
    )


def _bowl() -> Shape:
    """Bowl of 42 mm, 1 deg of draft, its end rounded by 6 mm."""
    bowl = turned([(0, _BOWL_FOOT), (21.5, _BOWL_FOOT), (20.0, _BOWL_FOOT + _BOWL), (0, _BOWL_FOOT + _BOWL)])
    return fillet(bowl.edges().sort_by(Axis.Z)[-1], 6.0)


def _drain() -> Shape:
    """Drain knob of 20 mm, ribbed below, plain above."""
    foot = _BOWL_FOOT + _BOWL
    knob = turned(
        [
            (0, foot - 1),
            (8.0, foot - 1),
            (8.0, foot + 1),
            (10.0, foot + 1),
            (10.0, foot + 13),
            (9.3, foot + 14),
            (9.3, foot + _TOP - 1),
            (8.3, foot + _TOP),
            (0, foot + _TOP),
        ]
    )
    for turn in range(12):
        knob = knob - Rot(0, 0, 30 * turn) * Pos(10.4, 0, foot + 1.5) * Solid.make_cylinder(1.0, 11)
    return knob
