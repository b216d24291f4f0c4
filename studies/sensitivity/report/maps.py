"""Heat maps of a sensitivity study: a share for every material and angle of the subject that was looked at most."""

from collections.abc import Callable, Sequence

from markupsafe import Markup

from materials.finishes import FINISHES
from studies.drawing.heat_map_figure import Cell, MapRow, Panel, heat_map_figure
from studies.sensitivity.shares import Row, column_sum
from studies.sensitivity.trust import spoken, surface, together

ShareOfRows = Callable[[Sequence[Row]], float | None]
RED, TEAL, BLUE, ORANGE = (200, 69, 59), (31, 140, 120), (44, 108, 176), (217, 123, 22)
"""Of holes, false depth, the detector and the recovery, as in the page's style."""


def mapped_rows(rows: Sequence[Row]) -> list[Row]:
    """What heat maps show: the subject that was looked at in most combinations of material and angle."""
    named = [row for row in rows if row["main_light"] and surface(row)]
    by_subject = together(named, lambda row: row["subject"])
    return max(by_subject.values(), default=[], key=lambda group: len(together(group, _cell_key)))


def _cell_key(row: Row) -> tuple[str, float]:
    return row["material"], row["polar_deg"]


def heat_map(title: str, rows: Sequence[Row], value: ShareOfRows, of: str, colour: tuple[int, int, int]) -> Markup:
    """The share for every material and angle, one panel per distance. of: column of what it is a share of."""
    panels = [
        map_panel(f"{distance:g} m from the middle", group, value, of)
        for distance, group in sorted(together(rows, lambda row: row["distance_m"]).items())
    ]
    return panels_figure(title, rows, panels, colour)


def map_panel(title: str, rows: Sequence[Row], value: ShareOfRows, of: str) -> Panel:
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
    named = [MapRow(spec, spoken(finish), spoken(metal)) for spec, metal, finish in metals]
    return named + [MapRow(spec, "no metal", spoken(spec)) for spec, metal, _ in materials if not metal]
