"""Stacked bars: of each row the shares of a whole, over an axis from 0 to 100 %; what is left of the whole is pale."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from studies.drawing import svg

STACKED_ROW, _LEFT, _RIGHT, _TOP, _BOTTOM = 24, 250, 110, 10, 52
"""Height of a row, margins [px]."""


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
    bottom = _TOP + STACKED_ROW * len(rows)
    x = svg.Scale(0, 100, _LEFT, svg.PAGE_WIDTH - _RIGHT)
    return svg.figure(
        svg.PAGE_WIDTH,
        bottom + _BOTTOM,
        title,
        *(_row(row, _TOP + STACKED_ROW * number, x, counted) for number, row in enumerate(rows)),
        svg.bottom_axis(x, bottom + 2, axis, x.ticks(8)),
    )


def _row(row: StackedRow, y: float, x: svg.Scale, counted: str) -> Markup:
    whole = svg.element("rect", x=x(0), y=y + 3, width=x(100) - x(0), height=STACKED_ROW - 6, fill="#eeebe6")
    pieces, start = [whole], 0.0
    for name, colour, share in row.shares:
        left, right = x(100 * start), x(100 * (start + share))
        bar = svg.element("rect", x=left, y=y + 3, width=max(right - left, 0.0), height=STACKED_ROW - 6, fill=colour)
        pieces.append(svg.marked(bar, f"{row.name}: {name} {100 * share:.1f} %"))
        start += share
    return svg.join(
        svg.text(_LEFT - 10, y + STACKED_ROW / 2 + 4, row.name, "tick-label end"),
        *pieces,
        svg.text(svg.PAGE_WIDTH - _RIGHT + 12, y + STACKED_ROW / 2 + 4, f"{row.count:,} {counted}", "tick-label"),
    )
