"""`franbv safe-angles`: at which angles of incidence a material and finish give right depth, and how sure that is."""

import time
from dataclasses import asdict
from pathlib import Path

from franbv.surfaces.safe_angles import SafeAngles
from materials.input_error import InputError
from render.matcher.d400_preset import is_file_name
from studies.base.console import say, say_json, warn
from studies.base.flags import parse_wider_command
from studies.base.inputs import check_not_overwritten
from studies.base.output_errors import prepare_output
from studies.run.scene_settings import build_subject
from studies.run.stored_run import REPORT
from studies.safe_angles.flags import SafeAnglesCommand
from studies.safe_angles.plan import ANGLES_PLAN, AnglesPlan, read_angles_plan, write_angles_plan
from studies.safe_angles.sentences import table_lines
from studies.safe_angles.settings import SafeAnglesSettings, check_settings, subject_in
from studies.safe_angles.table import SAFE_ANGLES, safe_angles_table, stored_tables, write_safe_angles
from studies.safe_angles.views import angle_views, do_angles_view, subject_scene
from studies.sensitivity.measurement import measure_missing
from studies.sensitivity.tables import TABLES, write_tables
from studies.work.executor import executor_of, exit_status

_PROGRAM = "franbv safe-angles"
_HELP = "Find the angles of incidence at which materials give right depth: a card for each, a table for planners."


def run(args: list[str]) -> int:
    """Measure the views that are missing, then build table and page from all of them."""
    began = time.perf_counter()
    command = parse_wider_command(SafeAnglesCommand, SafeAnglesSettings, args, _PROGRAM, _HELP)
    for name, value in (("share", command.share), ("confidence", command.confidence)):
        if not 0 < value < 1:
            raise InputError(f"--{name} {value:g}: is no share between 0 and 1; give one such as 0.95")
    settings = check_settings(command.settings)
    for notice in build_subject(subject_in(settings, settings.material[0])).notices:
        warn(f"{_PROGRAM}: {notice}")
    views = angle_views(settings)
    preset = settings.sensor.preset
    read = [settings.mesh, settings.materials_file, command.config, Path(preset) if is_file_name(preset) else None]
    written = (ANGLES_PLAN, SAFE_ANGLES, REPORT, *(f"{table}.parquet" for table in TABLES))
    check_not_overwritten(read, map(command.out.joinpath, written))
    with executor_of(command.work) as executor:  # before anything is written
        prepare_output(command.out)
        plan = write_angles_plan(command.out, settings, command.share, command.confidence, views)
        failures = measure_missing(command.out, views, do_angles_view, executor, _PROGRAM, subject_scene(settings))
    table, report = evaluate_angles(command.out, plan)
    for line in table_lines(table):
        say(line)
    say(f"Table: {command.out / SAFE_ANGLES}\nReport: {report}")
    if command.json:
        figures = {"materials": [asdict(entry) for entry in table.materials]}
        wall_s = time.perf_counter() - began
        say_json({"folder": str(command.out), **figures, "failed": len(failures), "wall_s": wall_s})
    return exit_status(failures)


def evaluate_angles(out: Path, plan: AnglesPlan) -> tuple[SafeAngles, Path]:
    """Write tables and page of the views that are finished; returns the table and the page's path."""
    from studies.safe_angles.report.page import write_angles_report

    tables = stored_tables(out, plan)
    table = safe_angles_table(plan, tables)
    write_tables(out, tables)
    write_safe_angles(out, table, plan.versions)
    return table, write_angles_report(out, plan, table, len(tables.views))


def rebuild(out: Path) -> Path:
    """Tables and page from the folder alone; returns the page's path."""
    return evaluate_angles(out, read_angles_plan(out))[1]
