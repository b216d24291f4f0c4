"""Planning time of PB and RE against the sizes of map, candidate set and image, on logarithmic axes."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from studies.comparison.planning_speed import decision_s
from studies.drawing import svg

SPEED_PLOT = svg.Plot(width=1160, height=300, left=52, right=30, top=46, bottom=250)
"""Margins left and right of each panel, its upper and lower edge [px]."""
PANELS = (
    ("voxels", "Voxels along an edge", "map_voxels", "voxels"),
    ("candidates", "Candidate poses", "poses", "poses"),
    ("pixels", "Pixels of the depth image", "rays", "pixels"),
)
"""Axis of the measurement, its name, the size that it changes, that size in words."""

SpeedRows = Sequence[Mapping[str, Any]]


def speed_figure(rows: SpeedRows) -> Markup:
    """A panel per axis: a whole decision as a solid line, the scoring of the candidates as a dashed one."""
    times = [seconds for row in rows for seconds in (decision_s(row), row["score"])]
    low, high = np.floor(np.log10(min(times))), np.ceil(np.log10(max(times)))
    width = SPEED_PLOT.width / len(PANELS)
    panels = [_panel(rows, *panel, k * width, width, low, high) for k, panel in enumerate(PANELS)]
    return svg.figure(SPEED_PLOT.width, SPEED_PLOT.height, "Planning time of PB and RE", *panels)


def _panel(
    rows: SpeedRows, axis: str, name: str, size: str, unit: str, left: float, width: float, low: float, high: float
) -> Markup:
    here = [row for row in rows if row["axis"] == axis]
    sizes = {row[size]: row["size"] if axis == "voxels" else row[size] for row in here}
    x = svg.Scale(
        float(np.log10(min(sizes))),
        float(np.log10(max(sizes))),
        left + SPEED_PLOT.left,
        left + width - SPEED_PLOT.right,
    )
    y = svg.Scale(float(low), float(high), SPEED_PLOT.bottom, SPEED_PLOT.top)
    lines = []
    for planner in ("pb", "re"):
        own = sorted((row for row in here if row["planner"] == planner), key=lambda row: row[size])
        for dashed, seconds in ((False, [decision_s(row) for row in own]), (True, [row["score"] for row in own])):
            lines += _line(planner, dashed, [row[size] for row in own], seconds, unit, x, y)
    return svg.join(
        svg.text(left + SPEED_PLOT.left, 16, name, "axis-label strong"),
        svg.text(left + SPEED_PLOT.left, 33, "seconds", "tick-label"),
        _decades(y, left, width, int(low), int(high)),
        *(_size_tick(x, value, words) for value, words in sizes.items()),
        *lines,
    )


def _decades(y: svg.Scale, left: float, width: float, low: int, high: int) -> Markup:
    start, end = left + SPEED_PLOT.left, left + width - SPEED_PLOT.right
    rows = [
        svg.join(
            svg.line(start, y(decade), end, y(decade), "grid"),
            svg.text(start - 8, y(decade) + 4, f"{10.0**decade:g}", "tick-label end"),
        )
        for decade in range(low, high + 1)
    ]
    return svg.join(*rows)


def _size_tick(x: svg.Scale, value: int, words: int) -> Markup:
    place = x(float(np.log10(value)))
    tick = svg.line(place, SPEED_PLOT.bottom, place, SPEED_PLOT.bottom + 5, "tick")
    return svg.join(tick, svg.text(place, SPEED_PLOT.bottom + 19, f"{words:,}", "tick-label mid"))


def _line(
    planner: str, dashed: bool, sizes: Sequence[int], seconds: Sequence[float], unit: str, x: svg.Scale, y: svg.Scale
) -> list[Markup]:
    points = [(x(float(np.log10(n))), y(float(np.log10(s)))) for n, s in zip(sizes, seconds, strict=True)]
    what = "scoring" if dashed else "decision"
    dots = [
        svg.marked(
            svg.element("circle", cx=px, cy=py, r=3.5, klass=f"arm-dot {planner}"),
            f"{planner.upper()}, {what}, {n:,} {unit}: {s:.3f} s",
        )
        for (px, py), n, s in zip(points, sizes, seconds, strict=True)
    ]
    return [svg.path(points, f"arm {planner}{' dashed' * dashed}"), *dots]
