"""Every setting as a dot: what it misses against how often it is false, and which of them are certified."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from studies.drawing import svg
from studies.thresholds.report.setting_words import MARKS

PLOT = svg.Plot(width=svg.PAGE_WIDTH, height=400, left=60, right=1130, top=40, bottom=340)
"""Edges of the plot [px]."""


@dataclass(frozen=True)
class Dot:
    """A setting."""

    x: float
    y: float
    klass: str
    """Of MARKS."""
    words: str
    """What it is, shown under the pointer."""


def tradeoff_figure(title: str, x_label: str, y_label: str, dots: Sequence[Dot]) -> Markup:
    """All settings; the chosen one is drawn last."""
    x, y = (
        svg.Scale(0.0, 1.05 * max((value(dot) for dot in dots), default=1.0) or 1.0, *ends)
        for value, ends in ((lambda d: d.x, (PLOT.left, PLOT.right)), (lambda d: d.y, (PLOT.bottom, PLOT.top)))
    )
    marks = [
        svg.marked(svg.element("circle", cx=x(dot.x), cy=y(dot.y), r=6, klass=f"setting {dot.klass}"), dot.words)
        for dot in sorted(dots, key=lambda dot: MARKS.index(dot.klass))
    ]
    return svg.figure(
        PLOT.width,
        PLOT.height,
        title,
        svg.text(PLOT.left, 18, y_label, "axis-label"),
        svg.left_axis(y, PLOT.left, PLOT.right, y.ticks(5)),
        svg.bottom_axis(x, PLOT.bottom, x_label, x.ticks(8)),
        *marks,
    )
