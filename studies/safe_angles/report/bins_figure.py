"""Share of right depth against the angle of incidence: a bar a bin, its lower bound, and what is asked for."""

from markupsafe import Markup

from franbv.surfaces.safe_angles import AngleBin, RollAngles, SafeAngles
from studies.base.numbers_as_text import percent
from studies.drawing import svg
from studies.safe_angles.angles import is_safe_bin
from studies.safe_angles.sentences import bin_words, views_words

BINS_PLOT = svg.Plot(width=560, height=306, left=44, right=548, top=58, bottom=222)
"""Edges of the bars' ground [px]."""
_GAP = 2.0
"""Between neighbouring bars, half of it on each side [px]."""
_TICK = 9.0
"""Half the width of the mark of a lower bound [px]."""


def bins_figure(line: RollAngles, table: SafeAngles) -> Markup:
    """One material at one roll."""
    plot = BINS_PLOT
    x = svg.Scale(line.bins[0].from_deg, line.bins[-1].to_deg, plot.left, plot.right)
    y = svg.Scale(0, 100, plot.bottom, plot.top)
    title = f"roll {line.roll_deg:g} deg"
    wanted = y(100 * table.target_share)
    return svg.figure(
        plot.width,
        plot.height,
        f"Right depth against incidence, {title}",
        svg.text(plot.left - 32, 16, title, "axis-label strong"),
        svg.text(plot.left - 32, 36, "right depth, share of the surface [%]", "tick-label"),
        svg.left_axis(y, plot.left, plot.right, [0, 50, 100]),
        *(_bar(found, x, y, table) for found in line.bins),
        svg.line(plot.left, wanted, plot.right, wanted, "wanted"),
        svg.bottom_axis(x, plot.bottom, "angle of incidence [deg]", [found.from_deg for found in line.bins] + [90.0]),
        *(_range(span.from_deg, span.to_deg, x) for span in line.ranges),
    )


def bar_class(found: AngleBin, target_share: float) -> str:
    """Colour of a bin: safe, not safe, or not known."""
    return "safe" if is_safe_bin(found, target_share) else "unsafe" if found.is_known else "unknown"


def _bar(found: AngleBin, x: svg.Scale, y: svg.Scale, table: SafeAngles) -> Markup:
    left, width = x(found.from_deg) + _GAP, x(found.to_deg) - x(found.from_deg) - 2 * _GAP
    middle, klass = left + width / 2, bar_class(found, table.target_share)
    if found.share is None:
        words = svg.text(middle, y(0) - 6, "?", "tick-label mid")
        return svg.marked(words, f"{bin_words(found)}: no view sees enough of it")
    top = y(100 * found.share)
    bar = svg.element("rect", x=left, y=top, width=width, height=y(0) - top, klass=f"angle-bar {klass}")
    doubt = "" if found.is_known else "?"
    number = svg.text(middle, y(100) - 5, f"{100 * found.share:.0f}{doubt}", "tick-label mid")
    return svg.marked(svg.join(bar, *_lines(found, left, width, y), number), tooltip(found, table))


def _lines(found: AngleBin, left: float, width: float, y: svg.Scale) -> list[Markup]:
    """What a matte surface would reach, and the lower bound."""
    lines = []
    if found.matte_share is not None:
        matte = y(100 * found.matte_share)
        lines.append(svg.line(left, matte, left + width, matte, "matte"))
    if found.lower_bound is not None:
        bound = y(100 * found.lower_bound)
        middle = left + width / 2
        lines.append(svg.line(middle - _TICK, bound, middle + _TICK, bound, "bound"))
        lines.append(svg.line(middle, bound, middle, y(100 * (found.share or 0.0)), "bound"))
    return lines


def _range(low: float, high: float, x: svg.Scale) -> Markup:
    """A bar below the axis, over the safe range."""
    box = svg.element("rect", x=x(low), y=BINS_PLOT.bottom + 47, width=x(high) - x(low), height=7, rx=3, klass="span")
    words = svg.text((x(low) + x(high)) / 2, BINS_PLOT.bottom + 72, f"safe: {low:g} to {high:g} deg", "span-label mid")
    return svg.join(box, words)


def tooltip(found: AngleBin, table: SafeAngles) -> str:
    """The bin's numbers."""
    words = f"{bin_words(found)}: {percent(found.share)} right in {found.views} views, {found.part_pixels:,} px"
    if found.lower_bound is None:
        return f"{words}; not known, worth {views_words(found)} of {table.least_views} views that are needed"
    return f"{words}; {percent(found.lower_bound)} at least"
