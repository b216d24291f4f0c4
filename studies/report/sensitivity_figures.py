"""The figures of a sensitivity study, made from its rows; a figure for which nothing was measured is empty."""

from collections.abc import Callable, Sequence

from markupsafe import Markup

from materials.finishes import FINISHES
from render.causes import HOLES, Cause
from studies.estimates import mean_share
from studies.report.band_figure import Curve, CurvePanel, band_figure
from studies.report.cause_figure import Bar, cause_figure
from studies.report.heat_map_figure import Cell, Panel, heat_map_figure
from studies.report.heat_map_figure import Row as MapRow
from studies.sensitivity_columns import FALSE_DEPTHS, cause_column
from studies.sensitivity_shares import Row, column_sum, false_depth, holes, part_pixels, share
from studies.sensitivity_trust import spoken, surface, together

Share = Callable[[Sequence[Row]], float | None]
RED, TEAL, BLUE, ORANGE = (200, 69, 59), (31, 140, 120), (44, 108, 176), (217, 123, 22)
"""Of holes, false depth, the detector and the recovery, as in the page's style."""
SERIES = 6
"""Colours of the page's style for curves without a meaning of their own."""
LEAST_PX = 200
"""Pixels of a bin below which a view says nothing about it (choice: a patch of 14 x 14)."""
TURN_BIN_DEG = 15.0
"""Width of a bin of incidence change [deg] (choice: a handful of views in each)."""


def hole_share(rows: Sequence[Row]) -> float | None:
    """Share of the part without depth."""
    return share(rows, holes, part_pixels)


def false_share(rows: Sequence[Row]) -> float | None:
    """Share of the part with false depth."""
    return share(rows, false_depth, part_pixels)


def unusable_share(rows: Sequence[Row]) -> float | None:
    """Share of the part without depth or with false depth."""
    return share(rows, lambda row: holes(row) + false_depth(row), part_pixels)


def mapped_rows(rows: Sequence[Row]) -> list[Row]:
    """What heat maps show: the subject that was looked at in most combinations of material and angle."""
    named = [row for row in rows if row["main_light"] and surface(row)]
    by_subject = together(named, lambda row: row["subject"])
    return max(by_subject.values(), default=[], key=lambda group: len(together(group, _cell_key)))


def _cell_key(row: Row) -> tuple[str, float]:
    return row["material"], row["polar_deg"]


def heat_map(title: str, rows: Sequence[Row], value: Share, of: str, colour: tuple[int, int, int]) -> Markup:
    """The share for every material and angle, one panel per distance. of: column of what it is a share of."""
    panels = [
        map_panel(f"{distance:g} m from the middle", group, value, of)
        for distance, group in sorted(together(rows, lambda row: row["distance_m"]).items())
    ]
    return panels_figure(title, rows, panels, colour)


def map_panel(title: str, rows: Sequence[Row], value: Share, of: str) -> Panel:
    """The share for every material and angle."""
    cells = {}
    for (spec, polar), group in together(rows, _cell_key).items():
        found = value(group)
        words = "nothing to have a share of" if found is None else f"{100 * found:.1f} %"
        counted = f"{len(group)} views, {column_sum(group, of):,.0f} {of.replace('_', ' ')}"
        cells[spec, polar] = Cell(found, f"{spec}, {polar:g} deg: {words} ({counted})")
    return Panel(title, cells)


def panels_figure(title: str, rows: Sequence[Row], panels: Sequence[Panel], colour: tuple[int, int, int]) -> Markup:
    """Panels over all materials and angles of the rows."""
    columns = sorted({row["polar_deg"] for row in rows})
    return (
        heat_map_figure(title, map_rows(rows), columns, panels, colour, "angle of incidence [deg]")
        if rows
        else Markup("")
    )


def map_rows(rows: Sequence[Row]) -> list[MapRow]:
    """Materials finish by finish, from mirrors to rough ones; then those that are no metals."""
    order = {finish: k for k, finish in enumerate(FINISHES)}
    materials = list(together(rows, lambda row: (row["material"], row["metal"], row["finish"])))
    metals = sorted((m for m in materials if m[1]), key=lambda m: order.get(m[2], len(order)))
    named = [MapRow(spec, finish, spoken(metal)) for spec, metal, finish in metals]
    return named + [MapRow(spec, "no metal", spoken(spec)) for spec, metal, _ in materials if not metal]


def angle_curves(rows: Sequence[Row]) -> tuple[Markup, dict]:
    """Holes and false depth against the angle, a panel per finish, bands over seeds; and of what they are.

    Of the subject, metal and distance that were measured with most seeds.
    """
    metals = [row for row in rows if row["main_light"] and row["finish"]]
    groups = together(metals, lambda row: (row["subject"], row["metal"], row["distance_m"])).items()
    best = max(groups, default=None, key=lambda item: (len({row["seed"] for row in item[1]}), len(item[1])))
    if best is None:
        return Markup(""), {}
    (subject, metal, distance), chosen = best
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
    seeds = len({row["seed"] for row in chosen})
    facts = {"subject": subject, "metal": spoken(metal), "distance": distance, "seeds": seeds}
    angles = sorted({row["polar_deg"] for row in chosen})
    return band_figure("Shares against angle", panels, "incidence [deg]", angles), facts


def seed_points(rows: Sequence[Row], value: Share) -> list:
    """(angle, mean share over seeds)."""
    points = []
    for polar, group in sorted(together(rows, lambda row: row["polar_deg"]).items()):
        shares = [value(of_seed) for of_seed in together(group, lambda row: row["seed"]).values()]
        points.append((polar, mean_share([s for s in shares if s is not None])))
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
    """Unusable share against the true angle of incidence, a panel per subject, a curve per finish, bands over views."""
    named = [row for row in rows if row["main_light"] and row["finish"] and row["part_pixels"] >= LEAST_PX]
    panels, order = [], list(FINISHES)
    for subject, of_subject in together(named, lambda row: row["subject"]).items():
        finishes = sorted(
            together(of_subject, lambda row: row["finish"]).items(), key=lambda item: order.index(item[0])
        )
        curves = [
            Curve(finish, f"series-{order.index(finish) % SERIES}", view_points(group)) for finish, group in finishes
        ]
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
        points.append((middle, mean_share([s for s in shares if s is not None])))
    return points


def recovery_curves(rows: Sequence[Row]) -> Markup:
    """What single recovery views regain against the change of incidence that they make."""
    curves = []
    for kind, klass in (("diamond", "series-recovery"), ("pb", "series-nbv")):
        chosen = [row for row in rows if row["kind"] == kind and row["regained_share"] is not None]
        bins = together(chosen, lambda row: TURN_BIN_DEG * round(change(row) / TURN_BIN_DEG))
        points = [(middle, mean_share([row["regained_share"] for row in bins[middle]])) for middle in sorted(bins)]
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


def change(row: Row) -> float:
    """By how much more steeply the recovery view looks at the surface [deg]."""
    return row["incidence_deg"] - row["incidence_before_deg"]
