"""`franbv monitor`: recorded or live runs held against the declared domain of a threshold certificate."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from materials.input_error import InputError
from studies.base.console import say, say_json, warn
from studies.base.flags import parse
from studies.thresholds.monitor import MonitoredSignal, monitored
from studies.thresholds.monitor_words import closing_sentence, signal_lines
from studies.thresholds.reference import read_monitor
from studies.thresholds.watched_runs import WatchedRuns, watched_runs

_PROGRAM = "franbv monitor"
_HELP = (
    "Hold what a cell can observe without truth against what the declared domain of a threshold certificate shows: "
    "an alarm with a bound that holds at all times at once, or `still inside`."
)


@dataclass(frozen=True)
class MonitorCommand:
    """The flags of `franbv monitor`."""

    runs: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="RUN...")]
    """Folders of runs, recordings (.mcap, also one that is still being written), or folders that hold many; in the
    order given, by time inside a folder."""
    certificate: Annotated[Path, tyro.conf.arg(metavar="FILE")]
    """The threshold certificate."""
    false_alarms: float = 0.05
    """Probability that runs of the declared domain, however many, ever raise an alarm; shared out over the signals."""
    tolerance: float = 0.05
    """What the share of runs that pass a signal's limit may rise by."""
    fail_on_alarm: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Exit with 1 on an alarm."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Say of every signal how it stands, and of all of them whether the domain is left."""
    command = parse(MonitorCommand, args, _PROGRAM, _HELP)
    _check_flags(command)
    reference = read_monitor(command.certificate)
    found = watched_runs(command.runs)
    for notice in found.notices:
        warn(f"{_PROGRAM}: {notice}")
    observed = [watched.observed for watched in found.runs]
    signals = monitored(reference, observed, command.false_alarms, command.tolerance)
    paths = [watched.path for watched in found.runs]
    for signal in signals:
        say(signal_lines(signal, paths))
    say(closing_sentence(signals, len(paths), command.false_alarms))
    alarm = any(signal.alarm_at is not None for signal in signals)
    if command.json:
        say_json(_figures(signals, found, alarm))
    return int(alarm and command.fail_on_alarm)


def _check_flags(command: MonitorCommand) -> None:
    if not command.runs:
        raise InputError(f"no runs to look at; give folders of runs or recordings; see {_PROGRAM} --help")
    if not 0 < command.false_alarms < 1:
        raise InputError(f"--false-alarms {command.false_alarms:g}: is a probability between 0 and 1; give 0.05")
    if not 0 <= command.tolerance < 1:
        raise InputError(f"--tolerance {command.tolerance:g}: is a rise of a share, from 0 to below 1; give 0.05")


def _figures(signals: tuple[MonitoredSignal, ...], found: WatchedRuns, alarm: bool) -> dict[str, Any]:
    """Runs are counted from 1, as in the words."""
    rows = [
        {
            "name": signal.name,
            "n": len(signal.answers),
            "share": signal.share,
            "lower_bound": signal.lower_bound,
            "limit": signal.watched.limit,
            "alarm_at": None if signal.alarm_at is None else signal.alarm_at + 1,
            "alarm_run": None if signal.alarm_at is None else str(found.runs[signal.alarm_at].path),
            "more_runs_to_notice": signal.more,
            "number_limit": signal.reference.limit,
            "reference_n": signal.reference.n,
            "reference_share": signal.reference.n_yes / signal.reference.n,
        }
        for signal in signals
    ]
    return {"alarm": alarm, "runs": len(found.runs), "signals": rows}
