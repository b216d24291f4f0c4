"""`franbv study readings`: which reading of the paper's text makes its table, by a designed experiment."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from studies.base.console import say, say_json
from studies.base.flags import parse
from studies.base.inputs import check_not_overwritten
from studies.base.output_errors import prepare_output
from studies.base.stored_preset import read_preset_file, write_preset_file
from studies.readings.evaluation import READINGS_SUMMARY, WRITTEN_BESIDE, evaluate_readings
from studies.readings.preset import ReadingsPreset
from studies.readings.runs import reading_runs
from studies.run.batch import RUNS, check_runs, make_runs, stored_outcome
from studies.run.scene_settings import preset_files, with_sensor_resolved
from studies.work.executor import WorkFlags, executor_of, exit_status
from studies.work.study_clock import StudyClock

_PROGRAM = "franbv study readings"
_HELP = "Try what the paper's text leaves open, sixteen readings of it, and say which come near its table."
READINGS = "readings.json"
"""The resolved preset, in the output folder."""
READINGS_FORMAT = 1
"""Of that file; it rises when runs come to go by other names."""


@dataclass(frozen=True)
class ReadingsCommand:
    """The flags of `franbv study readings`."""

    out: Path
    """Output folder. Finished runs in it are not repeated."""
    preset: Annotated[str, tyro.conf.arg(metavar="quick|full|FILE.yaml")] = "full"
    """What to run: a preset, or a YAML file of your own."""
    work: Annotated[WorkFlags, tyro.conf.arg(name="")] = field(default_factory=WorkFlags)
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Run what is missing, then analyse all runs; exit status 1 when runs failed."""
    command = parse(ReadingsCommand, args, _PROGRAM, _HELP)
    named = ReadingsPreset.named(command.preset)
    preset = with_sensor_resolved(named)
    runs = reading_runs(preset)
    check_runs(runs)
    written = map(command.out.joinpath, (READINGS, *WRITTEN_BESIDE))
    check_not_overwritten(preset_files(command.preset, named.sensor), written)
    with executor_of(command.work) as executor:  # before anything is written
        prepare_output(command.out)
        write_preset_file(command.out / READINGS, preset, READINGS_FORMAT)
        outcome = stored_outcome(command.out / READINGS_SUMMARY)
        clock = StudyClock.started(command.out, [command.out / RUNS], outcome.wall_s)
        failures = make_runs(command.out, runs, executor, _PROGRAM)
    told = evaluate_readings(command.out, preset, runs, failures, clock.elapsed_s())
    clock.stop()
    say(f"{told.words}\nReport: {told.report}")
    if command.json:
        say_json(told.summary)
    return exit_status(failures)


def rebuild(out: Path) -> Path:
    """Tables, summary and report of a study of readings from its folder alone; returns the report's path."""
    preset = read_preset_file(out / READINGS, ReadingsPreset, READINGS_FORMAT)
    before = stored_outcome(out / READINGS_SUMMARY)
    return evaluate_readings(out, preset, reading_runs(preset), before.failures, before.wall_s).report
