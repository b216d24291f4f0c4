"""The coverage curve: surface share reconstructed against acquisitions, NBV iterations and recoveries marked."""

from collections.abc import Mapping, Sequence
from itertools import groupby, pairwise
from typing import Any

from markupsafe import Markup

from studies.drawing import svg
from studies.run.acquisition_table import FIRST, MAP_COVERAGE, MAP_INCREMENT, RAW_COVERAGE, RECOVERY

COVERAGE_PLOT = svg.Plot(width=1160, height=404, left=52, right=948, top=74, bottom=348)
"""Edges of the plot inside the drawing [px]; the labels of the curves stand to its right."""

AcquisitionRows = Sequence[Mapping[str, Any]]


def coverage_figure(rows: AcquisitionRows) -> Markup:
    """Coverage of the map and of the raw cloud, both at 5 mm, after each acquisition."""
    x = svg.Scale(0.5, len(rows) + 0.5, COVERAGE_PLOT.left, COVERAGE_PLOT.right)
    y = svg.Scale(0, 100, COVERAGE_PLOT.bottom, COVERAGE_PLOT.top)
    ticks = [t for t in svg.round_ticks(1, max(len(rows), 2), 12) if t >= 1 and t == int(t)]
    return svg.figure(
        COVERAGE_PLOT.width,
        COVERAGE_PLOT.height,
        "Coverage against acquisitions",
        _recovery_bands(rows, x),
        svg.left_axis(y, COVERAGE_PLOT.left, COVERAGE_PLOT.right, [0, 20, 40, 60, 80, 100]),
        svg.text(0, 16, "Share of the visible surface [%]", "axis-label"),
        svg.bottom_axis(x, COVERAGE_PLOT.bottom, "Acquisitions taken", ticks),
        _iteration_marks(rows, x),
        *_curves(rows, x, y),
        _marks(rows, x, y),
    )


def _recovery_bands(rows: AcquisitionRows, x: svg.Scale) -> Markup:
    """A band behind the acquisitions of each recovery activation."""
    bands = []
    places = [(row["activation"], k + 1) for k, row in enumerate(rows) if row["kind"] == RECOVERY]
    for activation, members in groupby(places, key=lambda place: place[0]):
        numbers = [number for _, number in members]
        left, right = x(min(numbers) - 0.5), x(max(numbers) + 0.5)
        band = svg.element(
            "rect",
            x=left,
            y=COVERAGE_PLOT.top,
            width=right - left,
            height=COVERAGE_PLOT.bottom - COVERAGE_PLOT.top,
            klass="recovery-band",
        )
        bands.append(svg.marked(band, f"Recovery {activation}: {len(numbers)} views"))
    return svg.join(*bands)


def _iteration_marks(rows: AcquisitionRows, x: svg.Scale) -> Markup:
    """The NBV iterations along the top edge, at the acquisition that begins each."""
    begins = {row["iteration"]: k + 1 for k, row in reversed(list(enumerate(rows)))}
    every = max(1, -(-len(begins) // 24))
    marks = [
        svg.join(
            svg.line(x(k), COVERAGE_PLOT.top - 5, x(k), COVERAGE_PLOT.top, "tick"),
            svg.text(x(k), COVERAGE_PLOT.top - 10, n, "tick-label mid"),
        )
        for n, k in begins.items()
        if n % every == 0
    ]
    return svg.join(
        *marks,
        svg.text(
            COVERAGE_PLOT.left,
            COVERAGE_PLOT.top - 27,
            "NBV iteration (0 = first view) begins with acquisition",
            "tick-label",
        ),
    )


def _curves(rows: AcquisitionRows, x: svg.Scale, y: svg.Scale) -> list[Markup]:
    """The curves with their names at the right end, moved apart where they would overlap."""
    wanted = ((MAP_COVERAGE, "curve", "in the map"), (RAW_COVERAGE, "curve raw", "in the raw cloud"))
    pieces, labels = [], []
    for column, klass, name in wanted:
        values = [100 * row[column] for row in rows]
        pieces.append(svg.path([(x(k + 1), y(v)) for k, v in enumerate(values)], klass))
        labels.append([y(values[-1]), f"{values[-1]:.1f} % {name}", klass])
    labels.sort(key=lambda label: label[0])
    for above, below in pairwise(labels):
        below[0] = max(below[0], above[0] + 18)
    pieces += [svg.text(COVERAGE_PLOT.right + 14, place + 4, words, f"{klass} label") for place, words, klass in labels]
    return pieces


def _marks(rows: AcquisitionRows, x: svg.Scale, y: svg.Scale) -> Markup:
    """One dot per acquisition on the map's curve, coloured by its kind."""
    dots = []
    for k, row in enumerate(rows):
        value, change = 100 * row[MAP_COVERAGE], 100 * row[MAP_INCREMENT]
        kind = {FIRST: "first view", RECOVERY: f"recovery view, activation {row['activation']}"}.get(
            row["kind"], f"next best view, iteration {row['iteration']}"
        )
        dot = svg.element("circle", cx=x(k + 1), cy=y(value), r=4.5, klass=f"dot {row['kind']}")
        dots.append(svg.marked(dot, f"Acquisition {k + 1}, {kind}: {value:.1f} % ({change:+.1f})"))
    return svg.join(*dots)
