"""The reconstructions of a study in one folder: what each is told, which are missing, what they share."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from materials.input_error import InputError
from studies.base.case_folder import case_digest, finished_case, writing
from studies.base.reading import reading
from studies.run.reconstruct import ReconstructSettings, check_workspace, simulate
from studies.run.run_case import RUN_COMMAND
from studies.run.scene_settings import SubjectSettings, build_subject
from studies.run.shared_bursts import SharedCaptures
from studies.run.stored_run import StoredRun
from studies.work.executor import Executor, check_alike, reasons_once
from studies.work.maker import Maker
from studies.work.workers import Failure, Job

RUNS = "runs"
"""Folder of the cases; they are those of `franbv reconstruct`."""
CAPTURES = "captures"
"""Folder of the bursts that the runs share; it may be removed when no more runs are to come."""


@dataclass(frozen=True)
class PlannedRun:
    """One reconstruction of a study."""

    part: str
    """Part, or the inside corner."""
    arm: str
    """What the study calls the method: a planner as it is, or what of it is changed."""
    run: int
    """Number of the start; equal numbers start alike."""
    config: ReconstructSettings
    """Resolved."""

    @property
    def digest(self) -> str:
        """Name of the case."""
        return case_digest(RUN_COMMAND, self.config)

    @property
    def title(self) -> str:
        """For people, short enough for a progress display."""
        return f"{self.part} {self.arm}, start {self.run + 1}"


@dataclass(frozen=True)
class RunTask:
    """What a worker is given."""

    out: Path
    config: ReconstructSettings


def jobs(out: Path, runs: Sequence[PlannedRun]) -> list[Job]:
    """What the workers have to do for those runs that are not there yet."""
    first = {planned.digest: planned for planned in reversed(runs)}  # equal runs are one job, in the place of the first
    missing = [run for run in runs if run is first[run.digest] and finished_case(out / RUNS, run.digest) is None]
    return [Job(planned.title, do_run, RunTask(out, planned.config)) for planned in missing]


def make_runs(out: Path, runs: Sequence[PlannedRun], executor: Executor, program: str) -> list[Failure]:
    """Make those that are not there yet; returns those that were given up. Equal runs are made once."""
    missing = jobs(out, runs)
    if missing:
        check_alike(executor, out, [run_maker(case) for run in runs if (case := finished_case(out / RUNS, run.digest))])
    return executor.run([missing], len({run.digest for run in runs}) - len(missing), reasons_once(program))


@dataclass(frozen=True)
class StudyOutcome:
    """How the commands that worked on a study ended."""

    failures: list[Failure]
    """Of the last that came to its end."""
    wall_s: float
    """Of all of them [s]."""


def stored_outcome(summary: Path) -> StudyOutcome:
    """What a study's summary says of it; none if there is no such file yet."""
    if not summary.exists():
        return StudyOutcome([], 0.0)
    with reading(summary, "move it away, and give the study's command again"):
        stored = json.loads(summary.read_text(encoding="utf-8"))
        return StudyOutcome([Failure(**failure) for failure in stored["failures"]], float(stored["wall_s"]))


def run_maker(case: Path) -> tuple[str, Maker]:
    """Name of a finished run, and what made it."""
    return f"run {case.name}", StoredRun(case).run["versions"]


def do_run(task: RunTask) -> None:
    """Reconstruct, unless the finished case is there already."""
    digest = case_digest(RUN_COMMAND, task.config)
    if finished_case(task.out / RUNS, digest):
        return
    subject = build_subject(task.config)
    check_workspace(subject.scene, task.config.parameters)
    with writing(task.out / RUNS, digest) as folder:
        simulate(
            folder, task.config, subject, watched=False, shared=SharedCaptures.of(task.out / CAPTURES, task.config)
        )


def check_runs(runs: Sequence[PlannedRun]) -> None:
    """InputError now for what would fail in every worker, such as an unknown material or too large a part."""
    fields = set(SubjectSettings.model_fields) - {"seed"}
    subjects = {planned.config.model_dump_json(include=fields): planned.config for planned in runs}
    for config in subjects.values():
        check_workspace(build_subject(config).scene, config.parameters)
    if not runs:
        raise InputError("the study has no runs; name parts and planners")
