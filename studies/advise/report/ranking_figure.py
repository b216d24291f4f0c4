"""Every remedy's share of right depth with its interval, the best first, against the camera as it is set."""

from markupsafe import Markup

from studies.advise.advice import Advice, RemedyScore
from studies.advise.sentences import with_interval
from studies.drawing import svg

MOST_COMBINATIONS = 5
"""Of the best ones that are drawn (choice: the table has all)."""
_LEFT, _RIGHT, _TOP, _STEP = 430, 1060, 42, 19


def ranking_figure(advice: Advice) -> Markup:
    """One line a remedy; the band is the interval of the camera as it is set."""
    combinations = [one for one in advice.combinations if not one.is_ceiling][:MOST_COMBINATIONS]
    rows = sorted([*combinations, *advice.remedies], key=lambda one: -one.right_share)
    x = svg.Scale(0, 100, _LEFT, _RIGHT)
    bottom = _TOP + _STEP * len(rows) + 6
    base = advice.base
    band = svg.element(
        "rect", x=x(100 * base.lo), y=_TOP - 8, width=max(x(100 * base.hi) - x(100 * base.lo), 1.0),
        height=bottom - _TOP + 8, klass="base-band",
    )  # fmt: skip
    middle = svg.line(x(100 * base.right_share), _TOP - 8, x(100 * base.right_share), bottom, "base-line")
    return svg.figure(
        svg.PAGE_WIDTH,
        bottom + 46,
        "Right depth by remedy",
        band,
        middle,
        svg.text(x(100 * base.right_share), _TOP - 16, f"as set: {with_interval(base)}", "tick-label mid"),
        *(_row(row, _TOP + k * _STEP + 8, x) for k, row in enumerate(rows)),
        svg.bottom_axis(x, bottom, "surface of the part with right depth [%]", x.ticks(5)),
    )


def _row(row: RemedyScore, y: float, x: svg.Scale) -> Markup:
    klass = "ceiling" if row.is_ceiling else row.verdict
    label = svg.text(_LEFT - 12, y + 4, f"{row.name}: {row.level}", f"tick-label end {klass}-text")
    span = svg.line(x(100 * row.lo), y, x(100 * row.hi), y, f"span {klass}")
    dot = svg.element("circle", cx=x(100 * row.right_share), cy=y, r=4, klass=f"mark {klass}")
    number = svg.text(_RIGHT + 12, y + 4, f"{100 * row.right_share:.0f} %", "tick-label")
    words = (
        f"{row.name}, {row.level}: {with_interval(row)} right, {100 * row.gain:+.1f} points "
        f"({100 * row.gain_lo:+.1f} to {100 * row.gain_hi:+.1f}); {row.verdict}"
    )
    return svg.marked(svg.join(label, span, dot, number), words)
