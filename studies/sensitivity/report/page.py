"""The report of a sensitivity study: where not to trust the method, heat maps, curves, tables, into one HTML file."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from markupsafe import Markup

from materials.finishes import FINISHES
from render.labels.causes import LEGEND
from render.world.rig import CAMERA_MODELS
from studies.base.atomic_file import write_atomically
from studies.base.numbers_as_text import percent
from studies.drawing.cause_figure import css_colour
from studies.drawing.templates import environment, page_style
from studies.run.report.page import flattened
from studies.run.stored_run import REPORT
from studies.sensitivity.plan import Plan, read_plan
from studies.sensitivity.report.figures import (
    angle_curves,
    cause_bars,
    incidence_curves,
    recovery_curves,
    shown_causes,
)
from studies.sensitivity.report.maps import BLUE, ORANGE, RED, TEAL, heat_map, map_panel, mapped_rows, panels_figure
from studies.sensitivity.report.roughness_figure import roughness_figure
from studies.sensitivity.report.tables import (
    dot_table,
    finish_table,
    light_table,
    possible_table,
    stage_table,
    subject_table,
)
from studies.sensitivity.roughness import roughness_curves
from studies.sensitivity.rules import pb_regained, precision, recall, regained
from studies.sensitivity.sentences import study_findings
from studies.sensitivity.shares import Row, false_share, hole_share
from studies.sensitivity.tables import Tables, gather_tables, main_rows, of_own_dots, study_summary, write_tables
from studies.sensitivity.trust import distrusts, spoken, trusted


def rebuild(out: Path) -> Path:
    """(Re)build tables and report from the folders of the finished cases; returns the report's path."""
    plan = read_plan(out)
    tables = gather_tables(out, plan.cases)
    write_tables(out, tables)
    return write_sensitivity_report(out, plan, tables)


def write_sensitivity_report(out: Path, plan: Plan, tables: Tables) -> Path:
    """(Re)build `report.html` in the study's folder; returns its path."""
    path = out / REPORT
    write_atomically(path, sensitivity_html(plan, tables).encode())
    return path


def sensitivity_html(plan: Plan, tables: Tables) -> str:
    """The whole page."""
    figures, main = study_summary(tables), main_rows(tables)
    baseline = CAMERA_MODELS[plan.preset.get("sensor", {}).get("model", "d435i")].baseline
    mapped, curves = mapped_rows(main), roughness_curves(main, baseline)
    against_angle, repeated = angle_curves(main)
    found = distrusts(main)
    return (
        environment("studies.sensitivity.report")
        .get_template("sensitivity.html.j2")
        .render(
            title=plan.title,
            paragraph=study_findings(figures, main, of_own_dots(tables.views), curves),
            tiles=list(study_tiles(figures, main)),
            measured=figures["cases"],
            wanted=len({case for _, case in plan.cases}),
            distrusts=found,
            trusted=trusted(main, found),
            spoken=spoken,
            mapped=spoken(mapped[0]["subject"]) if mapped else "",
            maps=depth_maps(mapped),
            detector_maps=detector_maps(mapped),
            recovery_maps=recovery_maps(plan, mapped),
            against_angle=against_angle,
            repeated=repeated,
            roughness=roughness_figure(curves) if curves else Markup(""),
            causes=cause_bars(main),
            legend=[(css_colour(cause), LEGEND[cause]) for cause in shown_causes(mapped)],
            incidence=incidence_curves(of_own_dots(tables.incidence)),
            finishes=[(f"var(--series-{k})", spoken(name)) for k, name in shown_finishes(main)],
            recovery=recovery_curves(of_own_dots(tables.recovery_views)),
            stages=stage_table(main),
            hiding=finish_table(main),
            lights=light_table(of_own_dots(tables.views)),
            dots=dot_table(tables.views),
            subjects=subject_table(main),
            possible=possible_table(main),
            config=[pair for pair in flattened(plan.preset) if not pair[0].startswith("sweeps")],
            sweeps=list(sweep_words(plan)),
            versions=plan.versions,
            style=page_style(("studies.sensitivity.report", "sensitivity.css")),
        )
    )


def study_tiles(figures: Mapping[str, Any], main: Sequence[Row]) -> Iterator[tuple[str, str, str]]:
    """Headline figures: value, name, what it is measured against."""
    yield (
        f"{len(main):,}",
        "views",
        f"of {len({row['material'] for row in main})} materials, labelled pixel by pixel",
    )
    yield percent(figures["hole_share"]), "no depth", "of the part's pixels before decimation"
    yield percent(figures["false_depth_share"]), "false depth", "off by more than 5 mm and three sigmas"
    yield percent(figures["detection_precision"]), "precision", "share of the reported pixels that are reflective"
    yield percent(figures["detection_recall"]), "recall", "share of the reflective pixels that are reported"
    yield (
        percent(figures["recovered_share"]),
        "recovered",
        f"of the missing surface; PB-NBV {percent(figures['pb_recovered_share'])}",
    )
    yield percent(figures["unexplained_share"]), "unexplained", "of all pixels without depth, table included"


def depth_maps(mapped: Sequence[Row]) -> list[tuple[str, Markup]]:
    """Name and figure: missing depth, false depth."""
    named = (("No depth", hole_share, RED), ("False depth", false_share, TEAL))
    return [(name, heat_map(name, mapped, value, "part_pixels", colour)) for name, value, colour in named if mapped]


def detector_maps(mapped: Sequence[Row]) -> Markup:
    """Precision and recall side by side, at the nearest distance, where regions are largest."""
    near = nearest(mapped)
    panel = partial(map_panel, rows=near)
    panels = [
        panel("precision of the reported pixels", value=precision, of="found_grouped"),
        panel("recall of the reflective pixels", value=recall, of="reflective"),
    ]
    return panels_figure("Detection", near, panels, BLUE)


def recovery_maps(plan: Plan, mapped: Sequence[Row]) -> Markup:
    """What the recovery poses regain beside the views of PB, where that was measured."""
    recovered = {sweep["name"] for sweep in plan.preset["sweeps"] if sweep["recovery"]}
    rows = [row for row in nearest(mapped) if row["sweep"] in recovered]
    panel = partial(map_panel, rows=rows)
    panels = [
        panel("regained by the recovery poses", value=regained, of="missing_mm2"),
        panel("regained by as many views of PB-NBV", value=pb_regained, of="missing_mm2"),
    ]
    return panels_figure("Recovery", rows, panels, ORANGE)


def nearest(rows: Sequence[Row]) -> list[Row]:
    """Those at the smallest distance."""
    least = min((row["distance_m"] for row in rows), default=0.0)
    return [row for row in rows if row["distance_m"] == least]


def shown_finishes(main: Sequence[Row]) -> list[tuple[int, str]]:
    """Number and name of the finishes that occur."""
    present = {row["finish"] for row in main}
    return [(k, name) for k, name in enumerate(FINISHES) if name in present]


def sweep_words(plan: Plan) -> Iterator[tuple[str, str]]:
    """Name of every sweep, and what it lists."""
    for sweep in plan.preset["sweeps"]:
        listed = {key: value for key, value in sweep.items() if key != "name" and value not in ([], [None], False, 0)}
        yield (
            sweep["name"],
            "; ".join(
                f"{spoken(key)}: {', '.join(map(str, value)) if isinstance(value, list) else value}"
                for key, value in listed.items()
            ),
        )
