"""`franbv study comparison`: FRA against PB and RE on parts A to D and an inside corner, beside the paper's numbers."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tyro

from materials.input_error import InputError
from materials.suggestion import suggest
from studies.base.atomic_file import write_atomically
from studies.base.case_folder import finished_case
from studies.base.console import say, say_json, strict_json, warn
from studies.base.flags import parse
from studies.base.inputs import check_not_overwritten
from studies.base.output_errors import prepare_output
from studies.base.stored_preset import read_preset_file, write_preset_file
from studies.comparison.cases import planned_runs
from studies.comparison.links import LINKS
from studies.comparison.planning_speed import SPEED_JOB, SpeedTask, is_measured, measure_speed
from studies.comparison.preset import ComparisonPreset
from studies.comparison.records import RUN_COLUMNS, read_records, table_row
from studies.comparison.report.equal_tables import equal_words
from studies.comparison.report.page import write_comparison_report
from studies.comparison.statistics import Comparison
from studies.comparison.summary import failed_runs, json_summary, paragraph
from studies.run.ablation import ABLATIONS
from studies.run.batch import RUNS, PlannedRun, check_runs, make_runs, stored_outcome
from studies.run.scene_settings import preset_files, with_sensor_resolved
from studies.run.stored_run import REPORT
from studies.store.tables import write_rows
from studies.work.executor import Executor, WorkFlags, executor_of, exit_status, reasons_once
from studies.work.study_clock import StudyClock
from studies.work.workers import Failure, Job, run_jobs

_PROGRAM = "franbv study comparison"
_HELP = "Compare FRA-NBV with PB-NBV and ray-cast entropy over many runs, beside the paper's numbers."
STUDY, RUNS_TABLE, SUMMARY = "comparison.json", "runs.parquet", "summary.json"
"""The resolved preset, the table of runs and the summary, in the output folder."""
STUDY_FORMAT = 2
"""Of the first; it rises when runs come to go by other names."""
WRITTEN = (STUDY, RUNS_TABLE, SUMMARY, REPORT)
"""What stands there beside the runs."""


@dataclass(frozen=True)
class ComparisonCommand:
    """The flags of `franbv study comparison`."""

    out: Path
    """Output folder. Finished runs in it are not repeated."""
    preset: Annotated[str, tyro.conf.arg(metavar="quick|paper|corner|robust|robust_ablation|FILE.yaml")] = "paper"
    """What to run: a preset, or a YAML file of your own."""
    ablations: Annotated[tuple[str, ...], tyro.conf.arg(metavar="all|NAME...")] = ()
    """Ablations to run beside it; `all` for all of them. Those that the folder's study has already stay in it."""
    links: Annotated[tuple[str, ...], tyro.conf.arg(metavar="all|NAME...")] = ()
    """Links before the planner to change, one at a time; `all` for all of them. They stay likewise."""
    work: Annotated[WorkFlags, tyro.conf.arg(name="")] = field(default_factory=WorkFlags)
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Run what is missing, then build table and report from all runs; exit status 1 when runs failed."""
    command = parse(ComparisonCommand, args, _PROGRAM, _HELP)
    named = ComparisonPreset.named(command.preset)
    preset = with_sensor_resolved(named)
    preset = with_named(preset, "ablations", command.ablations, ABLATIONS)
    preset = with_named(preset, "links", command.links, LINKS)
    preset = with_stored_arms(preset, command.out)
    runs = planned_runs(preset)
    check_runs(runs)
    check_not_overwritten(preset_files(command.preset, named.sensor), map(command.out.joinpath, WRITTEN))
    with executor_of(command.work) as executor:  # before anything is written
        prepare_output(command.out)
        write_preset(command.out, preset)
        clock = StudyClock.started(command.out, [command.out / RUNS], stored_outcome(command.out / SUMMARY).wall_s)
        failures = reconstruct_all(command.out, preset, runs, executor)
    summary, comparison = evaluate(command.out, preset, runs, failures, clock.elapsed_s())
    clock.stop()
    told = [paragraph(comparison, len(runs), failed_runs(failures), preset.planners)]
    told += equal_words(comparison, preset.whole_parts, preset.planners)
    say("\n".join([*told, f"Report: {command.out / REPORT}"]))
    if command.json:
        say_json(summary)
    return exit_status(failures)


def write_preset(out: Path, preset: ComparisonPreset) -> None:
    """Put down what the study in this folder is."""
    write_preset_file(out / STUDY, preset, STUDY_FORMAT)


def stored_preset(out: Path) -> ComparisonPreset:
    """What the study in this folder is; errors as `read_preset_file` has them."""
    return read_preset_file(out / STUDY, ComparisonPreset, STUDY_FORMAT)


def with_named(
    preset: ComparisonPreset, field: str, names: tuple[str, ...], known: Mapping[str, Any]
) -> ComparisonPreset:
    """The preset with these ablations or links instead of its own, if any are named."""
    names = tuple(known) if "all" in names else names
    for name in names:
        if name not in known:
            raise InputError(f"--{field} {name}: there is none; {suggest(name, known)}")
    return preset.model_copy(update={field: tuple(dict.fromkeys(names))}) if names else preset


def with_stored_arms(preset: ComparisonPreset, out: Path) -> ComparisonPreset:
    """The preset with those ablations and links besides that the study in this folder has, if it is the same study.

    If it is another one (a preset with more runs in the same folder, say), its arms are left out, and it is said.
    """
    if not (out / STUDY).exists():
        return preset
    try:
        stored = stored_preset(out)
    except InputError as error:
        warn(f"{_PROGRAM}: {error}; it is replaced, and the report leaves out what only it names")
        return preset
    ours, theirs = (config.model_dump(exclude={"ablations", "links"}) for config in (preset, stored))
    differing = [key for key in ours if ours[key] != theirs[key]]
    if not differing:
        arms = {field: (*getattr(stored, field), *getattr(preset, field)) for field in ("ablations", "links")}
        return preset.model_copy(update={field: tuple(dict.fromkeys(names)) for field, names in arms.items()})
    left_out = [name for name in (*stored.ablations, *stored.links) if name not in (*preset.ablations, *preset.links)]
    if left_out:
        warn(
            f"{_PROGRAM}: {out / STUDY}: was of a study with another {', '.join(differing)}; "
            f"its {', '.join(left_out)} are not in this one, name them to have them"
        )
    return preset


def reconstruct_all(out: Path, preset: ComparisonPreset, runs: list[PlannedRun], executor: Executor) -> list[Failure]:
    """Make the runs that are not there yet, then time planning on this machine while nothing else runs."""
    failures = make_runs(out, runs, executor, _PROGRAM)
    speed = speed_job(out, preset, runs)
    return failures + (run_jobs([[speed]], 1, tell=reasons_once(_PROGRAM)) if speed else [])


def speed_job(out: Path, preset: ComparisonPreset, runs: list[PlannedRun]) -> Job | None:
    """The measurement of planning times on the maps of PB's first finished run on the last part (of FRA's the third
    view may be a recovery), unless it is there."""
    sources = [
        planned for planned in runs if (planned.part, planned.arm) in {(part, "pb") for part in preset.parts[-1:]}
    ]
    found = next((case for planned in sources if (case := finished_case(out / RUNS, planned.digest))), None)
    if not preset.speed or found is None:
        return None
    task = SpeedTask(out, found, preset.parameters)
    return None if is_measured(task) else Job(SPEED_JOB, measure_speed, task)


def evaluate(
    out: Path, preset: ComparisonPreset, runs: list[PlannedRun], failures: list[Failure], wall_s: float
) -> tuple[dict[str, Any], Comparison]:
    """Write table, summary and report of the runs that are finished; returns the summary and the runs."""
    comparison = Comparison(read_records(out, runs))
    write_rows(out / RUNS_TABLE, RUN_COLUMNS, map(table_row, comparison.records))
    parts = list(dict.fromkeys(planned.part for planned in runs))
    summary = json_summary(comparison, parts, preset.planners, failed_runs(failures), wall_s)
    stored = {**summary, "failures": [asdict(failure) for failure in failures]}
    write_atomically(out / SUMMARY, strict_json(stored, indent=1).encode())
    write_comparison_report(out, preset, comparison, len(runs), failures)
    return summary, comparison


def rebuild(out: Path) -> Path:
    """Table, summary and report of a comparison from its folder alone; returns the report's path."""
    preset = stored_preset(out)
    before = stored_outcome(out / SUMMARY)
    evaluate(out, preset, planned_runs(preset), before.failures, before.wall_s)
    return out / REPORT
