"""Coverage of the map against acquisitions: means with 95 % bands, and what the paper's FRA reached."""

from collections.abc import Sequence

from markupsafe import Markup

from studies.comparison.equal_acquisitions import LEVELS, mean_after
from studies.comparison.method_names import method_name
from studies.comparison.paper import FINAL_COVERAGE
from studies.comparison.report.headline import short_words
from studies.comparison.statistics import Comparison
from studies.drawing import svg
from studies.statistics.intervals import Interval

EQUAL_PLOT = svg.Plot(width=svg.PAGE_WIDTH, height=300, left=38, right=14, top=46, bottom=250)
"""Margins left and right of each panel, its upper and lower edge [px]."""


def equal_figure(comparison: Comparison, parts: Sequence[str], planners: Sequence[str], most: int) -> Markup:
    """A panel per part, up to `most` acquisitions: what the tables have after some of them, after each."""
    width = EQUAL_PLOT.width / max(len(parts), 1)
    panels = [_panel(comparison, part, planners, most, k * width, width) for k, part in enumerate(parts)]
    return svg.figure(EQUAL_PLOT.width, EQUAL_PLOT.height, "Mean coverage against acquisitions", *panels)


def _panel(comparison: Comparison, part: str, planners: Sequence[str], most: int, left: float, width: float) -> Markup:
    x = svg.Scale(1, most, left + EQUAL_PLOT.left, left + width - EQUAL_PLOT.right)
    y = svg.Scale(0, 100, EQUAL_PLOT.bottom, EQUAL_PLOT.top)
    curves = {
        planner: [interval for n in range(1, most + 1) if (interval := mean_after(comparison, part, planner, n))]
        for planner in reversed(planners)  # the first one on top
    }
    return svg.join(
        svg.text(left + EQUAL_PLOT.left, 16, short_words(part), "axis-label strong"),
        svg.text(left + EQUAL_PLOT.left, 33, "map covers [%]", "tick-label"),
        svg.left_axis(y, x.start, x.end, [0, 20, 40, 60, 80, 100]),
        svg.bottom_axis(x, EQUAL_PLOT.bottom, "Acquisitions", [n for n in LEVELS if n <= most]),
        _papers(part, x, y),
        *(_band(planner, curve, x, y) for planner, curve in curves.items()),
        *(_line(planner, curve, x, y) for planner, curve in curves.items()),
    )


def _papers(part: str, x: svg.Scale, y: svg.Scale) -> Markup:
    """A level line at the paper's coverage of FRA."""
    if part not in FINAL_COVERAGE:
        return Markup("")
    share = 100 * FINAL_COVERAGE[part]["fra"].median
    line = svg.line(x.start, y(share), x.end, y(share), "papers-level")
    return svg.marked(line, f"FRA in the paper: {share:.1f} % at the end, in the median")


def _band(planner: str, curve: Sequence[Interval], x: svg.Scale, y: svg.Scale) -> Markup:
    there = [(x(n), y(100 * e.high)) for n, e in enumerate(curve, 1)]
    back = [(x(n), y(100 * e.low)) for n, e in reversed(list(enumerate(curve, 1)))]
    return svg.path([*there, *back], f"arm-band {planner}")


def _line(planner: str, curve: Sequence[Interval], x: svg.Scale, y: svg.Scale) -> Markup:
    if not curve:
        return Markup("")
    line = svg.path([(x(n), y(100 * e.mean)) for n, e in enumerate(curve, 1)], f"arm {planner}")
    last = curve[-1]
    return svg.marked(
        line,
        f"{method_name(planner)}: {100 * last.mean:.1f} % after {len(curve)} acquisitions, mean of {last.count} runs",
    )
