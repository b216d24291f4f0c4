"""Coverage as reconstructions go on, a curve with its 95 % band for each setting, against acquisitions and time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from studies.drawing import svg
from studies.drawing.band_figure import Curve, band_and_line
from studies.drawing.cells import NO_NUMBER, POINTS, mean_and_range
from studies.thresholds.report.progress import (
    AFTER,
    MeanCurve,
    NextGain,
    RunProgress,
    by_acquisition,
    by_second,
    gains,
    longest,
    times_until,
)

PROGRESS_PLOT = svg.Plot(width=560, height=340, left=44, right=548, top=40, bottom=284)
"""Edges of the plot [px]; two stand side by side."""
SERIES = 6
"""Colours of the settings that are not chosen; a seventh has the first again."""


@dataclass(frozen=True)
class ShownRuns:
    """The reconstructions of a setting, and how they are shown."""

    words: str
    """The setting."""
    chosen: bool
    runs: tuple[RunProgress, ...]


@dataclass(frozen=True)
class ProgressFigures:
    """What the page shows of reconstructions as they go on."""

    charts: tuple[Markup, Markup]
    """Against acquisitions, and against time."""
    key: tuple[tuple[str, str], ...]
    """Class of the colour and words of each setting."""
    rows: tuple[dict[str, Any], ...]
    """Of the table of gains."""
    count: int
    """Runs of each setting."""


def progress_figures(shown: Sequence[ShownRuns]) -> ProgressFigures:
    """Of settings under which the same scenes were reconstructed, one at least."""
    n = max(longest(one.runs) for one in shown)
    times = times_until(max(float(run.ends_s[-1]) for one in shown for run in one.runs))
    klasses = ["series-chosen" if one.chosen else f"series-{k % SERIES}" for k, one in enumerate(shown)]
    named = list(zip(shown, klasses, strict=True))
    charts = (
        _chart(
            "Coverage after each acquisition",
            "acquisitions",
            [(one, klass, by_acquisition(one.runs, n)) for one, klass in named],
            [t for t in svg.round_ticks(1, n, 8) if t == int(t)],
        ),
        _chart(
            "Coverage over time",
            "seconds since the start",
            [(one, klass, by_second(one.runs, times)) for one, klass in named],
            svg.round_ticks(0, times[-1], 6),
        ),
    )
    return ProgressFigures(
        charts,
        tuple((klass, one.words + (", chosen" if one.chosen else "")) for one, klass in named),
        tuple(row for one in shown for row in gain_rows(one.words, gains(one.runs))),
        len(shown[0].runs),
    )


def gain_rows(words: str, found: Sequence[NextGain]) -> list[dict[str, Any]]:
    """Of a setting, which the first of its rows names; one that says so where no run goes on for long enough."""
    cells = [
        {
            "taken": gain.acquisitions,
            "going_on": f"{gain.going_on} of {gain.coverage.count}",
            "shares": [
                mean_and_range(gain.coverage, POINTS, ".1f"),
                mean_and_range(gain.next_acquisition, POINTS, "+z.1f"),
                mean_and_range(gain.next_minute, POINTS, "+z.1f"),
            ],
        }
        for gain in found
    ]
    short = {"taken": AFTER[0], "going_on": "none", "shares": [NO_NUMBER] * 3}
    return [{**row, "words": "" if k else words} for k, row in enumerate(cells or [short])]


def _chart(
    title: str, variable: str, drawn: Sequence[tuple[ShownRuns, str, MeanCurve]], ticks: Sequence[float]
) -> Markup:
    """The chosen setting stands above the others."""
    ordered = sorted(drawn, key=lambda row: row[0].chosen)
    curves = [Curve(one.words, klass, points, f"{{:g}} {variable}".format) for one, klass, points in ordered]
    places = [value for value, _ in curves[0].points]
    x = svg.Scale(places[0], places[-1], PROGRESS_PLOT.left, PROGRESS_PLOT.right)
    y = svg.Scale(0, 100, PROGRESS_PLOT.bottom, PROGRESS_PLOT.top)
    return svg.figure(
        PROGRESS_PLOT.width,
        PROGRESS_PLOT.height,
        title,
        svg.text(0, 18, "visible surface within 5 mm of the map, mean over runs [%]", "axis-label"),
        svg.left_axis(y, PROGRESS_PLOT.left, PROGRESS_PLOT.right, [0, 20, 40, 60, 80, 100]),
        svg.bottom_axis(x, PROGRESS_PLOT.bottom, variable, list(ticks)),
        *(band_and_line(curve, x, y) for curve in curves),
    )
