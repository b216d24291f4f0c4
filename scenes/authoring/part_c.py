"""Part C: the paper's aluminium wedge. Sizes are read off the published photographs, to about 15 %."""

# pyright: reportMissingImports=false
from bd_warehouse.fastener import SocketHeadCapScrew
from build123d import Axis, Box, Location, Plane, Polyline, Pos, Shape, Solid, chamfer, extrude, fillet, make_face

from scenes.authoring.drawing import DrawnBody, DrawnPart

_SIDE, _THICKNESS = 180.0, 45.0
"""Legs of the right-angled triangle and width of the inclined face [mm]."""
_BLUNT = 6.0
"""Height of the end that takes the place of the sharp tip, below and on top [mm]."""
_HEEL_RADIUS = 8.0
"""Rounding of the right angle [mm]."""
_EDGE = 0.5
"""Chamfer of the triangles' edges [mm]: a bright line of a pixel in the photographs."""
_SCREWS = {
    # thread: head height, counterbore diameter (ISO 4762; DIN 974-1 row 1), and where, up the slope and across [mm]
    "M8-1.25": (8.0, 15.0, ((64.0, 13.0), (-64.0, -13.0))),
    "M5-0.8": (5.0, 10.0, ((64.0, -13.0), (-64.0, 13.0))),
}
"""Two large heads on one diagonal and two small ones on the other; 13 and 9 mm wide in the photographs."""
_CLEARANCE = {"M8-1.25": 0.6, "M5-0.8": 0.4}
"""Depth by which a head lies below the face, DIN 974-1 [mm]."""


def part_c() -> DrawnPart:
    """Wedge of 180 x 45 x 180 mm on one of its legs, the inclined face towards -x."""
    wedge = _wedge()
    inner = _THICKNESS - 2 * _EDGE
    slabs = [wedge & Pos(0, s * (inner + _EDGE) / 2, _SIDE / 2) * Box(2 * _SIDE, _EDGE, 2 * _SIDE) for s in (-1, 1)]
    block = wedge & Pos(0, 0, _SIDE / 2) * Box(2 * _SIDE, inner, 2 * _SIDE)
    screws = []
    for thread, (head, bore, places) in _SCREWS.items():
        depth = head + _CLEARANCE[thread]
        for up, across in places:
            seat = _inclined(up, across) * Pos(0, 0, -depth)
            block = block - seat * Solid.make_cylinder(bore / 2, depth + 1)
            screws.append(seat * SocketHeadCapScrew(thread, 12))
    return DrawnPart(
        "C",
        "aluminium wedge with screws",
        (
            DrawnBody(
                "block", (block,), "aluminium:milled", "the inclined face shows the cutter's streaks up the slope"
            ),
            DrawnBody(
                "sides",
                tuple(slabs),
                "aluminium:polished",
                "swirls of all directions, which leave no lay; in the photo they mirror the plinth's edge with 3 to "
                "15 deg of blur (10 to 90 % of the step), as GGX of about 0.01 to 0.05 does: 5.3 alpha",
            ),
            DrawnBody("screws", tuple(screws), "stainless_austenitic:bright", "cold-headed A2 screws are left bright"),
        ),
    )


def _wedge() -> Shape:
    """The whole wedge, tips blunt, heel round, side edges broken."""
    half = _SIDE / 2
    outline = [(-half, 0), (half, 0), (half, _SIDE), (half - _BLUNT, _SIDE), (-half, _BLUNT), (-half, 0)]
    wedge = extrude(make_face(Plane.XZ * Polyline(*outline)), _THICKNESS / 2, both=True)
    upright = wedge.edges().filter_by(Axis.Y).group_by(Axis.X)[-1].sort_by(Axis.Z)
    wedge = fillet(upright[0], _HEEL_RADIUS)
    top = wedge.edges().filter_by(Axis.Y).group_by(Axis.Z)[-1].sort_by(Axis.X)[-1]
    wedge = fillet(top, _BLUNT - 2.0)
    faces = wedge.faces().filter_by(Axis.Y)
    return chamfer([edge for face in faces for edge in face.edges()], _EDGE)


def _inclined(up: float, across: float) -> Location:
    """A place on the inclined face: `up` the slope and `across` (+y) from its middle [mm], looking outward."""
    middle = (-_BLUNT / 2, 0, (_SIDE + _BLUNT) / 2)
    return Plane(origin=middle, x_dir=(1, 0, 1), z_dir=(-1, 0, 1)).location * Pos(up, across, 0)
