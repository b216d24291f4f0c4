"""Why a pixel has no depth: the causes in the order in which they are tried, with their names and colours."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from jaxtyping import Bool, UInt8


class Cause(IntEnum):
    """What a pixel of a label map says, as an 8-bit code; `LEGEND` tells what each one means.

    1 to 12 are missing depth, 20 and 21 false depth; every invalid pixel has exactly one.
    """

    MEASURED = 0
    OUT_OF_RANGE = 1
    OUT_OF_REACH = 2
    NO_OVERLAP = 3
    OCCLUSION = 4
    OCCLUSION_WINDOW = 5
    PROJECTOR_SHADOW = 6
    OVER_EXPOSED = 7
    REFLECTION_DARK = 8
    REFLECTION_SATURATED = 9
    REFLECTION_DISAGREEING = 10
    REFLECTION_INTERREFLECTION = 11
    UNEXPLAINED = 12
    FALSE_DEPTH_REFLECTION = 20
    FALSE_DEPTH_OTHER = 21
    UNMEASURED = 255


@dataclass(frozen=True)
class LegendEntry:
    """How a cause is named, shown and told."""

    name: str
    group: str
    """Cause of which it is a sub-kind; its own name where it stands alone."""
    colour: tuple[int, int, int]
    """Red, green, blue [0, 255]."""
    meaning: str


LEGEND: dict[Cause, LegendEntry] = {
    Cause.MEASURED: LegendEntry("measured", "measured", (40, 40, 44), "has depth, and it is right"),
    Cause.OUT_OF_RANGE: LegendEntry(
        "out_of_range",
        "out_of_range",
        (120, 120, 128),
        "nearer than Min-Z or farther than Max-Z, or nothing there; or the matcher's window holds such points",
    ),
    Cause.OUT_OF_REACH: LegendEntry(
        "out_of_reach",
        "out_of_range",
        (160, 150, 120),
        "outside the projector's field, or so far that it comes back when dots are as strong as at 0.3 m",
    ),
    Cause.NO_OVERLAP: LegendEntry(
        "no_overlap",
        "no_overlap",
        (195, 195, 202),
        "the point lies outside the right image; or the matcher's window holds such points",
    ),
    Cause.OCCLUSION: LegendEntry("occlusion", "occlusion", (40, 90, 200), "hidden from the right imager"),
    Cause.OCCLUSION_WINDOW: LegendEntry(
        "occlusion_window",
        "occlusion",
        (110, 165, 235),
        "the matcher's window holds more than one depth, an edge or a steep surface, and a matte one is not measured "
        "rightly either",
    ),
    Cause.PROJECTOR_SHADOW: LegendEntry(
        "projector_shadow", "projector_shadow", (125, 85, 175), "no dots reach it, and it comes back when they do"
    ),
    Cause.OVER_EXPOSED: LegendEntry(
        "over_exposed",
        "over_exposed",
        (245, 250, 200),
        "white on a matte surface as well, and that comes back at a shorter exposure",
    ),
    Cause.REFLECTION_DARK: LegendEntry(
        "reflection_dark",
        "reflection",
        (140, 20, 20),
        "the surface sends the light elsewhere: too little contrast to match",
    ),
    Cause.REFLECTION_SATURATED: LegendEntry(
        "reflection_saturated", "reflection", (255, 220, 60), "a highlight drowns the dots"
    ),
    Cause.REFLECTION_DISAGREEING: LegendEntry(
        "reflection_disagreeing",
        "reflection",
        (230, 60, 40),
        "left and right see different highlights or mirror images",
    ),
    Cause.REFLECTION_INTERREFLECTION: LegendEntry(
        "reflection_interreflection", "reflection", (255, 140, 0), "comes back when paths stop at the first surface"
    ),
    Cause.UNEXPLAINED: LegendEntry("unexplained", "unexplained", (255, 0, 255), "none of these"),
    Cause.FALSE_DEPTH_REFLECTION: LegendEntry(
        "false_depth_reflection", "false_depth", (0, 170, 120), "has a wrong depth, and a right one on a matte surface"
    ),
    Cause.FALSE_DEPTH_OTHER: LegendEntry(
        "false_depth_other", "false_depth", (150, 220, 190), "has a wrong depth, which a matte surface does not mend"
    ),
    Cause.UNMEASURED: LegendEntry("unmeasured", "unmeasured", (0, 0, 0), "outside the crop, not measured at all"),
}
"""The legend of every label map, picture and report."""

HOLES = tuple(cause for cause in Cause if Cause.MEASURED < cause <= Cause.UNEXPLAINED)
"""Causes of missing depth: each invalid pixel has exactly one."""
GROUPS = tuple(dict.fromkeys(LEGEND[cause].group for cause in HOLES))
"""Causes without their sub-kinds, in the order in which they are tried."""


def members(group: str) -> tuple[Cause, ...]:
    """The sub-kinds of a cause."""
    return tuple(cause for cause in Cause if LEGEND[cause].group == group)


def is_of(cause: UInt8[np.ndarray, "*shape"], group: str) -> Bool[np.ndarray, "*shape"]:
    """Where a label map names any sub-kind of the cause."""
    return np.isin(cause, members(group))


def is_hole(cause: UInt8[np.ndarray, "*shape"]) -> Bool[np.ndarray, "*shape"]:
    """Where a label map says that depth is missing."""
    return (cause > Cause.MEASURED) & (cause <= Cause.UNEXPLAINED)
