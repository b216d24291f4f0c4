"""Part B1: a 5/2-way pneumatic solenoid valve with G1/4 and G1/8 connections, coil and DIN connector.

Proportions of the common 27 mm wide in-line valves: block 92 x 40 x 27 mm, pilot with a 30 mm coil on one end.
"""

# pyright: reportMissingImports=false
from bd_warehouse.fastener import HexNut, SocketHeadCapScrew
from build123d import Axis, Box, Pos, Rot, Shape, Solid, chamfer, fillet

from scenes.authoring.drawing import DrawnBody, DrawnPart, along, hexagon, tube, turned

VALVE_HEIGHT, DEPTH = 27.0, 40.0
LEFT, RIGHT = -46.0, 46.0
"""Ends of the aluminium block [mm]."""
OUTLETS, INLETS = (-13.0, 13.0), (-26.0, 0.0, 26.0)
"""Ports along the block: A and B at the back, exhaust, supply, exhaust at the front [mm]."""


def part_b1() -> DrawnPart:
    """Valve of about 150 x 85 x 72 mm lying on its lower face."""
    fittings = [along(x, DEPTH / 2, VALVE_HEIGHT / 2, "+y") for x in OUTLETS] + [
        along(0, -DEPTH / 2, VALVE_HEIGHT / 2, "-y")
    ]
    silencers = [along(x, -DEPTH / 2, VALVE_HEIGHT / 2, "-y") for x in (INLETS[0], INLETS[2])]
    brass = [at * s for at in fittings for s in _push_in_fitting()] + [at * _silencer_hexagon() for at in silencers]
    return DrawnPart(
        "B1",
        "pneumatic solenoid valve",
        (
            DrawnBody("valve_body", (_block(),), "aluminium:blasted", "blasted before it is anodised, as usual"),
            DrawnBody("pilot_and_caps", tuple(_plastic_ends()), "black_plastic", "glass-filled polyamide"),
            DrawnBody("coil", tuple(_coil()), "black_plastic", "coil moulded in black epoxy, connector in polyamide"),
            DrawnBody("release_rings", tuple(at * _release_ring() for at in fittings), "black_plastic", "acetal"),
            DrawnBody("fittings", tuple(brass), "brass:bright", "turned brass, as it leaves the lathe"),
            DrawnBody(
                "silencers",
                tuple(at * _silencer() for at in silencers),
                "brass:coarse_blasted",
                "sintered bronze beads",
            ),
            DrawnBody("screws", tuple(_screws()), "stainless_austenitic:bright", "cold-headed screws are left bright"),
        ),
    )


def _block() -> Shape:
    """Block with two cross holes for mounting and a label recess on top."""
    block = Pos((LEFT + RIGHT) / 2, 0, VALVE_HEIGHT / 2) * chamfer(Box(RIGHT - LEFT, DEPTH, VALVE_HEIGHT).edges(), 0.8)
    for x, y in ((-36, 14), (36, -14)):
        block = block - Pos(x, y, -1) * Solid.make_cylinder(2.15, VALVE_HEIGHT + 2)
        block = block - Pos(x, y, VALVE_HEIGHT - 4.5) * Solid.make_cylinder(3.8, 6)
    return block - Pos(0, 0, VALVE_HEIGHT) * Box(44, 22, 1.0)


def _plastic_ends() -> list[Shape]:
    """Pilot housing on the left with its override, end cap on the right."""
    pilot = Pos(LEFT - 13.5, 0, VALVE_HEIGHT / 2) * fillet(Box(27, DEPTH - 2, VALVE_HEIGHT - 1).edges(), 1.5)
    cap = Pos(RIGHT + 5, 0, VALVE_HEIGHT / 2) * fillet(Box(10, DEPTH - 1, VALVE_HEIGHT - 0.6).edges(), 1.2)
    return [pilot, cap]


def _coil() -> list[Shape]:
    """Coil of 30 x 30 x 36 mm over the pilot, with a DIN connector and its cable gland on the far side."""
    x = LEFT - 13.0
    coil = fillet(Box(30, 30, 36).edges().filter_by(Axis.Z), 6.0)
    upright = Pos(x, 0, VALVE_HEIGHT - 0.5 + 18) * coil
    connector = Pos(x - 24, 0, VALVE_HEIGHT + 17) * fillet(Box(20, 27, 27).edges(), 2.0)
    gland = Pos(x - 27, 0, VALVE_HEIGHT + 3.6) * Rot(180, 0, 0) * hexagon(16.0, 0.0, 8.0, 3.2)
    return [upright, connector, gland]


def _push_in_fitting() -> list[Shape]:
    """Push-in fitting G1/4 for 8 mm hose: sealing collar, hexagon 17 mm, sleeve."""
    return [tube(8.4, 4.0, 0.0, 2.0, 0.3), hexagon(17.0, 1.8, 9.0, 4.0), tube(7.2, 4.4, 8.8, 19.0, 0.8)]


def _release_ring() -> Shape:
    """Ring that is pressed to free the hose."""
    return turned([(4.0, 17.0), (5.4, 17.0), (5.4, 20.0), (6.4, 20.0), (6.4, 22.0), (4.0, 22.0)])


def _silencer_hexagon() -> Shape:
    """Turned foot of an exhaust silencer G1/4."""
    return hexagon(16.0, 0.0, 5.0, 3.0)


def _silencer() -> Shape:
    """Sintered body of the silencer."""
    body = turned([(0, 4.5), (6.4, 4.5), (6.4, 13.0), (4.4, 20.0), (0, 20.0)])
    return fillet(body.edges().sort_by(Axis.Z)[-1], 1.5)


def _screws() -> list[Shape]:
    """Cap screws in the end cap and in the connector, and the nut that holds the coil on its tube."""
    cap = [along(RIGHT + 10, y, z, "+x") * SocketHeadCapScrew("M4-0.7", 8) for y in (-14, 14) for z in (6.5, 20.5)]
    pilot = [Pos(LEFT - 8, y, VALVE_HEIGHT - 0.5) * SocketHeadCapScrew("M3-0.5", 6) for y in (-16.2, 16.2)]
    top = VALVE_HEIGHT + 35.5
    nut = Pos(LEFT - 13, 0, top) * HexNut("M8-1.25")
    stem = Pos(LEFT - 13, 0, top - 2) * tube(4.0, 0.0, 0.0, 10.0, 0.8)
    connector = along(LEFT - 47, 0, VALVE_HEIGHT + 17, "-x") * SocketHeadCapScrew("M3-0.5", 6)
    return [*cap, *pilot, nut, stem, connector]
