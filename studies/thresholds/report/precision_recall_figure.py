"""Precision against recall of the reflective regions: a curve for each combination of the parameters held."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from studies.drawing import svg
from studies.thresholds.report.precision_recall import OperatingPoint, PrecisionRecall
from studies.thresholds.report.setting_words import MARKS, setting_words

PR_PLOT = svg.Plot(width=svg.PAGE_WIDTH, height=470, left=60, right=1130, top=40, bottom=410)
"""Edges of the plot [px]."""
MARK_PX = {"plain": 3.5, "certified": 5.0, "chosen": 7.0}
"""Radius of a setting's mark [px]."""
DARKEST, LIGHTEST = (30, 62, 100), (170, 190, 212)
"""Ends of the curves' shades, red, green and blue (choice: blue, which no mark has)."""


@dataclass(frozen=True)
class DetectorCurves:
    """What the page shows of precision and recall."""

    chart: Markup | None
    """None where there is nothing to draw."""
    words: str
    """Instead of the chart, or what it leaves out."""
    key: tuple[tuple[str, str], ...] = ()
    """What the shades mean: colour and words."""
    traced: str | None = None
    """Parameter that the curves go along."""


def detector_curves(found: PrecisionRecall, marks: Mapping[int, str]) -> DetectorCurves:
    """The chart, or in words why there is none. marks: class of the settings of the grid that are not plain."""
    if not found.holes_px:
        return DetectorCurves(None, "No view shows a reflective hole: there is nothing to find, and no recall.")
    if not found.points:
        return DetectorCurves(
            None,
            f"No setting marks a pixel: none of the {found.holes_px} pixels of reflective holes is found, and there is "
            "no precision.",
        )
    if found.settings == 1:
        (point,) = found.points
        return DetectorCurves(None, f"One setting makes no curve. {_point_words(point)}.")
    shades = shades_of(found)
    return DetectorCurves(_figure(found, marks, shades), _left_out(found, marks), _key(shades), found.traced)


def _left_out(found: PrecisionRecall, marks: Mapping[int, str]) -> str:
    """Settings that are not in the chart."""
    silent = set(range(found.settings)) - {point.view_setting for point in found.points}
    if not silent:
        return ""
    certified = sum(marks.get(number, "plain") != "plain" for number in silent)
    among = f", {certified} of them certified," if certified else ""
    return f"Settings that mark no pixel{among} have no precision and are not drawn: {len(silent)} of {found.settings}."


@dataclass(frozen=True)
class Shades:
    """Colours of the curves by the value of one parameter."""

    name: str | None
    """Of the parameter; None where the curves differ in none."""
    values: tuple[Any, ...]

    def of(self, values: Mapping[str, Any]) -> str:
        """Colour of the curve of a setting."""
        place = self.values.index(values[self.name]) if self.name else 0
        share = place / max(len(self.values) - 1, 1)
        rgb = (round(dark + share * (light - dark)) for dark, light in zip(DARKEST, LIGHTEST, strict=True))
        return "#" + "".join(f"{part:02x}" for part in rgb)


def shades_of(found: PrecisionRecall) -> Shades:
    """By the parameter that has most values among the curves."""
    values: dict[str, dict[Any, None]] = {}
    for point in found.points:
        for name, value in point.values.items():
            if name != found.traced:
                values.setdefault(name, {})[value] = None
    most = max(values, key=lambda name: len(values[name]), default=None)
    return Shades(None, ()) if most is None or len(values[most]) < 2 else Shades(most, tuple(values[most]))


def _key(shades: Shades) -> tuple[tuple[str, str], ...]:
    return tuple((shades.of({shades.name: value}), f"{shades.name} {value}") for value in shades.values if shades.name)


def _figure(found: PrecisionRecall, marks: Mapping[int, str], shades: Shades) -> Markup:
    x, y = (
        svg.Scale(0, min(100, 105 * most) or 100, *ends)
        for most, ends in (
            (max(p.recall for p in found.points), (PR_PLOT.left, PR_PLOT.right)),
            (max(p.precision for p in found.points), (PR_PLOT.bottom, PR_PLOT.top)),
        )
    )
    lines = [
        svg.element("g", svg.path([(x(100 * p.recall), y(100 * p.precision)) for p in curve], "detector-curve"),
                    style=f"stroke: {shades.of(curve[0].values)}")
        for curve in found.curves
    ]  # fmt: skip
    by_mark = sorted(found.points, key=lambda p: MARKS.index(marks.get(p.view_setting, "plain")))
    return svg.figure(
        PR_PLOT.width,
        PR_PLOT.height,
        "Precision against recall",
        svg.text(
            PR_PLOT.left, 18, "precision: share of the regions' pixels that are reflective holes [%]", "axis-label"
        ),
        svg.left_axis(y, PR_PLOT.left, PR_PLOT.right, y.ticks(5)),
        svg.bottom_axis(
            x, PR_PLOT.bottom, "recall: share of the reflective holes' pixels that are in a region [%]", x.ticks(8)
        ),
        *lines,
        *(_mark(p, marks.get(p.view_setting, "plain"), x, y) for p in by_mark),
    )


def _mark(point: OperatingPoint, klass: str, x: svg.Scale, y: svg.Scale) -> Markup:
    circle = svg.element(
        "circle", cx=x(100 * point.recall), cy=y(100 * point.precision), r=MARK_PX[klass], klass=f"setting {klass}"
    )
    return svg.marked(circle, _point_words(point))


def _point_words(point: OperatingPoint) -> str:
    return (
        f"{setting_words(point.values)}: finds {100 * point.recall:.1f} % of the reflective holes' pixels, "
        f"{100 * point.precision:.1f} % of its regions' pixels are reflective holes"
    )
