"""Runs held against a certificate's reference, signal by signal: an alarm with a bound that holds at all times at once.

The probability of a false alarm is shared out evenly over the signals, so that it holds for all of them together.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from studies.thresholds.reference import MonitorReference, SignalReference, answers_of
from studies.thresholds.risk_control import Watched, watched
from studies.thresholds.signals import Observed, SignalName

MOST_MORE = 1024
"""Further runs that are looked ahead [-]. Choice: what needs more is noticed by nobody."""


@dataclass(frozen=True, eq=False)
class MonitoredSignal:
    """One signal of a row of runs."""

    name: SignalName
    reference: SignalReference
    answers: tuple[bool, ...]
    """Of the runs that say anything, in their order."""
    of_runs: tuple[int, ...]
    """Number of the run that gave each, from 0."""
    watched: Watched
    """The answers against those of the reference."""
    more: int | None
    """Further runs, all of which say yes, that raise the alarm [-]; None: more than MOST_MORE, or there is one."""

    @property
    def share(self) -> float | None:
        """Of the answers that are yes [-]; None as long as there is none."""
        return sum(self.answers) / len(self.answers) if self.answers else None

    @property
    def lower_bound(self) -> float:
        """Of that share in the long run, so far [-]; 0 as long as there is no answer."""
        return max(0.0, float(self.watched.lower_bounds[-1])) if self.answers else 0.0

    @property
    def alarm_at(self) -> int | None:
        """Number of the run, from 0, at which the domain is known to be left; None = still inside."""
        return None if self.watched.alarm is None else self.of_runs[self.watched.alarm]

    @property
    def can_alarm(self) -> bool:
        """Whether the reference leaves room for an alarm: a share is never above 1."""
        return self.watched.limit < 1


def monitored(
    reference: MonitorReference, runs: Sequence[Observed], false_alarms: float, tolerance: float
) -> tuple[MonitoredSignal, ...]:
    """Every signal of the reference. runs: in the order in which they were made.

    false_alarms: probability that runs of the declared domain, however many, ever raise any alarm; tolerance: what a
    signal's share may rise by [-].
    """
    heard = listened(reference, runs, false_alarms, tolerance)
    each = false_alarms / len(reference.signals)
    return tuple(_looked_ahead(one, each, tolerance) for one in heard)


def listened(
    reference: MonitorReference, runs: Sequence[Observed], false_alarms: float, tolerance: float
) -> tuple[MonitoredSignal, ...]:
    """The same without looking ahead: `more` is None."""
    each = false_alarms / len(reference.signals)
    found = []
    for name, signal in reference.signals.items():
        answers, of_runs = answers_of(runs, name, signal.limit)
        held = watched(signal.array, np.array(answers, bool), each, tolerance)
        found.append(MonitoredSignal(name, signal, answers, of_runs, held, None))
    return tuple(found)


def first_alarm(signals: Sequence[MonitoredSignal]) -> MonitoredSignal | None:
    """The signal that raised an alarm first."""
    raised = [(signal.alarm_at, k) for k, signal in enumerate(signals) if signal.alarm_at is not None]
    return signals[min(raised)[1]] if raised else None


def runs_to_notice(
    reference: SignalReference, answers: Sequence[bool], false_alarms: float, tolerance: float
) -> int | None:
    """Further runs, all of which say yes, until an alarm [-]; None if MOST_MORE are not enough.

    false_alarms: of this signal.
    """
    more = 32  # doubled, since what is far off takes long to look at
    while more <= MOST_MORE:
        stream = np.array([*answers, *[True] * more], bool)
        alarm = watched(reference.array, stream, false_alarms, tolerance).alarm
        if alarm is not None:
            return max(0, alarm + 1 - len(answers))
        more *= 2
    return None


def _looked_ahead(signal: MonitoredSignal, false_alarms: float, tolerance: float) -> MonitoredSignal:
    """With the further runs that would raise the alarm, where there is none and there may be one."""
    if signal.alarm_at is not None or not signal.can_alarm:
        return signal
    return replace(signal, more=runs_to_notice(signal.reference, signal.answers, false_alarms, tolerance))
