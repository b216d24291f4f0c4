"""`franbv reconstruct`: a part from the first view to the last, its result and its report."""

from studies.base.console import say, say_json, warn
from studies.base.flags import parse_case_command
from studies.base.single_case import made_once
from studies.run.reconstruct import ReconstructSettings, check_workspace, resolved_run, simulate
from studies.run.run_case import RUN_COMMAND
from studies.run.scene_settings import build_subject
from studies.run.sentences import run_paragraph
from studies.run.stored_run import ACQUISITIONS, CLOUD, FILTERED_CLOUD, REPORT, RUN, TIMINGS, StoredRun

FILES = (REPORT, RUN, ACQUISITIONS, TIMINGS, CLOUD, FILTERED_CLOUD)
"""What the output folder itself shows of the case."""

_HELP = "Reconstruct a part with a next-best-view planner, from the first view until a stop rule ends the run."


def run(args: list[str]) -> int:
    """Reconstruct, unless the finished case is there already; then say what was reached."""
    command = parse_case_command(ReconstructSettings, args, f"franbv {RUN_COMMAND}", _HELP)
    subject = build_subject(command.settings)
    flatness = check_workspace(subject.scene, command.settings.parameters)
    for notice in (*subject.notices, *flatness):
        warn(f"franbv {RUN_COMMAND}: {notice}")
    config = resolved_run(command.settings)
    case, found = made_once(RUN_COMMAND, config, command.out, FILES, lambda folder: simulate(folder, config, subject))
    stored = StoredRun(case)
    say(f"{stored.run['title']}: {run_paragraph(stored.run, stored.timings)}")
    say(f"{'Found' if found else 'Written'}: {case}\nReport: {case / REPORT}")
    if command.json:
        timings = {key: value for key, value in stored.timings.items() if key != "acquisitions"}
        say_json({"folder": str(case), **stored.run["summary"], **timings})
    return 0
