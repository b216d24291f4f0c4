"""One chart of the links of the chain: by how much each moves the lead of FRA over PB."""

from collections.abc import Sequence
from typing import NamedTuple

from markupsafe import Markup

from studies.comparison.links import LINKED_PLANNERS, LINKS, arm_name
from studies.comparison.statistics import Comparison
from studies.drawing import svg
from studies.drawing.cells import signs
from studies.statistics.intervals import Interval

LINKS_PLOT = svg.Plot(width=svg.PAGE_WIDTH, height=24, left=250, right=250, top=52, bottom=52)
"""Height of a row, margins of the whole [px]."""
LINK_STEP = 10.0
"""The axis ends at a multiple of it [points]."""


class MovedLead(NamedTuple):
    """One link on one part."""

    words: str
    lead: Interval
    """Of FRA over PB under the change [-]."""
    change: Interval
    """Of that lead, start by start [-]."""


def moved_leads(comparison: Comparison, part: str) -> list[MovedLead]:
    """The links that have runs, the largest change of the lead first."""
    found = []
    for name, link in LINKS.items():
        fra, pb = (arm_name(planner, name) for planner in LINKED_PLANNERS)
        change = comparison.change_of_lead(part, (fra, pb), LINKED_PLANNERS)
        lead = comparison.difference(part, fra, pb)
        if change and lead:
            found.append(MovedLead(link.words, lead.interval, change.interval))
    return sorted(found, key=lambda row: -abs(row.change.mean))


def links_figure(comparison: Comparison, parts: Sequence[str], words: dict[str, str]) -> Markup:
    """A block of rows per part over one axis; empty without runs."""
    blocks = [(part, rows) for part in parts if (rows := moved_leads(comparison, part))]
    if not blocks:
        return Markup("")
    ends = [end for _, rows in blocks for row in rows for end in (row.change.low, row.change.high)]
    most = LINK_STEP * max(1, -(-100 * max(map(abs, ends)) // LINK_STEP))
    x = svg.Scale(-most, most, LINKS_PLOT.left, LINKS_PLOT.width - LINKS_PLOT.right)
    pieces, y = [], float(LINKS_PLOT.top)
    for part, rows in blocks:
        pieces.append(svg.text(0, y + 4, words[part], "axis-label strong"))
        for row in rows:
            y += LINKS_PLOT.height
            pieces.append(_row(row, y, x))
        y += 2 * LINKS_PLOT.height
    bottom = y - LINKS_PLOT.height
    return svg.figure(
        LINKS_PLOT.width,
        int(bottom + LINKS_PLOT.bottom),
        "By how much each link moves FRA less PB",
        *(svg.line(x(t), LINKS_PLOT.top - 12, x(t), bottom, "grid") for t in x.ticks(8)),
        svg.line(x(0), LINKS_PLOT.top - 12, x(0), bottom, "zero"),
        svg.text(LINKS_PLOT.width, 20, "lead under the change [points]", "tick-label end"),
        *pieces,
        svg.bottom_axis(x, bottom, "change of FRA less PB [points of coverage of the map]", x.ticks(8)),
    )


def _row(row: MovedLead, y: float, x: svg.Scale) -> Markup:
    change, lead = row.change, row.lead
    sure = change.count > 1 and (change.low > 0 or change.high < 0)
    told = f"{row.words}: {_words(change)}, {change.count} starts; lead {_words(lead)}"
    mark = svg.join(
        svg.line(x(100 * change.low), y, x(100 * change.high), y, f"link-range{' sure' * sure}"),
        svg.element("circle", cx=x(100 * change.mean), cy=y, r=4.5, klass=f"link-dot{' sure' * sure}"),
    )
    return svg.join(
        svg.text(LINKS_PLOT.left - 16, y + 4, row.words, "tick-label end"),
        svg.marked(mark, told),
        svg.text(LINKS_PLOT.width, y + 4, _words(lead), "tick-label end"),
    )


def _words(interval: Interval) -> str:
    ends = f" ({100 * interval.low:+z.1f} to {100 * interval.high:+z.1f})" if interval.count > 1 else " (one start)"
    return signs(f"{100 * interval.mean:+z.1f}{ends}")
