"""`franbv replay`: detection and planning on a recording, with no robot; the report of a reconstruction made of it."""

from pathlib import Path
from typing import Any

import tyro

from franbv.adapters.recording.command import REPLAY_FILE
from franbv.adapters.recording.opening import is_ours
from materials.input_error import InputError
from studies.base.case_folder import case_digest, finished_case
from studies.base.config import check_finite, overlaid
from studies.base.console import say, say_json, warn
from studies.base.flags import RecordingCommand, parse
from studies.base.single_case import made_once
from studies.run.recorded_sensor import SENSOR_SECTION, unlike_sensor
from studies.run.recording_errors import recording_errors
from studies.run.replayed import (
    REPLAY_COMMAND,
    ReplaySettings,
    opened_recording,
    recording_title,
    resolved_replay,
    settings_of,
    write_replayed,
)
from studies.run.sentences import replay_words, run_paragraph
from studies.run.stored_run import ACQUISITIONS, CLOUD, FILTERED_CLOUD, REPORT, RUN, TIMINGS, StoredRun
from studies.run.viewing import shown_in_browser

REPLAY_FILES = (REPORT, RUN, REPLAY_FILE, ACQUISITIONS, TIMINGS, CLOUD, FILTERED_CLOUD)
"""What the output folder itself shows of the case."""
_PROGRAM = f"franbv {REPLAY_COMMAND}"
_HELP = "Detect reflective regions and plan on a recording (.mcap, .db3, .bag, a folder of rosbag2), with no robot."


ReplayCommand = RecordingCommand[ReplaySettings]
"""The flags of `franbv replay`."""


def run(args: list[str]) -> int:
    """Replay, unless the finished case is there already; then say how the decisions compare with the recorded ones."""
    command = _parsed(args)
    recording = opened_recording(command.recording, command.settings)
    for notice in recording.notices:
        warn(f"{_PROGRAM}: {notice}")
    unlike = None if command.config is None else unlike_sensor(command.config, recording)
    if unlike is not None:
        warn(f"{_PROGRAM}: {unlike}")
    config = resolved_replay(command.settings, command.recording)
    if command.view and finished_case(command.out, case_digest(REPLAY_COMMAND, config)) is not None:
        raise InputError(
            f"{command.out}: holds this very replay already; look at it with franbv report {command.out} --rrd, "
            "or choose another --out"
        )
    with shown_in_browser(command.view, recording_title(recording), config.parameters.invalid_share) as view:
        case, found = made_once(
            REPLAY_COMMAND,
            config,
            command.out,
            REPLAY_FILES,
            lambda folder: write_replayed(folder, config, recording, view),
        )
        stored = StoredRun(case)
        say(f"{stored.run['title']}: {run_paragraph(stored.run, stored.timings)} {replay_words(stored.run['replay'])}")
        say(f"{'Found' if found else 'Written'}: {case}\nReport: {case / REPORT}")
        if command.json:
            say_json({"folder": str(case), **_figures(stored)})
    return 0


def _parsed(args: list[str]) -> ReplayCommand:
    """The flags over the settings of the recorded run; a recording of ours tells them, be it that of the poses."""
    command = _over(args, ReplaySettings())
    telling = next((path for path in (command.recording, command.settings.poses) if path and _is_ours(path)), None)
    if telling is not None:
        recorded = settings_of(opened_recording(telling, ReplaySettings()))
        command = _over(args, recorded)
    check_finite(command.settings, "the flags")
    return command


def _over(args: list[str], settings: ReplaySettings) -> ReplayCommand:
    """The flags over a file's settings, if one is named, over these; what it says of the sensor is the recording's."""
    command = parse(ReplayCommand, args, _PROGRAM, _HELP, _defaults(settings))
    if command.config is None:
        return command
    return parse(ReplayCommand, args, _PROGRAM, _HELP, _defaults(overlaid(settings, command.config, SENSOR_SECTION)))


def _is_ours(path: Path) -> bool:
    with recording_errors():
        return path.is_file() and is_ours(path)


def _defaults(settings: ReplaySettings) -> ReplayCommand:
    return ReplayCommand(recording=tyro.MISSING, settings=settings, out=tyro.MISSING)


def _figures(stored: StoredRun) -> dict[str, Any]:
    simulated = {"simulated": stored.run["simulated"]["rows"]} if "simulated" in stored.run else {}
    return {**stored.run["replay"], **simulated, "summary": stored.run["summary"]}
