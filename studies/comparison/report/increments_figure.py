"""What a view adds against the coverage before it: boxes of PB views beside boxes of FRA's recovery views."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from studies.comparison.statistics import Comparison
from studies.comparison.view_increments import BIN, FEWEST_VIEWS, binned_increments
from studies.drawing import svg
from studies.run.acquisition_table import NBV, RECOVERY

INCREMENTS_PLOT = svg.Plot(width=1160, height=312, left=38, right=14, top=46, bottom=240)
"""Margins left and right of each panel, its upper and lower edge [px]."""
LEAST_AXIS = 10.0
"""Shortest axis [points]; it grows in steps of as many with what the views that are drawn add."""
VIEW_GROUPS = (("pb", NBV, "pb", "PB views"), ("fra", RECOVERY, "fra", "FRA recovery views"))
"""Arm, kind of view, class, words."""


def increments_figure(comparison: Comparison, parts: Sequence[str], words: dict[str, str]) -> Markup:
    """A panel per part, a pair of boxes per range of prior coverage; too few views are marked by an x."""
    width = INCREMENTS_PLOT.width / max(len(parts), 1)
    most = axis_end(comparison, parts)
    panels = [_panel(comparison, part, k * width, width, words[part], most) for k, part in enumerate(parts)]
    return svg.figure(
        INCREMENTS_PLOT.width,
        INCREMENTS_PLOT.height,
        "Coverage added by a view against the coverage before it",
        *panels,
    )


@dataclass(frozen=True)
class _Box:
    """Quartiles, median, and the farthest values within 1.5 times the box from it (Tukey 1977) [points]."""

    low: float
    lower: float
    median: float
    upper: float
    high: float


def _box_of(values: Sequence[float]) -> _Box:
    added = 100 * np.asarray(values)
    lower, median, upper = np.percentile(added, [25, 50, 75])
    reach = 1.5 * (upper - lower)
    inside = added[(added >= lower - reach) & (added <= upper + reach)]
    return _Box(inside.min(), lower, median, upper, inside.max())


def axis_end(comparison: Comparison, parts: Sequence[str]) -> float:
    """End of the axis that holds all boxes with their whiskers, the same for all parts [points]."""
    drawn = [
        _box_of(values).high
        for part in parts
        for arm, kind, _, _ in VIEW_GROUPS
        for values in binned_increments(comparison, part, arm, kind)
        if len(values) >= FEWEST_VIEWS
    ]
    return LEAST_AXIS * max(1, int(np.ceil(max(drawn, default=0.0) / LEAST_AXIS - 1e-9)))


def _panel(comparison: Comparison, part: str, left: float, width: float, title: str, most: float) -> Markup:
    x = svg.Scale(0, 100, left + INCREMENTS_PLOT.left, left + width - INCREMENTS_PLOT.right)
    y = svg.Scale(0, most, INCREMENTS_PLOT.bottom, INCREMENTS_PLOT.top)
    share = 100 * BIN
    boxes = [
        _box(
            values, x((k + 0.3 + 0.4 * side) * share), 0.28 * (x(share) - x(0)), y, klass, f"{name}, {k * share:.0f} %"
        )
        for side, (arm, kind, klass, name) in enumerate(VIEW_GROUPS)
        for k, values in enumerate(binned_increments(comparison, part, arm, kind))
    ]
    return svg.join(
        svg.text(left + INCREMENTS_PLOT.left, 16, title, "axis-label strong"),
        svg.text(left + INCREMENTS_PLOT.left, 33, "added by the view [points]", "tick-label"),
        svg.left_axis(y, left + INCREMENTS_PLOT.left, left + width - INCREMENTS_PLOT.right, y.ticks(5)),
        svg.bottom_axis(x, INCREMENTS_PLOT.bottom, "coverage before the view [%]", [0, 20, 40, 60, 80, 100]),
        *boxes,
    )


def _box(values: list[float], middle: float, width: float, y: svg.Scale, klass: str, name: str) -> Markup:
    """A box, or a cross for too few views, with the number of views below the axis."""
    count = svg.text(middle, INCREMENTS_PLOT.bottom + 58, len(values), f"count {klass}") if values else Markup("")
    if len(values) < FEWEST_VIEWS:
        mark = svg.join(svg.text(middle, y(0) - 4, "×", "tick-label mid"), count)
        return svg.marked(mark, f"{name} and above: {len(values)} views, too few")
    box = _box_of(values)
    top, bottom, left = y(box.upper), y(box.lower), middle - width / 2
    shapes = svg.join(
        svg.line(middle, y(box.low), middle, bottom, f"whisker {klass}"),
        svg.line(middle, top, middle, y(box.high), f"whisker {klass}"),
        svg.element("rect", x=left, y=top, width=width, height=max(bottom - top, 1.0), klass=f"box {klass}"),
        svg.line(left, y(box.median), left + width, y(box.median), "box-median"),
        count,
    )
    numbers = f"median {box.median:.1f}, quartiles {box.lower:.1f} to {box.upper:.1f}, {len(values)} views"
    return svg.marked(shapes, f"{name} and above: {numbers}")
