"""Unusable share of facing pixels against roughness, a panel per distance, with the theory's critical roughness."""

from collections.abc import Sequence
from math import log10

from markupsafe import Markup

from studies.drawing import svg
from studies.drawing.band_figure import BAND_PLOT, Curve, band_and_line
from studies.sensitivity.roughness import RoughnessCurve

TICKS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
FACTOR = 2.0
"""Within this factor of B / (2 Z) the bend is expected (the half-vector argument is good to no more)."""


def roughness_figure(curves: Sequence[RoughnessCurve]) -> Markup:
    """Panels over the same axes."""
    width = BAND_PLOT.width / max(len(curves), 1)
    alphas = [alpha for curve in curves for alpha, _ in curve.points]
    ticks = [t for t in TICKS if min(alphas) / 1.01 <= t <= max(alphas) * 1.01]
    low, high = log10(min(alphas)), log10(max(alphas))
    panels = [_panel(curve, k * width, width, ticks, (low, high)) for k, curve in enumerate(curves)]
    return svg.figure(BAND_PLOT.width, BAND_PLOT.height, "Critical roughness", *panels)


def _panel(
    curve: RoughnessCurve, left: float, width: float, ticks: Sequence[float], ends: tuple[float, float]
) -> Markup:
    x = svg.Scale(*ends, left + BAND_PLOT.left, left + width - BAND_PLOT.right)
    y = svg.Scale(0, 100, BAND_PLOT.bottom, BAND_PLOT.top)
    points = [(log10(alpha), estimate) for alpha, estimate in curve.points]
    drawn = band_and_line(Curve("unusable", "series-false", points, lambda value: f"alpha {10**value:.3g}"), x, y)
    return svg.join(
        svg.text(left + BAND_PLOT.left - 30, 18, f"{curve.subject}, {curve.distance_m:g} m", "axis-label strong"),
        svg.text(left + BAND_PLOT.left - 30, 42, "unusable share of facing pixels [%]", "tick-label"),
        _theory(curve, x),
        svg.left_axis(y, left + BAND_PLOT.left, left + width - BAND_PLOT.right, [0, 50, 100]),
        drawn,
        _measured(curve, x, y),
        *(
            svg.join(svg.line(x(log10(t)), BAND_PLOT.bottom, x(log10(t)), BAND_PLOT.bottom + 5, "tick"),
                     svg.text(x(log10(t)), BAND_PLOT.bottom + 19, f"{t:g}", "tick-label mid"))
            for t in ticks
        ),
        svg.text((x.start + x.end) / 2, BAND_PLOT.bottom + 40, "GGX roughness alpha", "axis-label mid"),
    )  # fmt: skip


def _theory(curve: RoughnessCurve, x: svg.Scale) -> Markup:
    low, high = (min(max(x(log10(curve.theory * f)), x.start), x.end) for f in (1 / FACTOR, FACTOR))
    place = x(log10(curve.theory))
    band = svg.element(
        "rect", x=low, y=BAND_PLOT.top, width=high - low, height=BAND_PLOT.bottom - BAND_PLOT.top, klass="theory-band"
    )
    return svg.join(
        band,
        svg.line(place, BAND_PLOT.top, place, BAND_PLOT.bottom, "theory"),
        svg.text(place + 5, BAND_PLOT.top + 13, f"B / 2Z = {curve.theory:.3f}", "tick-label"),
    )


def _measured(curve: RoughnessCurve, x: svg.Scale, y: svg.Scale) -> Markup:
    alpha = curve.measured
    if alpha is None:
        return Markup("")
    place = x(log10(alpha))
    height = y(100 * curve.bend_share)
    mark = svg.element("circle", cx=place, cy=height, r=6, klass="crossing")
    return svg.join(
        svg.marked(mark, f"half of the peak at alpha {alpha:.3f}"),
        svg.text(place + 10, height - 8, f"{alpha:.3f}", "tick-label strong"),
    )
