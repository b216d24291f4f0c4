"""Every remedy over all cases: how many it helps, leaves level, makes up depth in, and hurts."""

from collections.abc import Sequence

from markupsafe import Markup

from studies.drawing import svg
from studies.mitigations.tallies import TOLD_VERDICTS, RemedyTally

_LEFT, _RIGHT, _TOP, _STEP, _BAR = 400, 900, 40, 20, 13


def verdict_figure(found: Sequence[RemedyTally]) -> Markup:
    """A bar of cases for each, its median gain with the interval over cases beside it."""
    x = svg.Scale(0, 100, _LEFT, _RIGHT)
    bottom = _TOP + _STEP * len(found) + 4
    return svg.figure(
        svg.PAGE_WIDTH,
        bottom + 46,
        "Verdicts by remedy",
        svg.text(_RIGHT + 14, _TOP - 14, "wins", "tick-label"),
        svg.text(_RIGHT + 60, _TOP - 14, "median gain, points", "tick-label"),
        *(_tally_row(one, _TOP + _STEP * k, x) for k, one in enumerate(found)),
        svg.bottom_axis(x, bottom, "share of the cases [%]", x.ticks(5)),
    )


def _tally_row(one: RemedyTally, y: float, x: svg.Scale) -> Markup:
    bars, done = [], 0.0
    for verdict in TOLD_VERDICTS:
        share = 100 * one.counts[verdict] / one.cases
        if share:
            bars.append(
                svg.element(
                    "rect", x=x(done), y=y, width=x(done + share) - x(done), height=_BAR, klass=f"bar {verdict}"
                )
            )
        done += share
    label = svg.text(_LEFT - 12, y + 11, one.name, "tick-label end")
    gain = f"{100 * one.gain.value:+.1f} ({100 * one.gain.low:+.1f} to {100 * one.gain.high:+.1f})"
    told = ", ".join(f"{verdict} {one.counts[verdict]}" for verdict in TOLD_VERDICTS)
    return svg.marked(
        svg.join(
            label,
            *bars,
            svg.text(_RIGHT + 14, y + 11, "" if one.is_ceiling else f"{one.wins}", "tick-label"),
            svg.text(_RIGHT + 60, y + 11, gain, "tick-label"),
        ),
        f"{one.name}: {told} of {one.cases} cases; median gain {gain} points; costs {one.cost}",
    )
