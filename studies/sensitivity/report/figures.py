"""Curves and bars of a sensitivity study, made from its rows; a figure for which nothing was measured is empty."""

from collections.abc import Sequence

from markupsafe import Markup

from materials.finishes import FINISHES
from render.labels.causes import HOLES, Cause
from scenes.build import COUPONS
from studies.drawing.band_figure import Curve, CurvePanel, band_figure
from studies.drawing.cause_figure import Bar, cause_figure
from studies.sensitivity.columns import FALSE_DEPTHS, cause_column
from studies.sensitivity.report.maps import ShareOfRows, mapped_rows
from studies.sensitivity.shares import Row, column_sum, false_share, hole_share, unusable_share
from studies.sensitivity.trust import spoken, surface, together
from studies.statistics.intervals import mean_interval

LEAST_PX = 200
"""Pixels of a bin below which a view says nothing about it (choice: a patch of 14 x 14)."""
TURN_BIN_DEG = 15.0
"""Width of a bin of incidence change [deg] (choice: a handful of views in each)."""


def angle_curves(rows: Sequence[Row]) -> tuple[Markup, dict]:
    """Holes and false depth against the angle, a panel per finish, bands over seeds; and of what they are.

    Of the subject, metal and distance that were measured with most seeds.
    """
    metals = [row for row in rows if row["main_light"] and row["finish"]]
    groups = together(metals, lambda row: (row["subject"], row["metal"], row["distance_m"])).items()
    best = max(groups, default=None, key=lambda item: (len({row["seed"] for row in item[1]}), len(item[1])))
    if best is None:
        return Markup(""), {}
    (subject, metal, distance), measured = best
    seeds = len({row["seed"] for row in measured})
    by_finish = together(measured, lambda row: row["finish"]).values()
    chosen = [row for group in by_finish if len({row["seed"] for row in group}) == seeds for row in group]
    order = list(FINISHES)
    panels = [
        CurvePanel(
            finish,
            [
                Curve("no depth", "series-hole", seed_points(group, hole_share)),
                Curve("false depth", "series-false", seed_points(group, false_share)),
            ],
        )
        for finish, group in sorted(
            together(chosen, lambda row: row["finish"]).items(), key=lambda item: order.index(item[0])
        )
    ]
    facts = {"subject": subject, "metal": spoken(metal), "distance": distance, "seeds": seeds}
    angles = sorted({row["polar_deg"] for row in chosen})
    return band_figure("Shares against angle", panels, "incidence [deg]", angles), facts


def seed_points(rows: Sequence[Row], value: ShareOfRows) -> list:
    """(angle, mean share over seeds)."""
    points = []
    for polar, group in sorted(together(rows, lambda row: row["polar_deg"]).items()):
        shares = [value(of_seed) for of_seed in together(group, lambda row: row["seed"]).values()]
        points.append((polar, mean_interval([s for s in shares if s is not None])))
    return points


def cause_bars(rows: Sequence[Row]) -> Markup:
    """A bar per finish or material of the mapped rows."""
    groups = together(mapped_rows(rows), surface)
    order = {finish: k for k, finish in enumerate(FINISHES)}
    bars = []
    for name in sorted(groups, key=lambda name: order.get(name, len(order))):
        total = int(column_sum(groups[name], "part_pixels"))
        shares = {
            cause: column_sum(groups[name], cause_column(cause)) / max(total, 1) for cause in (*FALSE_DEPTHS, *HOLES)
        }
        bars.append(Bar(spoken(name), shares, total))
    return cause_figure("What became of the surface", bars) if bars else Markup("")


def shown_causes(rows: Sequence[Row]) -> list[Cause]:
    """Causes that occur at all, for the key of the bars."""
    return [cause for cause in (*FALSE_DEPTHS, *HOLES) if column_sum(rows, cause_column(cause)) > 0]


def incidence_curves(rows: Sequence[Row]) -> Markup:
    """Unusable share against the true angle of incidence, a panel per coupon, a curve per finish, bands over views."""
    of_coupons = [row for row in rows if row["main_light"] and row["finish"] and row["subject"] in COUPONS]
    named = [row for row in of_coupons if row["part_pixels"] >= LEAST_PX]
    panels, order = [], list(FINISHES)
    for subject, of_subject in together(named, lambda row: row["subject"]).items():
        finishes = sorted(
            together(of_subject, lambda row: row["finish"]).items(), key=lambda item: order.index(item[0])
        )
        curves = [Curve(finish, f"series-{order.index(finish)}", view_points(group)) for finish, group in finishes]
        panels.append(CurvePanel(spoken(subject), curves))
    ticks = [0.0, 30.0, 60.0, 90.0]
    return (
        band_figure("Unusable share against true incidence", panels, "true incidence [deg]", ticks)
        if panels
        else Markup("")
    )


def view_points(rows: Sequence[Row]) -> list:
    """(middle of the bin, mean unusable share over views)."""
    points = []
    for middle, group in sorted(together(rows, lambda row: row["incidence_deg"]).items()):
        shares = [unusable_share([row]) for row in group]
        points.append((middle, mean_interval([s for s in shares if s is not None])))
    return points


def recovery_curves(rows: Sequence[Row]) -> Markup:
    """What single recovery views regain against the change of incidence that they make."""
    curves = []
    for kind, klass in (("diamond", "series-recovery"), ("pb", "series-nbv")):
        chosen = [row for row in rows if row["kind"] == kind and row["regained_share"] is not None]
        bins = together(chosen, lambda row: TURN_BIN_DEG * round(incidence_change(row) / TURN_BIN_DEG))
        points = [(middle, mean_interval([row["regained_share"] for row in bins[middle]])) for middle in sorted(bins)]
        if points:
            curves.append(Curve(kind, klass, points))
    if not curves:
        return Markup("")
    ends = [value for curve in curves for value, _ in curve.points]
    ticks = [t for t in range(-90, 91, 30) if min(ends) - 30 < t < max(ends) + 30]
    return band_figure(
        "Regained share against change of incidence",
        [CurvePanel("", curves)],
        "change of the angle of incidence [deg]",
        ticks,
    )


def incidence_change(row: Row) -> float:
    """By how much more steeply the recovery view looks at the surface [deg]."""
    return row["incidence_deg"] - row["incidence_before_deg"]
