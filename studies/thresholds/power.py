"""How often and how soon the monitor raises an alarm, by simulation: what a reference is good for."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from studies.thresholds.monitor import first_alarm, listened
from studies.thresholds.reference import MonitorReference
from studies.thresholds.signals import Observed

N_STREAMS = 200
"""Choice: a share of 0.05 is then known to 0.015, its standard error."""


@dataclass(frozen=True)
class MonitorPower:
    """Shares of streams that raised an alarm, and when."""

    false_alarms: float
    """Of the streams of runs inside the domain [-]."""
    alarms: float
    """Of the streams whose runs leave the domain, at or after the change [-]."""
    median_delay: float | None
    """Runs from the change until the alarm, the run that raises it included, in the middle of those streams [-]; None
    where half of them or fewer raised one."""
    n_streams: int
    """Of each kind."""


def power(
    reference: MonitorReference,
    inside: Sequence[Observed],
    outside: Sequence[Observed],
    length: int,
    false_alarms: float,
    tolerance: float,
    seed: int,
    change_at: int = 0,
    n_streams: int = N_STREAMS,
) -> MonitorPower:
    """Draw streams with replacement and watch them.

    inside, outside: runs of the declared domain, and of what it becomes; those inside should not be those that made
    the reference. length: runs of a stream [-]; false_alarms, tolerance: as the command has them; change_at: runs of a
    stream that leaves the domain which are inside still, before those outside [-].
    """
    if not 0 <= change_at < length:
        raise ValueError(f"a change after {change_at} of {length} runs is none; let it come before the stream's end")
    rng = np.random.default_rng(seed)
    quiet, delays = 0, []
    for _ in range(n_streams):
        quiet += _alarm(reference, _drawn(inside, length, rng), false_alarms, tolerance) is None
        changed = _drawn(inside, change_at, rng) + _drawn(outside, length - change_at, rng)
        alarm = _alarm(reference, changed, false_alarms, tolerance)
        delays.append(np.inf if alarm is None or alarm < change_at else alarm + 1 - change_at)
    raised, middle = np.isfinite(delays), float(np.median(delays))
    return MonitorPower(1 - quiet / n_streams, float(raised.mean()), middle if np.isfinite(middle) else None, n_streams)


def _drawn(runs: Sequence[Observed], count: int, rng: np.random.Generator) -> list[Observed]:
    return [runs[k] for k in rng.integers(len(runs), size=count)] if count else []


def _alarm(reference: MonitorReference, runs: Sequence[Observed], false_alarms: float, tolerance: float) -> int | None:
    """Number of the run at which the first alarm is raised."""
    first = first_alarm(listened(reference, runs, false_alarms, tolerance))
    return None if first is None else first.alarm_at
