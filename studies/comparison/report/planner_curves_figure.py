"""Coverage of several planners side by side, part by part, against NBV iterations or against acquisitions."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from jaxtyping import Float
from markupsafe import Markup

from studies.comparison.method_names import method_name
from studies.comparison.records import Record
from studies.comparison.statistics import Comparison
from studies.drawing import svg

CURVES_PLOT = svg.Plot(width=1160, height=300, left=38, right=14, top=46, bottom=250)
"""Margins left and right of each panel, its upper and lower edge [px]."""

Along = Literal["iterations", "acquisitions"]
NAMES = {"iterations": "NBV iterations", "acquisitions": "Acquisitions"}


def planner_curves_figure(
    comparison: Comparison, parts: Sequence[str], arms: Sequence[str], along: Along, words: dict[str, str]
) -> Markup:
    """A panel per part: median of the map's coverage over runs with the quartiles as a band, and that of the raw cloud.

    words: what to call each part.
    """
    width = CURVES_PLOT.width / max(len(parts), 1)
    panels = [_panel(comparison, part, arms, along, k * width, width, words[part]) for k, part in enumerate(parts)]
    return svg.figure(CURVES_PLOT.width, CURVES_PLOT.height, f"Coverage against {NAMES[along].lower()}", *panels)


def held(curves: Sequence[Float[np.ndarray, "_"]], length: int) -> Float[np.ndarray, "runs length"]:
    """Curves of different lengths as one array: a run that has ended keeps what it covers."""
    return np.stack([np.pad(curve, (0, length - len(curve)), mode="edge") for curve in curves])


def coinciding(comparison: Comparison, parts: Sequence[str]) -> list[str]:
    """Parts on which FRA's runs and PB's are the same, view by view."""
    return [
        part
        for part in parts
        if (pairs := comparison.pairs(part, "fra", "pb"))
        and all(np.array_equal(fra.coverage, pb.coverage) for fra, pb in pairs)
    ]


def _values(record: Record, along: Along, raw: bool) -> Float[np.ndarray, "k"]:
    values = record.raw if raw else record.coverage
    return record.by_iteration(values) if along == "iterations" else values


def _panel(
    comparison: Comparison, part: str, arms: Sequence[str], along: Along, left: float, width: float, title: str
) -> Markup:
    runs = {arm: comparison.runs(part, arm) for arm in arms if comparison.runs(part, arm)}
    longest = max([len(_values(run, along, False)) for found in runs.values() for run in found], default=2)
    curves = {
        (arm, raw): held([_values(run, along, raw) for run in runs[arm]], longest)
        for arm in reversed(runs)  # the first one on top
        for raw in (False, True)
    }
    first = 0 if along == "iterations" else 1
    x = svg.Scale(first, max(first + longest - 1, first + 1), left + CURVES_PLOT.left, left + width - CURVES_PLOT.right)
    y = svg.Scale(0, 100, CURVES_PLOT.bottom, CURVES_PLOT.top)
    ticks = [t for t in x.ticks(5) if t == int(t)]
    return svg.join(
        svg.text(left + CURVES_PLOT.left, 16, title, "axis-label strong"),
        svg.text(left + CURVES_PLOT.left, 33, "surface within 5 mm [%]", "tick-label"),
        svg.left_axis(y, left + CURVES_PLOT.left, left + width - CURVES_PLOT.right, [0, 20, 40, 60, 80, 100]),
        svg.bottom_axis(x, CURVES_PLOT.bottom, NAMES[along], ticks),
        *(_band(arm, values, first, x, y) for (arm, raw), values in curves.items() if not raw),
        *(_line(arm, raw, values, first, x, y) for (arm, raw), values in curves.items()),
    )


def _band(arm: str, values: Float[np.ndarray, "runs k"], first: int, x: svg.Scale, y: svg.Scale) -> Markup:
    lower, upper = np.percentile(100 * values, [25, 75], axis=0)
    there = [(x(first + k), y(float(v))) for k, v in enumerate(upper)]
    back = [(x(first + k), y(float(v))) for k, v in reversed(list(enumerate(lower)))]
    return svg.path([*there, *back], f"arm-band {arm}")


def _line(arm: str, raw: bool, values: Float[np.ndarray, "runs k"], first: int, x: svg.Scale, y: svg.Scale) -> Markup:
    median = np.median(100 * values, axis=0)
    line = svg.path([(x(first + k), y(float(v))) for k, v in enumerate(median)], f"arm {arm}{' dashed' * raw}")
    kind = "raw cloud" if raw else "map"
    return svg.marked(
        line, f"{method_name(arm)}, {kind}: ends at {median[-1]:.1f} % in the median of {len(values)} runs"
    )
