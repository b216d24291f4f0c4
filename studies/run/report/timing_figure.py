"""Where the time went: seconds per acquisition, stacked by stage, and the median of each stage."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from studies.drawing import svg

TIMING_PLOT = svg.Plot(width=566, height=250, left=46, right=562, top=34, bottom=196)

SENSING = "sensing"
"""The stage that is the sensor's; all others are the planner's."""

STAGE_WORDS = {
    SENSING: "sensing: render, expose, match, decimate",
    "map": "voxel map",
    "object": "object and frontier",
    "ellipsoids": "ellipsoids: mixture, enclosing",
    "detection": "reflective regions",
    "missing": "what is left to be measured",
    "candidates": "candidate poses",
    "reachability": "reachability",
    "score": "utility of the poses",
    "recovery_poses": "recovery poses",
    "gamma": "recovery index",
}
"""Stages by the names that the loop gives them, in the order of the loop."""


@dataclass(frozen=True)
class StageTime:
    """One stage over all acquisitions in which it ran."""

    stage: str
    median: float
    """[s]"""
    lower: float
    """First quartile [s]."""
    upper: float
    """Third quartile [s]."""
    total: float
    """[s]"""
    count: int
    """Acquisitions."""


def stage_names(times: Sequence[Mapping[str, float]]) -> list[str]:
    """All stages that ran, in the order of the loop, unknown ones last."""
    ran = {name for row in times for name in row}
    return [name for name in STAGE_WORDS if name in ran] + sorted(ran - STAGE_WORDS.keys())


def stage_times(times: Sequence[Mapping[str, float]]) -> list[StageTime]:
    """Median, quartiles and sum of every stage."""
    found = []
    for name in stage_names(times):
        seconds = np.array([row[name] for row in times if name in row])
        lower, median, upper = np.percentile(seconds, [25, 50, 75])
        found.append(
            StageTime(
                STAGE_WORDS.get(name, name),
                float(median),
                float(lower),
                float(upper),
                float(seconds.sum()),
                len(seconds),
            )
        )
    return found


def timing_figure(times: Sequence[Mapping[str, float]], stages: Sequence[str], label: str) -> Markup:
    """A column per acquisition, the given stages stacked; the colours are those of the table of stages."""
    colours = {name: k for k, name in enumerate(stage_names(times))}
    totals = [sum(row.get(name, 0.0) for name in stages) for row in times]
    x = svg.Scale(0.5, len(times) + 0.5, TIMING_PLOT.left, TIMING_PLOT.right)
    y = svg.Scale(0, max([*totals, 1e-3]) * 1.05, TIMING_PLOT.bottom, TIMING_PLOT.top)
    width = min(0.7 * (x(2) - x(1)), 30)
    columns = []
    for k, row in enumerate(times):
        floor = 0.0
        for name in stages:
            seconds = row.get(name, 0.0)
            top, bottom = y(floor + seconds), y(floor)
            bar = svg.element(
                "rect", x=x(k + 1) - width / 2, y=top, width=width, height=bottom - top, klass=f"stage-{colours[name]}"
            )
            columns.append(svg.marked(bar, f"Acquisition {k + 1}, {STAGE_WORDS.get(name, name)}: {seconds:.3f} s"))
            floor += seconds
    ticks = [t for t in svg.round_ticks(1, max(len(times), 2), 8) if t == int(t)]
    return svg.figure(
        TIMING_PLOT.width,
        TIMING_PLOT.height,
        f"{label} per acquisition",
        svg.left_axis(y, TIMING_PLOT.left, TIMING_PLOT.right, y.ticks(4)),
        svg.text(0, 16, label, "axis-label"),
        *columns,
        svg.bottom_axis(x, TIMING_PLOT.bottom, "Acquisition", ticks),
    )
