"""Box plots: boxes side by side in groups, small panels beside each other, the medians in numbers below."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from studies.drawing import svg
from studies.drawing.cells import signs
from studies.statistics.boxes import TukeyBox

BOX_PLOT = svg.Plot(width=svg.PAGE_WIDTH, height=360, left=52, right=14, top=46, bottom=268)
"""Margins left and right of each panel, its upper and lower edge [px]."""
WIDEST_BOX = 26.0
"""Of a box [px]."""
LINE_STEP = 17
"""From one line of numbers below a panel to the next [px]."""


@dataclass(frozen=True)
class BoxSeries:
    """What one box of every group stands for."""

    name: str
    klass: str
    """Its colour, by a class of the page's style; empty = that of the group."""


@dataclass(frozen=True)
class BoxGroup:
    """Boxes side by side."""

    name: str
    """Below the axis."""
    klass: str
    boxes: Sequence[TukeyBox | None]
    """One for each series; None where there is none."""


@dataclass(frozen=True)
class BoxPanel:
    """Groups over one axis."""

    title: str
    axis: str
    """What the boxes are of, with unit."""
    form: str
    """How the medians are written."""
    low: float
    """Ends of the axis, in the unit of the boxes."""
    high: float
    groups: Sequence[BoxGroup]


def box_figure(title: str, panels: Sequence[BoxPanel], series: Sequence[BoxSeries]) -> Markup:
    """All panels, as wide as each other."""
    width = BOX_PLOT.width / max(len(panels), 1)
    height = BOX_PLOT.bottom + 34 + LINE_STEP * len(series)
    drawn = [_panel(panel, series, k * width, width) for k, panel in enumerate(panels)]
    return svg.figure(BOX_PLOT.width, height, title, *drawn)


def _panel(panel: BoxPanel, series: Sequence[BoxSeries], left: float, width: float) -> Markup:
    start, end = left + BOX_PLOT.left, left + width - BOX_PLOT.right
    y = svg.Scale(panel.low, panel.high, BOX_PLOT.bottom, BOX_PLOT.top)
    step = (end - start) / max(len(panel.groups), 1)
    names = [
        svg.text(start - 8, BOX_PLOT.bottom + 20 + LINE_STEP * (k + 1), one.name, "box-number end")
        for k, one in enumerate(series)
    ]
    groups = [
        _group(group, series, panel.form, start + (k + 0.5) * step, step, y) for k, group in enumerate(panel.groups)
    ]
    return svg.join(
        svg.text(start, 16, panel.title, "axis-label strong"),
        svg.text(start, 33, panel.axis, "tick-label"),
        svg.left_axis(y, start, end, y.ticks(5)),
        zero_line(y, start, end),
        *names,
        *groups,
    )


def _group(group: BoxGroup, series: Sequence[BoxSeries], form: str, middle: float, step: float, y: svg.Scale) -> Markup:
    share = min(0.8 * step / max(len(series), 1), 1.5 * WIDEST_BOX)
    width = min(WIDEST_BOX, 0.8 * share)
    pieces = [svg.text(middle, BOX_PLOT.bottom + 20, group.name, "tick-label mid strong")]
    for k, (one, box) in enumerate(zip(series, group.boxes, strict=True)):
        klass = f"{group.klass} {one.klass}".strip()
        text = format(box.median, form) if box else "\u2013"
        pieces.append(svg.text(middle, BOX_PLOT.bottom + 20 + LINE_STEP * (k + 1), signs(text), "box-number mid"))
        if box:
            place = middle + (k - (len(series) - 1) / 2) * share
            pieces.append(box_mark(box, place, width, y, klass, f"{group.name}, {one.name}: {box_words(box, form)}"))
    return svg.join(*pieces)


def box_mark(box: TukeyBox, middle: float, width: float, y: svg.Scale, klass: str, tooltip: str) -> Markup:
    """One box at a place; what is not known of it is not drawn: without quartiles a whisker through the median."""
    left = middle - width / 2
    lower, upper = (box.median if end is None else end for end in (box.lower, box.upper))
    shapes = [
        svg.join(
            svg.line(middle, y(inner), middle, y(outer), f"whisker {klass}"),
            svg.line(middle - width / 4, y(outer), middle + width / 4, y(outer), f"whisker {klass}"),
        )
        for inner, outer in ((lower, box.low), (upper, box.high))
        if outer is not None
    ]
    if box.lower is not None or box.upper is not None:
        top, bottom = y(upper), y(lower)
        shapes.append(
            svg.element("rect", x=left, y=top, width=width, height=max(bottom - top, 1.0), klass=f"box {klass}")
        )
    shapes.append(svg.line(left, y(box.median), left + width, y(box.median), "box-median"))
    return svg.marked(svg.join(*shapes), tooltip)


def zero_line(y: svg.Scale, start: float, end: float) -> Markup:
    """The line at zero of an axis that goes below it."""
    return svg.line(start, y(0.0), end, y(0.0), "zero") if y.low < 0 else Markup("")


def box_words(box: TukeyBox, form: str) -> str:
    """`median 2.0, quartiles 1.5 to 3.0, whiskers 1.0 to 4.0, of 15`, as far as it is known."""
    words = [f"median {box.median:{form}}"]
    for name, low, high in (("quartiles", box.lower, box.upper), ("whiskers", box.low, box.high)):
        if low is not None and high is not None:
            words.append(f"{name} {low:{form}} to {high:{form}}")
        elif high is not None:
            words.append(f"{name} up to {high:{form}}")
    return signs(", ".join(words)) + (f", of {box.count}" if box.count else "")
