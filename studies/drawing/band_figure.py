"""Curves with 95 % bands over repeated measurements, in small panels side by side."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from studies.drawing import svg
from studies.statistics.intervals import Interval

BAND_PLOT = svg.Plot(width=1160, height=282, left=46, right=12, top=62, bottom=222)
"""Margins left and right of each panel, its upper and lower edge [px]."""


@dataclass(frozen=True)
class Curve:
    """One quantity against one variable."""

    name: str
    klass: str
    """Its colour, by a class of the page's style."""
    points: Sequence[tuple[float, Interval]]
    """Variable, and mean share with band."""
    place: Callable[[float], str] = "{:g}".format
    """The variable in words."""


@dataclass(frozen=True)
class CurvePanel:
    """Curves over one axis."""

    title: str
    curves: Sequence[Curve]


def band_figure(title: str, panels: Sequence[CurvePanel], variable: str, ticks: Sequence[float]) -> Markup:
    """Panels over the same axes: shares from 0 to 100 % against the variable."""
    width = BAND_PLOT.width / max(len(panels), 1)
    drawn = [_panel(panel, k * width, width, variable, list(ticks)) for k, panel in enumerate(panels)]
    return svg.figure(BAND_PLOT.width, BAND_PLOT.height, title, *drawn)


def _panel(panel: CurvePanel, left: float, width: float, variable: str, ticks: list[float]) -> Markup:
    x = svg.Scale(min(ticks), max(ticks), left + BAND_PLOT.left, left + width - BAND_PLOT.right)
    y = svg.Scale(0, 100, BAND_PLOT.bottom, BAND_PLOT.top)
    return svg.join(
        svg.text(left + BAND_PLOT.left - 30, 18, panel.title, "axis-label strong"),
        svg.text(left + BAND_PLOT.left - 30, 42, "share [%]", "tick-label"),
        svg.left_axis(y, left + BAND_PLOT.left, left + width - BAND_PLOT.right, [0, 50, 100]),
        *(band_and_line(curve, x, y) for curve in panel.curves),
        svg.bottom_axis(x, BAND_PLOT.bottom, variable, ticks),
    )


def band_and_line(curve: Curve, x: svg.Scale, y: svg.Scale) -> Markup:
    """The band, the means joined by lines, and a dot per point that tells its numbers."""
    upper = [(x(value), y(100 * e.high)) for value, e in curve.points]
    lower = [(x(value), y(100 * e.low)) for value, e in reversed(curve.points)]
    dots = [
        svg.marked(
            svg.element("circle", cx=x(value), cy=y(100 * e.mean), r=3, klass=f"series-dot {curve.klass}"),
            f"{curve.name}, {curve.place(value)}: {100 * e.mean:.1f} % "
            f"({100 * e.low:.1f} to {100 * e.high:.1f}, n = {e.count})",
        )
        for value, e in curve.points
    ]
    middle = [(x(value), y(100 * e.mean)) for value, e in curve.points]
    return svg.join(
        svg.path([*upper, *lower], f"series-band {curve.klass}"), svg.path(middle, f"series {curve.klass}"), *dots
    )
