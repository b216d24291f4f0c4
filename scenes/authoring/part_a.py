"""Part A: the paper's plain steel block, satin grey. Sizes are read off the published photograph, to about 15 %."""

# pyright: reportMissingImports=false
from build123d import Box, Pos, chamfer

from scenes.authoring.drawing import DrawnBody, DrawnPart

_WIDTH, _DEPTH, _HEIGHT = 100.0, 40.0, 160.0
"""Beside the 250 mm wide plinth that it stands on [mm]."""
_EDGE = 0.3
"""Chamfer of broken edges [mm]: they look sharp in the photograph; workshops break them by a few tenths (ISO 13715)."""


def part_a() -> DrawnPart:
    """Upright block of 100 x 40 x 160 mm."""
    block = Pos(0, 0, _HEIGHT / 2) * chamfer(Box(_WIDTH, _DEPTH, _HEIGHT).edges(), _EDGE)
    body = DrawnBody(
        "block",
        (block,),
        "iron:blasted",
        "bare steel, bead-blasted: no highlight in any photograph, yet its faces differ in brightness with what lies "
        "opposite and darken towards the black plinth over a third of their height, as a wide lobe does and a coat not",
    )
    return DrawnPart("A", "satin-grey steel block", (body,))
