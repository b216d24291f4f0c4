"""What became of the surface: a bar per material, with right depth, false depth and every cause of missing depth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from render.labels.causes import LEGEND, Cause
from studies.drawing import svg

_LEFT, _RIGHT, _TOP = 196, 1120, 34
BAR, STEP = 20, 30
"""Height of a bar and from one to the next [px]."""


@dataclass(frozen=True)
class Bar:
    """One bar."""

    label: str
    shares: Mapping[Cause, float]
    """Of the part's pixels; what is missing to 1 has right depth."""
    count: int
    """Pixels."""


def cause_figure(title: str, bars: Sequence[Bar]) -> Markup:
    """Bars from right depth, which is left blank, to the causes in the legend's order."""
    x = svg.Scale(0, 100, _LEFT, _RIGHT)
    bottom = _TOP + STEP * len(bars)
    grid = [
        svg.join(
            svg.line(x(t), _TOP - 6, x(t), bottom, "grid"), svg.text(x(t), bottom + 16, f"{t:g}", "tick-label mid")
        )
        for t in (0, 20, 40, 60, 80, 100)
    ]
    return svg.figure(
        svg.PAGE_WIDTH,
        bottom + 44,
        title,
        *grid,
        *(_bar(bar, _TOP + k * STEP, x) for k, bar in enumerate(bars)),
        svg.text((_LEFT + _RIGHT) / 2, bottom + 38, "share of the part's pixels [%]", "axis-label mid"),
    )


def _bar(bar: Bar, y: float, x: svg.Scale) -> Markup:
    pieces, start = [], 0.0
    for cause, share in bar.shares.items():
        if share > 0:
            piece = svg.element(
                "rect", x=x(100 * start), y=y, width=x(100 * share) - x(0), height=BAR, fill=css_colour(cause)
            )
            pieces.append(
                svg.marked(piece, f"{bar.label}, {LEGEND[cause].name}: {100 * share:.1f} % of {bar.count:,} px")
            )
        start += share
    rest = svg.element(
        "rect", x=x(100 * start), y=y, width=max(x(100) - x(100 * start), 0), height=BAR, klass="right-depth"
    )
    return svg.join(
        svg.text(_LEFT - 12, y + 15, bar.label, "tick-label end"),
        *pieces,
        svg.marked(rest, f"{bar.label}, right depth: {100 * (1 - start):.1f} % of {bar.count:,} px"),
    )


def css_colour(cause: Cause) -> str:
    """The legend's colour of a cause."""
    return "#{:02x}{:02x}{:02x}".format(*LEGEND[cause].colour)
