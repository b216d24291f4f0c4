"""Stacked bars: of each row the shares that add up to something, over one axis of percent."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from studies.report import svg

WIDTH, ROW, LEFT, RIGHT, TOP, BOTTOM = 1160, 24, 250, 110, 10, 52
"""Size of the drawing, height of a row, margins [px]."""


@dataclass(frozen=True)
class StackedRow:
    """One bar."""

    name: str
    count: int
    """What the shares are of."""
    shares: Sequence[tuple[str, str, float]]
    """Name, colour and share [0, 1] of each piece, from the left."""


def stacked_figure(title: str, rows: Sequence[StackedRow], axis: str, counted: str) -> Markup:
    """All rows. axis: what the shares are of. counted: unit of the counts at the right."""
    most = max([sum(share for *_, share in row.shares) for row in rows] + [0.05])
    bottom = TOP + ROW * len(rows)
    x = svg.Scale(0, 100 * most, LEFT, WIDTH - RIGHT)
    return svg.figure(
        WIDTH,
        bottom + BOTTOM,
        title,
        *(_row(row, TOP + ROW * number, x, counted) for number, row in enumerate(rows)),
        svg.bottom_axis(x, bottom + 2, axis, x.ticks(8)),
    )


def _row(row: StackedRow, y: float, x: svg.Scale, counted: str) -> Markup:
    pieces, start = [], 0.0
    for name, colour, share in row.shares:
        left, right = x(100 * start), x(100 * (start + share))
        bar = svg.element("rect", x=left, y=y + 3, width=max(right - left, 0.0), height=ROW - 6, fill=colour)
        pieces.append(svg.marked(bar, f"{row.name}: {name} {100 * share:.1f} %"))
        start += share
    return svg.join(
        svg.text(LEFT - 10, y + ROW / 2 + 4, row.name, "tick-label end"),
        *pieces,
        svg.text(WIDTH - RIGHT + 12, y + ROW / 2 + 4, f"{row.count:,} {counted}", "tick-label"),
    )
