"""Puts the report of a reconstruction together: figures, strips, tables and words into one HTML file."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from markupsafe import Markup

from studies.base.atomic_file import write_atomically
from studies.base.numbers_as_text import number, percent
from studies.base.output_errors import output_errors
from studies.drawing.templates import asset, environment, page_style
from studies.run.acquisition_table import MAP_COVERAGE, RAW_COVERAGE, RECOVERY
from studies.run.report.coverage_figure import coverage_figure
from studies.run.report.scene_payload import scene_payload
from studies.run.report.strip import strip
from studies.run.report.timing_figure import SENSING, stage_names, stage_times, timing_figure
from studies.run.sentences import is_open_loop, replay_words, run_paragraph
from studies.run.stored_run import REPORT, StoredRun


def write_report(case: Path) -> Path:
    """(Re)build `report.html` from the other files of the case; returns its path."""
    page = report_html(StoredRun(case)).encode()
    with output_errors(case):
        write_atomically(case / REPORT, page)
    return case / REPORT


def report_html(stored: StoredRun) -> str:
    """The whole page."""
    run, rows = stored.run, stored.rows  # first what tells its format
    views = [stored.view(k) for k in range(len(rows))]
    stages = stored.timings["acquisitions"]
    strips = [strip(view, stored.infrared(k)) for k, view in enumerate(views)]
    return (
        environment("studies.run.report")
        .get_template("reconstruction.html.j2")
        .render(
            run=run,
            replay=run.get("replay"),
            simulated=run.get("simulated"),
            replayed=replay_words(run["replay"]) if "replay" in run else "",
            open_loop=is_open_loop(run),
            summary=run["summary"],
            paragraph=run_paragraph(run, stored.timings),
            tiles=list(run_tiles(run["summary"], stored.timings, is_open_loop(run))),
            coverage=coverage_figure(rows) if run["surface_points"] else None,
            acquisitions=list(zip(rows, strips, strict=True)),
            recoveries=sum(row["kind"] == RECOVERY for row in rows),
            sensing=timing_figure(stages, [SENSING], "Sensing [s]"),
            planning=timing_figure(stages, [name for name in stage_names(stages) if name != SENSING], "Planning [s]"),
            stages=stage_times(stages),
            n_frames=run["config"]["parameters"]["n_frames"],
            config=list(flattened(run["config"])),
            scene=Markup(scene_payload(rows, views, *stored.cloud, *stored.surface)),
            style=page_style(),
            script=Markup(asset("studies.run.report", "scene_viewer.js")),
        )
    )


def run_tiles(
    summary: Mapping[str, Any], timings: Mapping[str, Any], open_loop: bool = False
) -> Iterator[tuple[str, str, str]]:
    """Headline figures: value, name, what it is measured against. Without a known surface nothing is told from one.

    open_loop: recoveries were proposed and not made.
    """
    known = summary[MAP_COVERAGE] is not None
    if known:
        yield from _surface_tiles(summary)
    else:
        yield "unknown", "coverage", "nobody has told the true surface"
    yield str(summary["acquisitions"]), "acquisitions", f"in {summary['nbv_iterations']} NBV iterations"
    believed, activations = summary["missing_believed"], summary["recovery_activations"]
    if believed is not None:
        yield percent(believed), "believed missing", "by the planner, which knows no surface"
    name = "recovery activation" if activations == 1 else "recovery activations"
    change = f"their views: {100 * summary['recovery_contribution']:+.1f} points of the map's coverage" if known else ""
    if open_loop:
        yield str(activations), "views with a recovery to begin", "proposed, and not made"
    elif activations or believed is None:
        yield str(activations), name, change or f"and {summary['recovery_acquisitions']} views for them"
    yield f"{timings['wall_s']:.0f} s", "wall time", "sensing, planning and evaluation"


def _surface_tiles(summary: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    yield percent(summary[MAP_COVERAGE]), "coverage of the map", "visible surface that the final map holds, at 5 mm"
    yield percent(summary[RAW_COVERAGE]), "raw coverage", "the same by all points ever seen, refuted ones too"
    yield (
        f"{number(summary['accuracy_mm'], '.1f')} mm",
        "accuracy",
        f"mean distance to the surface; median {number(summary['accuracy_median_mm'], '.1f')} mm",
    )
    yield number(summary["f_score"], ".2f"), "F-score", "coverage against share of true points, at 5 mm"


def flattened(config: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Keys joined by dots, with their values."""
    for key, value in config.items():
        if isinstance(value, Mapping):
            yield from flattened(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", ", ".join(map(str, value)) if isinstance(value, list) else str(value)
