"""The tables of a sensitivity report, as words ready for the page; a table for which nothing was measured is empty."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from materials.finishes import FINISHES
from studies.base.numbers_as_text import counted, percent
from studies.sensitivity.columns import DETECTOR_STAGES
from studies.sensitivity.rules import hidden, pb_regained, precision, recall, regained
from studies.sensitivity.shares import Row, column_share, column_sum, false_share, hole_share
from studies.sensitivity.trust import spoken, surface, together

DETECTOR_STAGE_WORDS = {
    "persistent_invalid": "no depth in half of the frames",
    "inside_silhouette": "inside the silhouette",
    "inside_eroded_silhouette": "inside the eroded silhouette",
    "located": "first hit is a frontier ellipsoid",
    "grouped": "in a cluster, and so in a region",
}
"""Steps of the detector in words."""


@dataclass(frozen=True)
class Table:
    """A table of words and numbers."""

    head: Sequence[str]
    """Names of the columns; the first is that of the rows."""
    rows: Sequence[Sequence[str]]


def stage_table(rows: Sequence[Row]) -> Table:
    """What is left after each filter of the detector, pooled over all views in which detection was measured."""
    judged = [row for row in rows if row["reflective"] is not None]
    true = column_sum(judged, "reflective")
    lines, before = [], true
    for stage in DETECTOR_STAGES:
        found, right = column_sum(judged, f"found_{stage}"), column_sum(judged, f"right_{stage}")
        shares = (right / found if found else None, right / true if true else None)
        lines.append(
            [
                DETECTOR_STAGE_WORDS.get(stage, stage.replace("_", " ")),
                f"{found:,.0f}",
                f"{right:,.0f}",
                *map(percent, shares),
                f"{before - right:,.0f}",
            ]
        )
        before = right
    return Table(
        ["Left after", "pixels", "of them reflective", "precision", "recall", "reflective ones lost here"], lines
    )


def finish_table(rows: Sequence[Row]) -> Table:
    """What decimation hides and how regions overlap the missing surface, finish by finish."""
    lines = []
    for name, group in by_surface(rows):
        in_front = [row["in_front_mm"] for row in group if row["in_front_mm"] is not None]
        lines.append([
            spoken(name),
            f"{column_sum(group, 'fine_holes'):,.0f}",
            percent(hidden(group)),
            percent(column_share(group, "holes_made_false", "fine_holes")),
            percent(column_share(group, "hidden_false", "fine_false")),
            f"{column_sum(group, 'regions'):,.0f}",
            percent(column_share(group, "region_missing_mm2", "region_mm2")),
            percent(column_share(group, "patch_found_mm2", "patch_mm2")),
            f"{median(in_front):.0f} mm" if in_front else "n/a",
        ])  # fmt: skip
    return Table(
        ["Surface", "reflective holes [px]", "filled by decimation", "of them with false depth", "false depth hidden",
         "regions", "region that is missing", "missing surface in regions", "points before the surface"],
        lines,
    )  # fmt: skip


def light_table(rows: Sequence[Row]) -> Table:
    """Holes and false depth under every light, of the cases that were measured under several."""
    lit = {case for case, group in together(rows, lambda row: row["case"]).items() if len(_lights(group)) > 1}
    chosen = [row for row in rows if row["case"] in lit]
    finishes = [name for name, _ in by_surface(chosen)]
    lines = []
    for (lamps, laser), group in together(chosen, lambda row: (row["lamps"], row["laser_mw"])).items():
        of = dict(by_surface(group))
        shares = [
            f"{percent(hole_share(of[name]))} / {percent(false_share(of[name]))}" for name in finishes if name in of
        ]
        lines.append([f"lamps {lamps}, laser {laser:g} mW", *shares])
    return Table(["Light", *(f"{spoken(name)}: no depth / false" for name in finishes)], lines)


def dot_table(rows: Sequence[Row]) -> Table:
    """Holes and false depth by the width of the projector's dots, of what was measured with several."""
    groups = together([row for row in rows if row["main_light"]], _but_for_dots).values()
    several = [row for group in groups if len({row["dot_fwhm_px"] for row in group}) > 1 for row in group]
    finishes = [name for name, _ in by_surface(several)]
    lines = []
    for width, group in sorted(together(several, lambda row: row["dot_fwhm_px"] or 0.0).items()):
        of = dict(by_surface(group))
        shares = [
            f"{percent(hole_share(of[name]))} / {percent(false_share(of[name]))}" if name in of else ""
            for name in finishes
        ]
        lines.append([f"{width:g} px wide" if width else "the sensor's own", *shares])
    return Table(["Dots", *(f"{spoken(name)}: no depth / false" for name in finishes)], lines)


def subject_table(rows: Sequence[Row]) -> Table:
    """Everything at a glance for each coupon and part, surface by surface."""
    lines = []
    for subject, group in together([row for row in rows if surface(row)], lambda row: row["subject"]).items():
        for name, chosen in by_surface(group):
            shares = (hole_share, false_share, precision, recall, regained, pb_regained)
            lines.append([
                f"{spoken(subject)}, {spoken(name)}",
                f"{len(chosen)}",
                *(percent(value(chosen)) for value in shares),
                f"{column_sum(chosen, 'missing_mm2') / 100:,.0f} cm²",
            ])  # fmt: skip
    return Table(
        ["Subject and surface", "views", "no depth", "false depth", "precision", "recall", "recovered", "PB-NBV",
         "of missing surface"],
        lines,
    )  # fmt: skip


def possible_table(rows: Sequence[Row]) -> Table:
    """What the best of the hemisphere's poses regains, beside the diamond's and PB's, case by case."""
    lines = [
        [
            f"{spoken(row['subject'])}, {row['material']}, {row['polar_deg']:g} deg",
            f"{row['missing_mm2'] / 100:.1f} cm²",
            _regained(row, "regained_mm2", row["recovery_views"]),
            _regained(row, "pb_regained_mm2", row["pb_views"]),
            f"{percent(row['best_regained_mm2'] / row['missing_mm2'])} by the best of {row['hemisphere_views']}",
        ]
        for row in rows
        if row["hemisphere_views"]
    ]
    return Table(["Case", "missing", "diamond", "PB-NBV", "single pose"], lines)


def _regained(row: Row, column: str, views: int) -> str:
    return f"{percent(row[column] / row['missing_mm2'])} by {counted(views, 'view')}"


def by_surface(rows: Iterable[Row]) -> list[tuple[str, list[Row]]]:
    """Rows by finish, from mirrors to rough ones, then by the names of what is no metal."""
    order: Mapping[str, int] = {finish: k for k, finish in enumerate(FINISHES)}
    groups = together([row for row in rows if surface(row)], surface)
    return sorted(groups.items(), key=lambda item: order.get(item[0], len(order)))


def _but_for_dots(row: Row) -> tuple[str, ...]:
    """What cases share that differ in the width of the dots alone."""
    names = ("subject", "material", "polar_deg", "distance_m", "seed")
    return tuple(str(row[name]) for name in names)


def _lights(rows: Iterable[Row]) -> set[tuple[str, float]]:
    return {(row["lamps"], row["laser_mw"]) for row in rows}
