"""Heat maps: a share for every material and angle, in one or more panels side by side, numbers in the cells."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from markupsafe import Markup

from studies.drawing import svg

LABELS = 244
"""Width of the row labels [px]."""
GAP = 34
"""Between panels [px]."""
MAP_ROW, GROUP_GAP = 17, 12
"""Height of a row, and what separates two groups of rows [px]."""
_TOP = 62
"""Height of the titles and column labels [px]."""
WHITE = (251, 250, 248)
DARK_TEXT_BELOW = 0.55
"""Shares above this have white numbers (choice: contrast at least 4.5 on both sides of it)."""


@dataclass(frozen=True)
class Cell:
    """One measured share."""

    share: float | None
    """In [0, 1]; None where it is not defined."""
    tooltip: str
    """What was counted."""


@dataclass(frozen=True)
class MapRow:
    """A row's place and name."""

    key: str
    group: str
    label: str


@dataclass(frozen=True)
class Panel:
    """One block of cells."""

    title: str
    cells: Mapping[tuple[str, float], Cell]
    """By row key and column; what was not measured is left out."""


def heat_map_figure(
    title: str,
    rows: Sequence[MapRow],
    columns: Sequence[float],
    panels: Sequence[Panel],
    colour: tuple[int, int, int],
    column_name: str,
) -> Markup:
    """All panels over the same rows and columns. colour: of a share of 1.

    Cells without a value are filled with `hatched`, a pattern that the page defines once for all figures.
    """
    width = (svg.PAGE_WIDTH - LABELS - GAP * (len(panels) - 1)) / max(len(panels), 1)
    places, bottom = row_places(rows)
    drawn = [
        _panel(panel, rows, columns, places, LABELS + k * (width + GAP), width, colour)
        for k, panel in enumerate(panels)
    ]
    names = [svg.text(LABELS - 10, places[row.key] + MAP_ROW - 4.5, row.label, "tick-label end") for row in rows]
    groups = [
        svg.text(0, places[next(members).key] + MAP_ROW - 4.5, group, "heat-group")
        for group, members in groupby(rows, key=lambda row: row.group)
    ]
    return svg.figure(
        svg.PAGE_WIDTH,
        int(bottom) + 8,
        title,
        svg.text(0, _TOP - 12, column_name, "tick-label"),
        *drawn,
        *names,
        *groups,
    )


def row_places(rows: Sequence[MapRow]) -> tuple[dict[str, float], float]:
    """Upper edge of every row [px], groups set apart, and the lower edge of the last."""
    places: dict[str, float] = {}
    y = float(_TOP)
    for k, row in enumerate(rows):
        y += GROUP_GAP if k and row.group != rows[k - 1].group else 0
        places[row.key] = y
        y += MAP_ROW
    return places, y


def _panel(
    panel: Panel,
    rows: Sequence[MapRow],
    columns: Sequence[float],
    places: Mapping[str, float],
    left: float,
    width: float,
    colour: tuple[int, int, int],
) -> Markup:
    step = width / len(columns)
    heads = [
        svg.text(left + (k + 0.5) * step, _TOP - 12, f"{column:g}", "tick-label mid")
        for k, column in enumerate(columns)
    ]
    cells = [
        _cell(panel.cells[row.key, column], left + k * step, places[row.key], step, colour)
        for row in rows
        for k, column in enumerate(columns)
        if (row.key, column) in panel.cells
    ]
    return svg.join(svg.text(left, _TOP - 38, panel.title, "axis-label"), *heads, *cells)


def _cell(cell: Cell, x: float, y: float, width: float, colour: tuple[int, int, int]) -> Markup:
    fill = "url(#hatched)" if cell.share is None else shade(cell.share, colour)
    box = svg.element("rect", x=x, y=y, width=width - 1.5, height=MAP_ROW - 1.5, fill=fill, klass="heat")
    if cell.share is None:
        return svg.marked(box, cell.tooltip)
    tone = "heat-number light" if cell.share > DARK_TEXT_BELOW else "heat-number"
    number = svg.text(x + width / 2, y + MAP_ROW - 4.8, f"{100 * cell.share:.0f}", tone)
    return svg.marked(svg.join(box, number), cell.tooltip)


def shade(share: float, colour: tuple[int, int, int]) -> str:
    """Colour of a share in [0, 1] between the page's white and `colour`."""
    mixed = (round(w + (c - w) * min(max(share, 0.0), 1.0)) for w, c in zip(WHITE, colour, strict=True))
    return "#{:02x}{:02x}{:02x}".format(*mixed)
