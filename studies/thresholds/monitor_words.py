"""What the monitor found, in words: a line of figures and a plain sentence for each signal, and one for all of them."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from studies.base.numbers_as_text import counted, percent
from studies.thresholds.monitor import MOST_MORE, MonitoredSignal, first_alarm
from studies.thresholds.signals import SignalName

CAUSES: Mapping[SignalName, str] = {
    "recovery_without_gain": "recoveries that gain nothing",
    "invalid_share": "first views in which much of the object is missing",
    "burst_spread": "first bursts whose depth flickers",
}
"""Signal -> what has become more frequent when it raises an alarm."""
MENDS: Mapping[SignalName, str] = {
    "recovery_without_gain": "look at the last runs' recoveries: the parts may shine otherwise than those that were "
    "declared, or stand where no other angle helps",
    "invalid_share": "look at the last first views: the parts may be shinier, or larger than the view, the projector "
    "may be weak, or nothing may stand in the cell",
    "burst_spread": "look at camera, projector and light: the pattern may be weak or out of focus, or other light "
    "falls on the part",
}
"""Signal -> what to look at then."""


def signal_lines(signal: MonitoredSignal, paths: Sequence[Path]) -> str:
    """A line of figures and a sentence. paths: of the runs."""
    if signal.share is None:
        figures = f"{signal.name}: seen in no run yet"
    else:
        figures = f"{signal.name}: seen n {len(signal.answers)}, share {percent(signal.share)}"
    figures += f", limit {percent(signal.watched.limit)}, lower bound {percent(signal.lower_bound)}"
    return f"{figures}\n  {_sentence(signal, paths)}"


def closing_sentence(signals: Sequence[MonitoredSignal], n_runs: int, false_alarms: float) -> str:
    """Whether the declared domain is left."""
    alarm = first_alarm(signals)
    if n_runs == 0:
        return "No run says anything yet."
    if alarm is None:
        return f"Still inside after {counted(n_runs, 'run')}: nothing shows that the declared domain is left."
    assert alarm.alarm_at is not None
    return (
        f"ALARM at run {alarm.alarm_at + 1} of {n_runs}: the declared domain is left (wrong with probability "
        f"{percent(false_alarms)} at most); the certificate says nothing of these runs. Mend the cell, or certify anew "
        "with a domain that holds its parts."
    )


def _sentence(signal: MonitoredSignal, paths: Sequence[Path]) -> str:
    reference = signal.reference
    usual = f"{percent(reference.n_yes / reference.n)} of {counted(reference.n, 'run')} of the declared domain"
    if signal.alarm_at is not None:
        return (
            f"Alarm at run {signal.alarm_at + 1} ({paths[signal.alarm_at]}), because {CAUSES[signal.name]} are more "
            f"frequent than in {usual}, by more than chance and the tolerance; {MENDS[signal.name]}."
        )
    if not signal.can_alarm:
        return f"Can never raise an alarm: from {usual} up no share is known to be larger; certify with more runs."
    if signal.more is None:
        return f"Still inside ({usual}); even a complete change would not be noticed within {MOST_MORE} further runs."
    further = counted(signal.more, "further run")
    return f"Still inside ({usual}); a complete change would be noticed after {further} that all show it."
