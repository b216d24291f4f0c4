"""One reconstruction from several starts around the part: which runs they are, what makes them, what the folder holds.

One run says little: a change of 1e-7 in an image lets the views diverge, so another processor gives another run. Each
start is a case of its own, found again by the same command, whatever became of the others.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from materials.input_error import InputError
from studies.base.atomic_file import write_atomically
from studies.base.case_folder import case_digest, finished_case, writing
from studies.base.config import validated
from studies.base.console import strict_json
from studies.base.reading import reading
from studies.run.reconstruct import ReconstructSettings, simulate
from studies.run.run_case import RUN_COMMAND
from studies.run.scene_settings import build_subject
from studies.run.stored_run import StoredRun
from studies.work.executor import WorkFlags, check_alike, executor_of, reasons_once
from studies.work.workers import Failure, Job

STARTS = "starts.json"
"""What the starts in a folder have in common, and how many they are."""
STARTS_FORMAT = 1
"""Of that file; it rises when the starts come to go by other names."""
MEND_STARTS = "give the command again with another --out"
"""What to do where that file is damaged."""


@dataclass(frozen=True)
class Start:
    """One of the runs."""

    number: int
    """From 0."""
    config: ReconstructSettings
    """Resolved, with azimuth and seed of this start."""

    @property
    def digest(self) -> str:
        """Name of the case."""
        return case_digest(RUN_COMMAND, self.config)


@dataclass(frozen=True)
class StartTask:
    """What a worker is given."""

    out: Path
    settings: ReconstructSettings
    """As the user gave them: with the paths of the input files."""
    start: Start


@dataclass(frozen=True)
class FinishedStart:
    """A start and what its run has left."""

    start: Start
    stored: StoredRun

    @property
    def summary(self) -> dict[str, Any]:
        """Of run.json."""
        return self.stored.run["summary"]


def seed_at(root: int, azimuth_deg: float) -> int:
    """Seed of the runs that start at this azimuth."""
    return int(np.random.SeedSequence([root, round(1000 * azimuth_deg)]).generate_state(1)[0])


def spread_starts(config: ReconstructSettings, count: int) -> list[Start]:
    """Start i of n stands at the azimuth of the (resolved) settings plus 360 i / n.

    The seed depends on the azimuth alone, so that more starts take over those of a third as many.
    """
    azimuths = [(config.azimuth_deg + 360.0 * number / count) % 360.0 for number in range(count)]
    return [
        Start(number, config.model_copy(update={"azimuth_deg": azimuth, "seed": seed_at(config.seed, azimuth)}))
        for number, azimuth in enumerate(azimuths)
    ]


def write_starts(out: Path, config: ReconstructSettings, count: int) -> None:
    """Put down what the folder holds; InputError where it holds starts of another reconstruction."""
    if (out / STARTS).exists():
        ours, theirs = (one.model_dump() for one in (config, stored_starts(out)[0]))
        differing = [key for key in ours if ours[key] != theirs[key]]
        if differing:
            raise InputError(
                f"{out / STARTS}: these are starts of a reconstruction with another {', '.join(differing)}; choose "
                "another --out"
            )
    facts = {"format": STARTS_FORMAT, "starts": count, "config": config.model_dump(mode="json")}
    write_atomically(out / STARTS, strict_json(facts, indent=1).encode())


def stored_starts(out: Path) -> tuple[ReconstructSettings, list[Start]]:
    """The (resolved) settings that the folder's starts have in common, and the starts."""
    with reading(out / STARTS, MEND_STARTS):
        facts = json.loads((out / STARTS).read_text(encoding="utf-8"))
        found, config, count = facts.get("format"), facts["config"], int(facts["starts"])
    if found != STARTS_FORMAT:
        raise InputError(
            f"{out / STARTS}: was written by an older or newer version (format {found}, here {STARTS_FORMAT}); "
            f"{MEND_STARTS}"
        )
    settings = validated(ReconstructSettings, config, str(out / STARTS))
    return settings, spread_starts(settings, count)


def finished_starts(out: Path, starts: list[Start]) -> list[FinishedStart]:
    """Those that are there."""
    cases = [(start, finished_case(out, start.digest)) for start in starts]
    return [FinishedStart(start, StoredRun(case)) for start, case in cases if case is not None]


def make_starts(
    out: Path, settings: ReconstructSettings, starts: list[Start], workers: int | None, program: str
) -> list[Failure]:
    """Make those that are not there yet; returns those that were given up."""
    finished = finished_starts(out, starts)
    there = {one.start.number for one in finished}
    jobs = [
        Job(f"start {start.number + 1} of {len(starts)}", make_start, StartTask(out, settings, start))
        for start in starts
        if start.number not in there
    ]
    with executor_of(WorkFlags(workers)) as executor:
        if jobs:
            makers = [(f"start {one.start.number + 1}", one.stored.run["versions"]) for one in finished]
            check_alike(executor, out, makers)
        return executor.run([jobs], len(finished), reasons_once(program))


def make_start(task: StartTask) -> None:
    """Reconstruct, in a worker."""
    with writing(task.out, task.start.digest) as folder:
        simulate(folder, task.start.config, build_subject(task.settings), watched=False)
