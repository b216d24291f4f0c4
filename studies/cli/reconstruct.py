"""`franbv reconstruct`: a part from the first view to the last, its result and its report; once or from many starts."""

from materials.input_error import InputError
from studies.base.case_folder import case_digest, finished_case
from studies.base.console import say, say_json, warn
from studies.base.flags import StartsCommand, parse_wider_command
from studies.base.output_errors import prepare_output
from studies.base.single_case import made_once
from studies.cli.report import STUDIES
from studies.run.reconstruct import ReconstructSettings, check_workspace, resolved_run, simulate
from studies.run.run_case import RUN_COMMAND
from studies.run.scene_settings import Subject, build_subject
from studies.run.sentences import run_paragraph
from studies.run.starts.page import rebuild
from studies.run.starts.runs import finished_starts, make_starts, spread_starts, write_starts
from studies.run.starts.summary import starts_json, starts_paragraph
from studies.run.stored_run import ACQUISITIONS, CLOUD, FILTERED_CLOUD, REPORT, RUN, TIMINGS, StoredRun
from studies.run.viewing import shown_in_browser
from studies.work.executor import exit_status

FILES = (REPORT, RUN, ACQUISITIONS, TIMINGS, CLOUD, FILTERED_CLOUD)
"""What the output folder itself shows of the case."""

_PROGRAM = f"franbv {RUN_COMMAND}"
_HELP = "Reconstruct a part with a next-best-view planner, from the first view until a stop rule ends the run."


ReconstructCommand = StartsCommand[ReconstructSettings]
"""The flags of `franbv reconstruct`."""


def run(args: list[str]) -> int:
    """Reconstruct, unless the finished case is there already; then say what was reached."""
    command = parse_wider_command(ReconstructCommand, ReconstructSettings, args, _PROGRAM, _HELP)
    check_starts(command)
    subject = build_subject(command.settings)
    flatness = check_workspace(subject.scene, command.settings.parameters)
    for notice in (*subject.notices, *flatness):
        warn(f"{_PROGRAM}: {notice}")
    return run_once(command, subject) if command.starts == 1 else run_starts(command, subject)


def check_starts(command: ReconstructCommand) -> None:
    """InputError for a number of starts that there cannot be, and for a folder that belongs to something else."""
    if command.starts < 1:
        raise InputError(f"--starts {command.starts}: there must be a run to make; give 1 or more")
    if command.starts > 1 and command.record is not None:
        raise InputError("--record is for one run; leave out --starts, or give each start's command by itself")
    if command.starts > 1 and command.view:
        raise InputError("--view is for one run; leave out --starts, or write a start's file: franbv report CASE --rrd")
    if command.starts == 1 and command.workers is not None:
        raise InputError("--workers is for many starts; give --starts as well, or leave it out")
    for name in STUDIES:
        if command.starts > 1 and (command.out / name).exists():
            raise InputError(f"{command.out}: holds a study ({name}); choose another --out for the starts")


def check_record(command: ReconstructCommand, config: ReconstructSettings) -> None:
    """InputError for a recording that could not be made, before anything is rendered."""
    if command.record is None:
        return
    if command.record.suffix != ".mcap":
        raise InputError(f"--record {command.record}: recordings are MCAP; give a file FILE.mcap")
    if command.record.exists():
        raise InputError(f"{command.record}: is there already, and is never written over; name another file")
    if finished_case(command.out, case_digest(RUN_COMMAND, config)) is not None:
        raise InputError(f"{command.out}: holds this very run already; choose another --out to make and record it")


def check_watchable(command: ReconstructCommand, config: ReconstructSettings) -> None:
    """InputError where there is nothing left to watch."""
    if command.view and finished_case(command.out, case_digest(RUN_COMMAND, config)) is not None:
        raise InputError(
            f"{command.out}: holds this very run already; look at it with franbv report {command.out} --rrd, "
            "or choose another --out"
        )


def run_once(command: ReconstructCommand, subject: Subject) -> int:
    """One run from the start that the settings name."""
    config = resolved_run(command.settings)
    check_record(command, config)
    check_watchable(command, config)
    with shown_in_browser(command.view, subject.title, config.parameters.invalid_share) as view:
        case, found = made_once(
            RUN_COMMAND,
            config,
            command.out,
            FILES,
            lambda folder: simulate(folder, config, subject, record=command.record, view=view),
        )
        stored = StoredRun(case)
        say(f"{stored.run['title']}: {run_paragraph(stored.run, stored.timings)}")
        say(f"{'Found' if found else 'Written'}: {case}\nReport: {case / REPORT}")
        if command.json:
            timings = {key: value for key, value in stored.timings.items() if key != "acquisitions"}
            say_json({"folder": str(case), **stored.run["summary"], **timings})
    return 0


def run_starts(command: ReconstructCommand, subject: Subject) -> int:
    """The starts that are missing, then words and page over all of them; exit status 1 when some were given up."""
    config = resolved_run(command.settings)
    starts = spread_starts(config, command.starts)
    prepare_output(command.out)
    write_starts(command.out, config, command.starts)
    failures = make_starts(command.out, command.settings, starts, command.workers, _PROGRAM)
    finished = finished_starts(command.out, starts)
    report = rebuild(command.out)
    say(f"{subject.title}: {starts_paragraph(finished, command.starts)}\nReport: {report}")
    if command.json:
        figures = starts_json(finished, command.starts)
        say_json({"folder": str(command.out), "report": str(report), "failed": len(failures), **figures})
    return exit_status(failures)
