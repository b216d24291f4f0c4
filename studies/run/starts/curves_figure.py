"""The coverage of the map in all starts of one reconstruction, a curve each."""

from collections.abc import Mapping, Sequence
from typing import Any

from markupsafe import Markup

from studies.drawing import svg
from studies.run.acquisition_table import MAP_COVERAGE

STARTS_PLOT = svg.Plot(width=1160, height=384, left=52, right=1090, top=54, bottom=328)
"""Edges of the plot inside the drawing [px]; the numbers of the starts stand to its right."""


def starts_figure(runs: Sequence[tuple[str, Sequence[Mapping[str, Any]]]]) -> Markup:
    """runs: number of each start, as text, and its rows of acquisitions."""
    longest = max(len(rows) for _, rows in runs)
    x = svg.Scale(0.5, longest + 0.5, STARTS_PLOT.left, STARTS_PLOT.right)
    y = svg.Scale(0, 100, STARTS_PLOT.bottom, STARTS_PLOT.top)
    ticks = [t for t in svg.round_ticks(1, max(longest, 2), 12) if t >= 1 and t == int(t)]
    return svg.figure(
        STARTS_PLOT.width,
        STARTS_PLOT.height,
        "Coverage of the map against acquisitions, all starts",
        svg.left_axis(y, STARTS_PLOT.left, STARTS_PLOT.right, [0, 20, 40, 60, 80, 100]),
        svg.text(0, 16, "Share of the visible surface [%]", "axis-label"),
        svg.bottom_axis(x, STARTS_PLOT.bottom, "Acquisitions taken", ticks),
        *(_curve(name, rows, x, y) for name, rows in runs),
    )


def _curve(name: str, rows: Sequence[Mapping[str, Any]], x: svg.Scale, y: svg.Scale) -> Markup:
    """The line, a dot per acquisition coloured by its kind, and the start's number at the end."""
    points = [(x(k + 1), y(100 * row[MAP_COVERAGE])) for k, row in enumerate(rows)]
    dots = [
        svg.marked(
            svg.element("circle", cx=at[0], cy=at[1], r=2.6, klass=f"dot {row['kind']}"),
            f"Start {name}, acquisition {k + 1}: {100 * row[MAP_COVERAGE]:.1f} %",
        )
        for k, (row, at) in enumerate(zip(rows, points, strict=True))
    ]
    end = points[-1]
    return svg.join(svg.path(points, "curve"), *dots, svg.text(end[0] + 8, end[1] + 4, name, "tick-label"))
