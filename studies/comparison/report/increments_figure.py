"""What a view adds against the coverage before it: PB views beside FRA's recovery views, and the paper's medians."""

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from studies.comparison.paper import INCREMENTS
from studies.comparison.statistics import Comparison
from studies.comparison.view_increments import BIN, FEWEST_VIEWS, binned_increments
from studies.drawing import svg
from studies.drawing.box_figure import box_mark, box_words, zero_line
from studies.run.acquisition_table import NBV, RECOVERY
from studies.statistics.boxes import box_of

INCREMENTS_PLOT = svg.Plot(width=svg.PAGE_WIDTH, height=316, left=42, right=14, top=46, bottom=240)
"""Margins left and right of each panel, its upper and lower edge, height of a row of panels [px]."""
PANELS_A_ROW = 2
"""Choice: ten pairs of boxes need half a page."""
AXIS_STEP = 10.0
"""The axis grows in steps of so many with what the views that are drawn add or take away [points]."""
VIEW_GROUPS = (("pb", NBV, "PB views"), ("fra", RECOVERY, "FRA recovery views"))
"""Arm, kind of view, words; in the order of the paper's medians."""


def increments_figure(comparison: Comparison, parts: Sequence[str], words: dict[str, str]) -> Markup:
    """A panel per part, a pair of boxes per range of prior coverage; too few views are marked by an x."""
    width = INCREMENTS_PLOT.width / PANELS_A_ROW
    ends = axis_ends(comparison, parts)
    panels = [
        svg.element(
            "g",
            _panel(comparison, part, width, words[part], ends),
            transform=f"translate({k % PANELS_A_ROW * width:g} {k // PANELS_A_ROW * INCREMENTS_PLOT.height})",
        )
        for k, part in enumerate(parts)
    ]
    rows = -(-len(parts) // PANELS_A_ROW)
    return svg.figure(
        INCREMENTS_PLOT.width,
        INCREMENTS_PLOT.height * rows,
        "Coverage added by a view against the coverage before it",
        *panels,
    )


def axis_ends(comparison: Comparison, parts: Sequence[str]) -> tuple[float, float]:
    """Ends of the axis that holds all boxes with their whiskers, the same for all parts [points]."""
    drawn = [
        end
        for part in parts
        for arm, kind, _ in VIEW_GROUPS
        for values in binned_increments(comparison, part, arm, kind)
        if len(values) >= FEWEST_VIEWS
        for end in box_of(values).scaled(100).ends
    ]
    theirs = [
        100 * value
        for part in parts
        for pair in INCREMENTS.get(part, {}).values()
        for value in pair
        if value is not None
    ]
    low, high = min([0.0, *drawn, *theirs]), max([AXIS_STEP, *drawn, *theirs])
    return AXIS_STEP * np.floor(low / AXIS_STEP + 1e-9), AXIS_STEP * np.ceil(high / AXIS_STEP - 1e-9)


def _panel(comparison: Comparison, part: str, width: float, title: str, ends: tuple[float, float]) -> Markup:
    left, right = INCREMENTS_PLOT.left, width - INCREMENTS_PLOT.right
    x = svg.Scale(0, 100, left, right)
    y = svg.Scale(*ends, INCREMENTS_PLOT.bottom, INCREMENTS_PLOT.top)
    share = 100 * BIN
    marks = []
    for side, (arm, kind, name) in enumerate(VIEW_GROUPS):
        for k, values in enumerate(binned_increments(comparison, part, arm, kind)):
            place = x((k + 0.3 + 0.4 * side) * share)
            told = f"{name} from {k * share:.0f} to {(k + 1) * share:.0f} %"
            marks.append(_box(values, place, 0.28 * (x(share) - x(0)), y, arm, told))
            theirs = INCREMENTS.get(part, {}).get(round(k * share), (None, None))[side]
            if theirs is not None:
                marks.append(_paper_median(100 * theirs, place, y, arm, told))
    return svg.join(
        svg.text(left, 16, title, "axis-label strong"),
        svg.text(left, 33, "added by the view [points]", "tick-label"),
        svg.left_axis(y, left, right, y.ticks(5)),
        zero_line(y, left, right),
        svg.bottom_axis(
            x, INCREMENTS_PLOT.bottom, "coverage before the view [%]", [float(t) for t in range(0, 101, 10)]
        ),
        *marks,
    )


def _box(values: list[float], middle: float, width: float, y: svg.Scale, klass: str, name: str) -> Markup:
    """A box, or a cross for too few views, with the number of views below the axis; nothing where there are none."""
    if not values:
        return Markup("")
    count = svg.text(middle, INCREMENTS_PLOT.bottom + 58, len(values), f"count {klass}")
    if len(values) < FEWEST_VIEWS:
        mark = svg.join(svg.text(middle, y(0) - 4, "×", "tick-label mid"), count)
        return svg.marked(mark, f"{name}: {len(values)} views, too few")
    box = box_of(values).scaled(100)
    return svg.join(box_mark(box, middle, width, y, klass, f"{name}: {box_words(box, '.1f')} views"), count)


def _paper_median(points: float, middle: float, y: svg.Scale, klass: str, name: str) -> Markup:
    """A rhomb at the paper's median."""
    side, centre = 4.5, y(points)
    corners = [(middle, centre - side), (middle + side, centre), (middle, centre + side), (middle - side, centre)]
    mark = svg.path([*corners, corners[0]], f"paper-median {klass}")
    return svg.marked(mark, f"{name}, paper: median {points:.1f} points")
