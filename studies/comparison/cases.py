"""The runs of a comparison: every arm of it on every part, all arms from the same starts with the same noise."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from materials.input_error import InputError
from studies.base.case_folder import case_digest, finished_case, writing
from studies.comparison.links import LINKED_PLANNERS, LINKS, LinkChange, arm_name
from studies.comparison.preset import CORNER, ComparisonPreset
from studies.run.ablation import ABLATIONS, Ablation
from studies.run.reconstruct import ReconstructSettings, check_workspace, resolved_run, simulate
from studies.run.run_case import RUN_COMMAND
from studies.run.scene_settings import SubjectSettings, build_subject
from studies.run.shared_bursts import SharedCaptures
from studies.run.starts.runs import seed_at
from studies.work.workers import Job

RUNS = "runs"
"""Folder of the cases; they are those of `franbv reconstruct`."""
CAPTURES = "captures"
"""Folder of the bursts that the runs share; it may be removed when no more runs are to come."""


@dataclass(frozen=True)
class PlannedRun:
    """One reconstruction of the comparison."""

    part: str
    """Part, or the inside corner."""
    arm: str
    """Planner as it is, name of an ablation, or planner and changed link."""
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


def planned_runs(preset: ComparisonPreset) -> list[PlannedRun]:
    """All runs; all arms of the first start before the second start, so that a stopped study is a smaller one.

    Of a start, one arm after the other goes over the parts: neighbours in the list, which are made at the same time,
    have no burst in common, while later arms find those of earlier ones.
    """
    arms = [
        *preset.planners,
        *preset.ablations,
        *(arm_name(planner, link) for link in preset.links for planner in LINKED_PLANNERS),
    ]
    planned = [*_of_planners(preset), *_of_ablations(preset), *_of_links(preset)]
    return sorted(planned, key=lambda planned: (planned.run, arms.index(planned.arm)))


def _of_planners(preset: ComparisonPreset) -> Iterator[PlannedRun]:
    for part in [*preset.parts, *([CORNER] if preset.corner else [])]:
        for planner in preset.planners:
            for run in preset.start_numbers:
                yield PlannedRun(part, planner, run, run_settings(preset, part, planner, run, Ablation()))


def _of_ablations(preset: ComparisonPreset) -> Iterator[PlannedRun]:
    for part in preset.ablated_parts:
        for name in preset.ablations:
            for run in preset.changed_start_numbers:
                _, planner, change = ABLATIONS[name]
                yield PlannedRun(part, name, run, run_settings(preset, part, planner, run, change))


def _of_links(preset: ComparisonPreset) -> Iterator[PlannedRun]:
    for part in preset.ablated_parts:
        for link in preset.links:
            for planner in LINKED_PLANNERS:
                for run in preset.changed_start_numbers:
                    plain, config = (
                        run_settings(preset, part, planner, run, Ablation(), change) for change in (None, LINKS[link])
                    )
                    if config != plain:  # the study may stand at what the link changes to
                        yield PlannedRun(part, arm_name(planner, link), run, config)


def run_settings(
    preset: ComparisonPreset, part: str, planner: str, run: int, ablation: Ablation, link: LinkChange | None = None
) -> ReconstructSettings:
    """What `franbv reconstruct` would be told for this run.

    The start and the seed depend on the azimuth alone, so that a comparison with more runs takes over those of one with
    fewer of the same starts.
    """
    azimuth = 360.0 * run / preset.starts
    settings = ReconstructSettings(
        part=part,
        material=(preset.corner,) if part == CORNER and preset.corner else (),
        bench=preset.bench,
        lamps=preset.lamps,
        sensor=preset.sensor,
        planner=planner,
        azimuth_deg=azimuth,
        seed=seed_at(preset.seed, azimuth),
        parameters=preset.parameters,
        ablation=ablation,
    )
    return resolved_run(link.changed(settings) if link else settings)


def jobs(out: Path, runs: list[PlannedRun]) -> list[Job]:
    """What the workers have to do for those runs that are not there yet."""
    missing = [planned for planned in runs if finished_case(out / RUNS, planned.digest) is None]
    return [Job(planned.title, do_run, RunTask(out, planned.config)) for planned in missing]


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


def check_runs(runs: list[PlannedRun]) -> None:
    """InputError now for what would fail in every worker, such as an unknown material or too large a part."""
    fields = set(SubjectSettings.model_fields) - {"seed"}
    subjects = {planned.config.model_dump_json(include=fields): planned.config for planned in runs}
    for config in subjects.values():
        check_workspace(build_subject(config).scene, config.parameters)
    if not runs:
        raise InputError("the comparison has no runs; name parts and planners")
