"""What the declared domain of a certificate shows a cell: limits of the signals, and how often they are passed.

It stands in the certificate's file under MONITOR. The limits are learned on one half of the domain's runs, the yes and
no are those of the other half: else the limits would be held against the very runs that they were fitted to.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from jaxtyping import Bool
from pydantic import Field

from materials.input_error import InputError
from studies.base.config import Config, validated
from studies.base.reading import reading
from studies.thresholds.signals import Observed, SignalName

MONITOR = "monitor"
"""Key of a certificate's file."""
MONITOR_FORMAT = 1
"""Of what stands under it; it rises when a signal or a limit means something else."""
LIMIT_QUANTILE = 0.9
"""Of the domain's runs, beyond which a number is unusual [-]. Choice: an event of one run in ten is frequent enough to
be counted in tens of runs, and leaves it room to become more frequent."""
CERTIFICATE_MEND = "give the file of a threshold certificate"


class SignalReference(Config):
    """A signal in the declared domain."""

    limit: float
    """Of the run's number, in its unit; `said_of` tells on which side of it a run says yes."""
    n_learned: Annotated[int, Field(ge=1)]
    """Runs of which it was learned [-]."""
    answers: Annotated[tuple[bool, ...], Field(min_length=1)]
    """Yes or no of each of the other runs."""

    @property
    def n(self) -> int:
        """Answers [-]."""
        return len(self.answers)

    @property
    def n_yes(self) -> int:
        """Of them yes [-]."""
        return sum(self.answers)

    @property
    def array(self) -> Bool[np.ndarray, "n"]:
        """The answers."""
        return np.array(self.answers, bool)


class MonitorReference(Config):
    """The declared domain as a cell sees it; a signal of which it says nothing is absent."""

    version: int = MONITOR_FORMAT
    """MONITOR_FORMAT of who wrote it."""
    quantile: Annotated[float, Field(gt=0.5, lt=1)] = LIMIT_QUANTILE
    """At which the limits stand [-]."""
    signals: Annotated[dict[SignalName, SignalReference], Field(min_length=1)]


NUMBERS: Mapping[SignalName, Callable[[Observed], float | None]] = {
    "recovery_without_gain": lambda run: run.least_gain,
    "invalid_share": lambda run: run.invalid_share,
    "burst_spread": lambda run: run.burst_spread,
}
"""Signal -> the number of a run that is held against its limit."""


def said_of(run: Observed, name: SignalName, limit: float) -> bool | None:
    """Whether the run passes a signal's limit; None where it says nothing of it.

    Recoveries: whether one ended with a Gamma below the limit, or with nothing gained at all, since the limit itself is
    0 where a tenth of the domain's recoveries and more gain nothing; no where there was none. The others: whether the
    number is above the limit.
    """
    number = NUMBERS[name](run)
    if name == "recovery_without_gain":
        return None if run.recoveries is None else number is not None and bool(number < limit or number <= 0)
    return None if number is None else bool(number > limit)


def answers_of(runs: Sequence[Observed], name: SignalName, limit: float) -> tuple[tuple[bool, ...], tuple[int, ...]]:
    """Answers of those runs that say anything, and the number of the run, from 0, that gave each."""
    said = [(answer, k) for k, run in enumerate(runs) if (answer := said_of(run, name, limit)) is not None]
    return tuple(answer for answer, _ in said), tuple(k for _, k in said)


def monitor_reference(runs: Sequence[Observed], seed: int, quantile: float = LIMIT_QUANTILE) -> MonitorReference:
    """The reference that runs of the declared domain give; seed: of their split into halves.

    The limit of recoveries is the low quantile of those runs that had one. Left out is a signal of which a half says
    nothing, and one that could never be passed: a share whose limit is 1. ValueError where none is left.
    """
    order = np.random.default_rng(seed).permutation(len(runs))
    learn, rest = ([runs[k] for k in half] for half in np.array_split(order, 2))
    signals: dict[SignalName, SignalReference] = {}
    for name in NUMBERS:
        found = _signal_reference(name, learn, rest, quantile)
        if found is not None:
            signals[name] = found
    if not signals:
        raise ValueError(f"{len(runs)} runs say nothing that could be watched; give more of them")
    return MonitorReference(quantile=quantile, signals=signals)


def _signal_reference(
    name: SignalName, learn: Sequence[Observed], rest: Sequence[Observed], quantile: float
) -> SignalReference | None:
    numbers = [number for run in learn if (number := NUMBERS[name](run)) is not None]
    if not numbers:
        return None
    limit = float(np.quantile(numbers, 1 - quantile if name == "recovery_without_gain" else quantile))
    answers, _ = answers_of(rest, name, limit)
    if not answers or (name == "invalid_share" and limit >= 1):
        return None
    return SignalReference(limit=limit, n_learned=len(numbers), answers=answers)


def monitor_object(reference: MonitorReference) -> dict[str, Any]:
    """What stands under MONITOR in a certificate's file."""
    return reference.model_dump(mode="json")


def monitor_of(certificate: Any, source: str) -> MonitorReference:
    """The reference in a certificate's contents; InputError where there is none. source: what errors call it."""
    if not isinstance(certificate, dict) or MONITOR not in certificate:
        raise InputError(f"{source}: holds no `{MONITOR}`, so that nothing can be held against it; {CERTIFICATE_MEND}")
    said = certificate[MONITOR]
    if not isinstance(said, dict):
        raise InputError(f"{source}: `{MONITOR}` holds no keys with values; {CERTIFICATE_MEND}")
    if said.get("version") != MONITOR_FORMAT:
        raise InputError(
            f"{source}: `{MONITOR}` has version {said.get('version')}, and this program reads {MONITOR_FORMAT}; "
            "read it with the program that wrote it, or certify anew"
        )
    return validated(MonitorReference, said, f"{source}, {MONITOR}")


def read_monitor(path: Path) -> MonitorReference:
    """The reference of a certificate's file; InputError, one line, for a file that holds none."""
    if not path.is_file():
        raise InputError(f"{path}: no such file; {CERTIFICATE_MEND}")
    with reading(path, CERTIFICATE_MEND):
        certificate = json.loads(path.read_text(encoding="utf-8"))
    return monitor_of(certificate, str(path))
