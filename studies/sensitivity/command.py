"""`franbv study sensitivity`: which materials and angles break the depth, the detector and the recovery, and why."""

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from studies.base.console import say, say_json
from studies.base.flags import parse
from studies.base.inputs import check_not_overwritten
from studies.base.output_errors import prepare_output
from studies.run.scene_settings import preset_files, with_sensor_resolved
from studies.run.stored_run import REPORT
from studies.sensitivity.cases import sweep_cases
from studies.sensitivity.measurement import do_case, measure_missing
from studies.sensitivity.plan import PLAN, write_plan
from studies.sensitivity.preset import SensitivityPreset
from studies.sensitivity.tables import TABLES, gather_tables, study_summary, write_tables
from studies.work.executor import WorkFlags, executor_of, exit_status

_PROGRAM = "franbv study sensitivity"
_HELP = "Measure which materials and angles break the depth, the detector and the recovery, and why."


@dataclass(frozen=True)
class SensitivityCommand:
    """The flags of `franbv study sensitivity`."""

    out: Path
    """Output folder. Finished cases in it are not measured again."""
    preset: Annotated[str, tyro.conf.arg(metavar="quick|full|FILE.yaml")] = "quick"
    """What to measure: a preset, or a YAML file of your own."""
    work: Annotated[WorkFlags, tyro.conf.arg(name="")] = field(default_factory=WorkFlags)
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Measure what is missing, then build tables and report from all cases."""
    began = time.perf_counter()
    command = parse(SensitivityCommand, args, _PROGRAM, _HELP)
    named = SensitivityPreset.named(command.preset)
    preset = with_sensor_resolved(named)
    wanted = sweep_cases(preset)
    written = (PLAN, REPORT, *(f"{table}.parquet" for table in TABLES))
    check_not_overwritten(preset_files(command.preset, named.sensor), map(command.out.joinpath, written))
    with executor_of(command.work) as executor:  # before anything is written
        prepare_output(command.out)
        plan = write_plan(command.out, preset.title, preset, [(case.sweep, case.config.digest) for case in wanted])
        failures = measure_missing(command.out, [case.config for case in wanted], do_case, executor, _PROGRAM)
    from studies.sensitivity.report.page import write_sensitivity_report

    tables = gather_tables(command.out, plan.cases)
    write_tables(command.out, tables)
    report = write_sensitivity_report(command.out, plan, tables)
    say(f"{report}")
    figures = {**study_summary(tables), "failed": len(failures), "wall_s": time.perf_counter() - began}
    if command.json:
        say_json(figures)
    return exit_status(failures)
