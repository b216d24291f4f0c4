"""The runs that a cell has made, in their order: folders of finished runs, recordings, folders that hold many.

A run counts once, however often it was kept: recordings that go on where another ends, a folder and the recording of
the same run, a `latest` that was copied. Noise never repeats, so that equal first bursts are one burst.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from franbv.adapters.recording.contents import NothingRecordedError
from franbv.adapters.recording.opening import is_ours, open_recording
from materials.input_error import InputError
from studies.base.atomic_file import DIGEST_BYTES
from studies.run.recording_errors import recording_errors
from studies.run.stored_run import RUN, StoredRun, is_case
from studies.thresholds.signals import Observed, observed_of_recording, observed_of_stored

RECORDED = ".mcap"
REPLAYED = "replay"
"""`command` of a case that is no run of its own: `studies.run.replayed.REPLAY_COMMAND`, which comes with a renderer."""


@dataclass(frozen=True)
class WatchedRun:
    """A run, and what a cell can tell of it."""

    path: Path
    observed: Observed
    taken_ns: int
    """When its first frame was taken by the recording's clock; of a folder, when it was finished by the disk's [ns]."""
    burst: str | None
    """Hash of its first burst; None where that was not kept."""


@dataclass(frozen=True)
class WatchedRuns:
    """What was found."""

    runs: tuple[WatchedRun, ...]
    """In the order given, by time inside a folder."""
    notices: tuple[str, ...]
    """One line for each path that does not count, and why."""


def watched_runs(paths: Sequence[Path]) -> WatchedRuns:
    """The runs at these paths; InputError for a path where there is none, and for one that cannot be read."""
    runs: dict[str, WatchedRun] = {}
    notices: list[str] = []
    for path in paths:
        for run in _runs_at(path, notices):
            key = run.burst or str(run.path.resolve())
            before = runs.get(key)
            if before is not None:
                notices.append(f"{run.path}: is the same run as {before.path}, and counts once")
            runs[key] = run if before is None or before.observed.recoveries is None else before
    return WatchedRuns(tuple(runs.values()), tuple(notices))


def _runs_at(path: Path, notices: list[str]) -> list[WatchedRun]:
    if not path.exists():
        raise InputError(f"{path}: no such file or folder; give runs, recordings, or folders of them")
    if path.is_file():
        found = [_recorded(path, notices)]
    elif is_case(path):
        found = [_stored(path, notices)]
    else:
        found = _below(path, notices)
    return [run for run in found if run is not None]


def _below(folder: Path, notices: list[str]) -> list[WatchedRun]:
    """All runs below a folder, by time, what is unfinished or hidden left out."""
    shown = [path for path in sorted(folder.rglob("*")) if not _is_hidden(path.relative_to(folder))]
    cases = [path.parent for path in shown if path.name == RUN and is_case(path.parent)]
    recordings = [path for path in shown if path.suffix == RECORDED and path.is_file()]
    if not cases and not recordings:
        raise InputError(f"{folder}: holds neither a finished run (no {RUN}) nor a recording ({RECORDED}); give runs")
    found = [*(_stored(path, notices) for path in cases), *(_recorded(path, notices) for path in recordings)]
    return sorted((run for run in found if run is not None), key=lambda run: (run.taken_ns, run.path))


def _is_hidden(path: Path) -> bool:
    return any(part.startswith(".") for part in path.parts)


def _stored(case: Path, notices: list[str]) -> WatchedRun | None:
    stored = StoredRun(case)
    if stored.run.get("command") == REPLAYED:
        notices.append(f"{case}: is a replay and no run; its recording counts, where it is given")
        return None
    depths = stored.depths(0)
    taken_ns = (case / RUN).stat().st_mtime_ns
    return WatchedRun(case, observed_of_stored(stored), taken_ns, None if depths is None else _hash(depths))


def _recorded(path: Path, notices: list[str]) -> WatchedRun | None:
    """The run of a recording, be it one that is still written; None as long as no burst of it is whole."""
    with recording_errors():
        if path.suffix != RECORDED or not is_ours(path):
            raise InputError(f"{path}: is no recording of franbv; give a file {RECORDED} of a run, or its folder")
        try:
            recording = open_recording(path)
        except NothingRecordedError:
            notices.append(f"{path}: holds no whole burst yet, and says nothing")
            return None
        first = recording.bursts[0]
        return WatchedRun(path, observed_of_recording(recording), min(first.times_ns), _hash(first.read().depths))


def _hash(depths: np.ndarray) -> str:
    return hashlib.blake2b(np.ascontiguousarray(depths).tobytes(), digest_size=DIGEST_BYTES).hexdigest()
