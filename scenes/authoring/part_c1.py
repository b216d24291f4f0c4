"""Part C1: a milled steel block with inclined faces."""

# pyright: reportMissingImports=false
from build123d import Box, Plane, Polyline, Pos, Rot, chamfer, extrude, make_face

from scenes.authoring.drawing import DrawnBody, DrawnPart


def part_c1() -> DrawnPart:
    """Block of 120 x 70 x 55 mm with faces inclined by 30 and 45 deg along x and by 20 deg off the upright along y."""
    outline = [(-60, 0), (60, 0), (60, 20), (25, 55), (-10, 55), (-60, 26.13), (-60, 0)]
    block = extrude(make_face(Plane.XZ * Polyline(*outline)), 35, both=True)
    slanted = Pos(0, 35, 20) * Rot(20, 0, 0) * Pos(0, 50, 50) * Box(200, 100, 100)
    block = block - slanted
    body = DrawnBody(
        "block",
        (chamfer(block.edges(), 0.5),),
        "iron:milled",
        "inclined faces are milled in one clamping; between painted and polished, as the paper's 'medium reflectivity'",
    )
    return DrawnPart("C1", "milled steel block with inclined faces", (body,))
