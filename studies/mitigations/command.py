"""`franbv study mitigations`: which remedy for shiny metal wins where, and which common advice is wrong."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from studies.base.console import say, say_json
from studies.base.flags import parse
from studies.base.inputs import check_not_overwritten
from studies.base.output_errors import prepare_output
from studies.base.stored_preset import read_preset_file, write_preset_file
from studies.mitigations.cases import mitigation_cases
from studies.mitigations.cost import cost_line
from studies.mitigations.evaluation import MITIGATION_TABLES, MITIGATIONS_SUMMARY, evaluate_mitigations
from studies.mitigations.measurement import measure_cases
from studies.mitigations.preset import MitigationsPreset
from studies.mitigations.sentences import advice_lines
from studies.run.batch import stored_outcome
from studies.run.scene_settings import preset_files
from studies.run.stored_run import REPORT
from studies.sensitivity.measurement import CASES
from studies.work.executor import WorkFlags, executor_of, exit_status
from studies.work.study_clock import StudyClock

_PROGRAM = "franbv study mitigations"
_HELP = "Try the remedies for shiny metal over the catalogue: which wins where, and which common advice is wrong."
MITIGATIONS = "mitigations.json"
"""The preset, in the output folder."""
MITIGATIONS_FORMAT = 1
"""Of that file; it rises when cases come to go by other names."""


@dataclass(frozen=True)
class MitigationsCommand:
    """The flags of `franbv study mitigations`."""

    out: Path
    """Output folder. Finished cases in it are not measured again."""
    preset: Annotated[str, tyro.conf.arg(metavar="quick|metals|full|FILE.yaml")] = "quick"
    """What to measure: a preset, or a YAML file of your own."""
    dry_run: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Say how many cases there are and about how long they take, and do nothing."""
    work: Annotated[WorkFlags, tyro.conf.arg(name="")] = field(default_factory=WorkFlags)
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Measure what is missing, then build tables and page from all cases."""
    command = parse(MitigationsCommand, args, _PROGRAM, _HELP)
    preset = MitigationsPreset.named(command.preset)
    cases = mitigation_cases(preset)
    if command.dry_run:
        say(cost_line(command.out, cases))
        return 0
    written = map(command.out.joinpath, (MITIGATIONS, MITIGATIONS_SUMMARY, REPORT, *MITIGATION_TABLES))
    check_not_overwritten(preset_files(command.preset, preset.sensor), written)
    with executor_of(command.work) as executor:  # before anything is written
        prepare_output(command.out)
        write_preset_file(command.out / MITIGATIONS, preset, MITIGATIONS_FORMAT)
        outcome = stored_outcome(command.out / MITIGATIONS_SUMMARY)
        clock = StudyClock.started(command.out, [command.out / CASES], outcome.wall_s)
        failures = measure_cases(command.out, cases, executor, _PROGRAM)
    found, summary = evaluate_mitigations(command.out, preset, cases, failures, clock.elapsed_s())
    clock.stop()
    for line in (found.paragraph, *advice_lines(found.advice), f"Report: {command.out / REPORT}"):
        say(line)
    if command.json:
        say_json({"folder": str(command.out), **summary})
    return exit_status(failures)


def rebuild(out: Path) -> Path:
    """Tables, summary and page from the folder alone; returns the page's path."""
    preset = read_preset_file(out / MITIGATIONS, MitigationsPreset, MITIGATIONS_FORMAT)
    before = stored_outcome(out / MITIGATIONS_SUMMARY)
    evaluate_mitigations(out, preset, mitigation_cases(preset), before.failures, before.wall_s)
    return out / REPORT
