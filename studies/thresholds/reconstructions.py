"""Drawn scenes reconstructed with the settings that go that far: cases of `franbv reconstruct`, kept in `runs`."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from franbv.parameters import Parameters
from studies.base.case_folder import case_digest, finished_case, writing
from studies.run.acquisition_table import MAP_COVERAGE
from studies.run.batch import CAPTURES, RUNS
from studies.run.reconstruct import ReconstructSettings, check_workspace, resolved_run, simulate
from studies.run.run_case import RUN_COMMAND
from studies.run.scene_settings import build_subject
from studies.run.shared_bursts import SharedCaptures
from studies.run.stored_run import StoredRun
from studies.thresholds.config import Domain
from studies.thresholds.draw import run_draw, run_settings


@dataclass(frozen=True)
class RunTask:
    """A reconstruction to be made."""

    out: Path
    """The study's folder."""
    settings: ReconstructSettings
    """As a command would be given them: files by path."""
    title: str
    """For people, short enough for a progress display."""

    @property
    def config(self) -> ReconstructSettings:
        """What decides the case."""
        return resolved_run(self.settings)

    @property
    def case(self) -> Path | None:
        """The finished case; None = not made yet."""
        return finished_case(self.out / RUNS, case_digest(RUN_COMMAND, self.config))


def run_task(out: Path, domain: Domain, seed: int, number: int, parameters: Parameters, setting: int) -> RunTask:
    """Reconstruction number `number` under a setting; all settings get the same scene, start and noise."""
    settings = run_settings(domain, run_draw(domain, seed, number), parameters)
    return RunTask(out, settings, f"reconstruction {number}, setting {setting}")


def do_run(task: RunTask) -> None:
    """For a worker: reconstruct, unless the finished case is there."""
    if task.case is not None:
        return
    config, subject = task.config, build_subject(task.settings)
    check_workspace(subject.scene, config.parameters)
    with writing(task.out / RUNS, case_digest(RUN_COMMAND, config)) as folder:
        shared = SharedCaptures.of(task.out / CAPTURES, config)
        simulate(folder, config, subject, watched=False, shared=shared)


def run_scores(case: Path) -> Float[np.ndarray, "2"]:
    """Of a finished case: the numbers of RUN_RISKS."""
    rows = StoredRun(case).rows
    return np.array([1 - rows[-1][MAP_COVERAGE], len(rows)], float)
