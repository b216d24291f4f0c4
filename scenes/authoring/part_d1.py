"""Part D1: polished stainless fittings on a manifold block."""

# pyright: reportMissingImports=false
from bd_warehouse.fastener import SocketHeadCapScrew
from build123d import Box, Pos, Rot, Shape, Solid, chamfer
from scipy.spatial.transform import RigidTransform

from scenes.authoring.drawing import DrawnBody, DrawnPart, along
from scenes.authoring.fittings import (
    NIPPLE_HEX_HEIGHT,
    compression_joint,
    elbow,
    nipple_hexagon,
    nipple_thread,
    pipe_stub,
    plug,
    tee,
    union,
)
from scenes.primitives import moved
from scenes.scene import Mesh

LENGTH, WIDTH, MANIFOLD_HEIGHT = 140.0, 44.0, 38.0
PORTS = (-52.0, -17.0, 18.0, 53.0)
"""Port positions along the block: 35 mm apart leaves 6 mm between beads [mm]."""
SCREWS = (-34.5, 35.5)
"""Fixing screws, between the ports [mm]."""
POLISHED = "stainless_austenitic:polished"
WHY_POLISHED = "fittings of food and laboratory piping are mechanically polished"


def part_d1() -> DrawnPart:
    """Five fittings on a block of 140 x 44 x 38 mm: elbow, plugged tee, union with pipe, nipple, compression joint."""
    seats = [Pos(x, 0, MANIFOLD_HEIGHT) for x in PORTS]
    over_hexagon = Pos(0, 0, NIPPLE_HEX_HEIGHT + 1.0)  # a tightened joint leaves one turn of thread bare
    elbow_at = seats[0] * over_hexagon * Rot(0, 0, 235)
    tee_at = seats[1] * over_hexagon * Rot(0, 0, 90)
    tee_end = tee_at * Pos(27, 0, 27) * Rot(0, 90, 0)
    side = along(LENGTH / 2, 0, MANIFOLD_HEIGHT / 2, "+x")
    fittings = {
        "elbow": [seats[0] * nipple_hexagon(), elbow_at * elbow()],
        "tee": [seats[1] * nipple_hexagon(), tee_at * tee(), tee_end * plug()],
        "union": [seats[2] * s for s in [*union(), Pos(0, 0, 45) * pipe_stub(15)]],
        "nipple": [seats[3] * nipple_hexagon(), _thread_at(PORTS[3], MANIFOLD_HEIGHT + NIPPLE_HEX_HEIGHT)],
        "compression_joint": [side * s for s in compression_joint(13)],
    }
    screws = [Pos(x, y, MANIFOLD_HEIGHT) * SocketHeadCapScrew("M6-1", 12) for x in SCREWS for y in (-14, 14)]
    why_milled = "blocks are milled from bar and left so"
    return DrawnPart(
        "D1",
        "polished stainless fittings on a manifold",
        (
            DrawnBody("manifold", (_manifold(),), "stainless_austenitic:milled", why_milled),
            *(DrawnBody(name, tuple(solids), POLISHED, WHY_POLISHED) for name, solids in fittings.items()),
            DrawnBody("screws", tuple(screws), "stainless_austenitic:bright", "cold-headed A2 screws are left bright"),
        ),
    )


def _manifold() -> Shape:
    """The block with its edges broken and two open ports in the front."""
    block = chamfer(Box(LENGTH, WIDTH, MANIFOLD_HEIGHT).edges(), 1.0)
    block = Pos(0, 0, MANIFOLD_HEIGHT / 2) * block
    for x in (PORTS[1], PORTS[2]):
        hole = along(x, -WIDTH / 2, MANIFOLD_HEIGHT / 2, "-y")
        block = block - hole * Pos(0, 0, -15) * Solid.make_cylinder(9.4, 16)
    return block


def _thread_at(x: float, z: float) -> Mesh:
    """The free thread of the nipple, its foot at (x, 0, z) [mm]."""
    return moved(nipple_thread(), RigidTransform.from_translation([x / 1000, 0, z / 1000]))
