"""The numbers of the D4-like matcher.

Three kinds, named in each line: *preset*, from Intel's Default preset for the D435 (librealsense, `presets.cpp`,
`default_430`); *scaled*, a preset value times the ratio between this matcher's cost units and the chip's; *fitted*,
found on frames of real cameras. What it was fitted on stands beside it:

- *three pairs*: two D435i frames and the D435 pair of a glossy book, against the holes of the camera's own depth;
- *book*: that D435 pair alone; `docs.figures.left_out` prints the score on blocks that were left out of the fit;
- *noise*: how far the noise of smooth surfaces is correlated in 24 real D415 frames with a laser scanner's truth.

One scale joins both units: fitted P1 and P2 are 3.6 times the preset's 60 and 342. The chip's score sums the five
paths and this matcher's averages them, so a preset's score difference is worth 3.6 / 5 here.
"""

from dataclasses import dataclass
from typing import Literal

UNITS_PER_PRESET_UNIT = 3.6
"""Cost units (10-bit, as P1 and P2) per unit of a RealSense preset; fitted (three pairs), see above."""

PATHS = 5
"""From the left, the right, above and both upper diagonals: all that a line-streaming chip can do; fitted (three
pairs)."""


@dataclass(frozen=True)
class D4Settings:
    """Everything that changes what the D4-like matcher finds. Intensities are in 10-bit units, four times Y8.

    Costs are in the units of P1 and P2; the head of the module tells *preset*, *scaled* and *fitted* apart. Numbers are
    not checked here: `render.matcher.d400_preset` checks what comes from files.
    """

    arm_reach_u: int = 8
    """Longest arm of the support cross to the left and right [px]; fitted (three pairs)."""
    arm_reach_v: int = 4
    """Longest arm up and down [px]; fitted (three pairs). At most 4: the streaming core keeps so many rows."""
    arm_threshold: int = 40
    """An arm ends where the intensity differs by more than this from its anchor; fitted (book: 36 to 44 are alike; the
    three pairs gave 30 without the shrinking below; the preset's `rauDiffThreshold` is 51)."""
    arm_shrink_u: int = 3
    """Pixels by which an arm keeps away from what ended it, left and right [px]; preset, `uShrink`."""
    arm_shrink_v: int = 1
    """The same up and down [px]; preset, `vShrink`."""
    arm_blur_px: float = 0.0
    """Gaussian sigma of the image that the arms are measured on [px]; the chip's presets name no blur."""
    edge_threshold: int = 48
    """Intensity step along a path that counts as an edge; fitted (three pairs; the preset's `sloColorThresholds` are
    72)."""
    p1: tuple[int, int, int] = (216, 378, 252)
    """Penalty of a one pixel step with no, one, two edges [cost units]; scaled from 60, 105, 70."""
    p2: tuple[int, int, int] = (1231, 756, 540)
    """Penalty of a larger step with no, one, two edges [cost units]; 1231 scaled from 342, the edge forms fitted
    (three pairs; scaled from the preset's 190 and 130 they would be 684 and 468)."""
    second_peak: float = 234.0
    """Least difference between the lowest other local minimum and the minimum [cost units, mean of the paths];
    scaled: 325 x 3.6 / 5."""
    left_right_px: float = 0.875
    """Largest difference between left and right disparity [px]; fitted (book, and how much of a published metal ball is
    filled). The preset's `lrAgreeThreshold` is 24/32; here disparities are compared before they are averaged."""
    subpixel: Literal["costs", "totals", "totals_parabola"] = "costs"
    """What the sub-pixel fit sees. `costs`: the V fit on the aggregated costs before optimisation, where the step
    penalties cannot pull the fraction to whole pixels; `totals`: the V fit on the path sums; `totals_parabola`."""
    neighbour_radius: int = 6
    """Half side of the window of the neighbour count [px]; preset: `rsm.removeThresh` counts 168 = 13 x 13 - 1."""
    neighbour_least: int = 63
    """Neighbours that must agree; preset, `rsm.removeThresh` 63 of 168."""
    neighbour_px: float = 4.0
    """Disparity difference up to which a neighbour agrees [px]; preset, `rsm.diffThresh`."""
    mean_reach_u: int = 4
    """How far to the left and right a disparity is averaged along its surface [px], 0 to 12; fitted (noise). 6 and 5
    would fit it best, but would see a ball of 19 px radius 11.4 % too deep instead of 9.5 %."""
    mean_reach_v: int = 4
    """The same up and down [px], 0 to 12; fitted (noise)."""
    mean_px: float = 1.0
    """Disparity difference up to which a neighbour belongs to the surface [px]; choice: seven sigmas of real noise."""
    median_first: bool = False
    """Whether a 3 x 3 median (holes count as zero) comes before the neighbour count. The default has none: it would
    close the holes of one and two pixels of which real frames have most, and costs the book 0.004 of its hole IoU."""
    speckle_size: int = 0
    """Segments below this size are dropped [px]; 0 = off, since the neighbour count does its work."""
    speckle_px: float = 2.0
    """Largest disparity step inside a segment [px]."""


PROTOTYPE = D4Settings(
    arm_threshold=30,
    arm_shrink_u=0,
    arm_shrink_v=0,
    arm_blur_px=0.7,
    second_peak=300.0,
    subpixel="totals_parabola",
    neighbour_radius=2,
    neighbour_least=12,
    neighbour_px=1.5,
    mean_reach_u=0,
    mean_reach_v=0,
    median_first=True,
    speckle_size=100,
)
"""All numbers fitted, none taken from the preset: what the slow prototype used. For comparison with it."""
