"""Part E2: a bidet tap on an upturned can, as the paper shows it. For pictures: right in kind, not in detail."""

# pyright: reportMissingImports=false
from build123d import Axis, Location, Plane, Polyline, Pos, Rot, Shape, Spline, extrude, fillet, make_face

from scenes.authoring.drawing import DrawnBody, DrawnPart, turned
from scenes.authoring.folded_sheet import GALVANISED, WHY_GALVANISED

_CAN = 95.0
"""Height of the can [mm]; its bottom, on top here, is 96 mm wide and its mouth 116 mm."""
_SPOUT_TILT = 15.0
"""Of the spout, below the level [deg]."""


def part_e2() -> DrawnPart:
    """Tap of 115 mm on a can of 95 mm, lever and spout towards +x."""
    chrome = "chromium:mirror"
    return DrawnPart(
        "E2",
        "chrome basin tap on a can",
        (
            DrawnBody("can", (_can(),), GALVANISED, WHY_GALVANISED),
            DrawnBody("tap", (_tap(), _cap(), _lever()), chrome, "chromium over bright nickel mirrors edges sharply"),
            DrawnBody("aerator", (_aerator(),), "stainless_austenitic:coarse_blasted", "woven steel gauze is dull"),
        ),
    )


def _can() -> Shape:
    """Tapered can, mouth down, with a rolled bead around either end."""
    return turned(
        [
            *((0, 0), (59, 0), (60, 1), (60, 3), (59, 4), (58, 4.5)),
            *((48.3, _CAN - 5), (49, _CAN - 4), (49, _CAN - 1), (48, _CAN), (46, _CAN), (45, _CAN - 2), (0, _CAN - 2)),
        ]
    )


def _tap() -> Shape:
    """Foot, upright body, spout with its swivel."""
    foot = _CAN - 2
    body = turned([(0, foot), (22, foot), (22, foot + 14), (25, foot + 17), (25, foot + 68), (0, foot + 68)])
    spout = [(0, 0), (20, 0), (17, 40), (17, 50), (14, 51), (14, 55), (19, 55), (20, 56), (20, 62), (19, 63), (20, 64)]
    return body + _spout() * turned([*spout, (20, 81), (19, 82), (0, 82)])


def _spout() -> Location:
    """Where the spout begins, in the middle of the body, and where it looks."""
    return Pos(0, 0, _CAN + 40) * Rot(0, 90 + _SPOUT_TILT, 0)


def _aerator() -> Shape:
    """Gauze in the mouth of the spout."""
    return _spout() * turned([(0, 80), (16.5, 80), (16.5, 82.5), (0, 82.5)])


def _cap() -> Shape:
    """Domed cap over the body."""
    foot = _CAN + 67
    cap = turned([(0, foot), (25.5, foot), (26, foot + 1), (26, foot + 34), (0, foot + 34)])
    return fillet(cap.edges().sort_by(Axis.Z)[-1], 14.0)


def _lever() -> Shape:
    """Lever that rises from the cap and runs out level, 22 mm wide."""
    z = _CAN + 92
    upper = Spline((-14, z), (20, z + 17), (70, z + 22), (112, z + 19))
    lower = Spline((112, z + 14), (70, z + 16.5), (24, z + 8), (14, z - 4))
    side = make_face([upper, Polyline((112, z + 19), (112, z + 14)), lower, Polyline((14, z - 4), (-14, z))])
    blade = extrude(Plane.XZ * side, 11, both=True)
    return fillet(blade.edges().filter_by(Axis.Y), 1.5)
