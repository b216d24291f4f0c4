"""Part A1: a plain steel cuboid under matte paint."""

# pyright: reportMissingImports=false
from build123d import Box, Pos, fillet

from scenes.authoring.drawing import DrawnBody, DrawnPart


def part_a1() -> DrawnPart:
    """Cuboid of 120 x 80 x 60 mm, edges rounded by the paint."""
    cuboid = Box(120, 80, 60)
    body = DrawnBody(
        "cuboid",
        (Pos(0, 0, 30) * fillet(cuboid.edges(), 1.5),),
        "matte_paint",
        "bare metal has no diffuse reflection, however rough it is blasted: a steel part that is 'non-reflective' "
        "carries a coat",
    )
    return DrawnPart("A1", "matte steel cuboid", (body,))
