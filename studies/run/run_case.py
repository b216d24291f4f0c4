"""Runs the loop with any camera and arm, and writes everything that a reconstruction leaves."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import Field, model_validator

from franbv.acquisition import Acquisition, Reconstruction
from franbv.adapters.recording.watched import Watch
from franbv.adapters.view.sight import ViewSink
from franbv.evaluation.reference import Reference
from franbv.known_planners import PlannerName
from franbv.parameters import Parameters
from franbv.reconstruction import reconstruct
from franbv.sensing import Arm
from studies.base.atomic_file import write_atomically
from studies.base.case_folder import case_digest
from studies.base.config import Config
from studies.base.console import progress_bar, strict_json
from studies.base.numbers_as_text import percent
from studies.run.ablation import Ablation, build_planner
from studies.run.acquisition_table import ACQUISITION_COLUMNS, MAP_COVERAGE
from studies.run.bursts import KeptCaptures, stored_infrared
from studies.run.recorder import RunRecorder, cloud_owner, run_summary, surface_arrays, timing_figures
from studies.run.report.page import write_report
from studies.run.stored_run import ACQUISITIONS, CLOUD, FILTERED_CLOUD, RUN, RUN_FORMAT, SURFACE, TIMINGS
from studies.store.ply import write_ply
from studies.store.tables import write_rows
from studies.store.views import write_arrays, write_view
from studies.work.maker import versions

RUN_COMMAND = "reconstruct"
"""What the case's name and its `run.json` call it."""


class RunSettings(Config):
    """What decides a run, apart from what stands before the camera."""

    planner: PlannerName = "fra"
    """fra: FRA-NBV as in the paper. pb: PB-NBV, the same without recovery of reflective regions. re: ray-cast entropy.
    random: any reachable candidate."""
    azimuth_deg: Annotated[float, Field(ge=-360, le=360)] = 0.0
    """Where the first view stands [deg]; run i of n starts at 360 i / n."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Root seed of all randomness, the sensor's noise and the planner's choices."""
    parameters: Parameters = Parameters()
    """Of the method, as in the paper's table where that has them."""
    ablation: Ablation = Ablation()
    """What of it is changed."""

    @model_validator(mode="after")
    def _fitting(self) -> "RunSettings":
        misfit = self.ablation.misfit(self.planner)
        if misfit:
            raise ValueError(misfit)
        return self


AnyRun = TypeVar("AnyRun", bound=RunSettings)


def ablated(settings: AnyRun) -> AnyRun:
    """The settings with the ablation in the parameters where it belongs there: equal runs have equal settings."""
    parameters = settings.ablation.changed(settings.parameters)
    return settings.model_copy(update={"parameters": parameters, "ablation": settings.ablation.of_functions()})


def write_run(
    folder: Path,
    config: RunSettings,
    title: str,
    captures: KeptCaptures,
    arm: Arm,
    reference: Reference | None,
    watched: bool = True,
    watch: Watch | None = None,
    view: ViewSink | None = None,
) -> None:
    """Run the loop and write its result, its timings and its report into the case's folder.

    config: as `ablated` gives it.
    reference: the true surface; None where nobody knows it.
    watched: whether to show a progress display of this run.
    watch, view: what records and what shows the run, if anything does.
    """
    recorder = RunRecorder(reference, config.parameters)
    result = _observed_run(folder, config, captures, arm, recorder, watched, watch, view)
    write_result(folder, config, title, result, reference, recorder)
    times = [
        {"sensing": sensing, **acquisition.planning_s}
        for sensing, acquisition in zip(captures.sensing_s, result.acquisitions, strict=True)
    ]
    timings = {**timing_figures(times, captures.elapsed_s, captures.processor_s), "acquisitions": times}
    write_atomically(folder / TIMINGS, strict_json(timings, indent=1).encode())
    write_report(folder)
    captures.drop_times()


def write_result(
    folder: Path,
    config: RunSettings,
    title: str,
    result: Reconstruction,
    reference: Reference | None,
    recorder: RunRecorder,
    command: str = RUN_COMMAND,
    more: Mapping[str, Any] | None = None,
) -> None:
    """Write everything that two runs of one configuration have in common, byte for byte.

    command: that makes such cases; more: further facts for `run.json`.
    """
    owner, past = cloud_owner(result), recorder.history()
    write_ply(folder / CLOUD, result.cloud, owner)
    write_ply(folder / FILTERED_CLOUD, result.cloud[result.is_mapped], owner[result.is_mapped])
    write_arrays(folder / SURFACE, surface_arrays(reference, recorder))
    write_rows(folder / ACQUISITIONS, ACQUISITION_COLUMNS, recorder.rows)
    facts: dict[str, Any] = {
        "format": RUN_FORMAT,
        "command": command,
        "case": case_digest(command, config),
        "title": title,
        "config": config.model_dump(mode="json"),
        "versions": versions(),
        "surface_points": 0 if reference is None else len(reference.points),
        "summary": run_summary(result, past, reference),
        **(more or {}),
    }
    write_atomically(folder / RUN, strict_json(facts, indent=1).encode())


def _observed_run(
    folder: Path,
    config: RunSettings,
    captures: KeptCaptures,
    arm: Arm,
    recorder: RunRecorder,
    watched: bool,
    watch: Watch | None,
    view: ViewSink | None,
) -> Reconstruction:
    """Run the loop under a progress display; record and show it, if it is to be."""
    with progress_bar(watched) as progress:
        task = progress.add_task("first view", total=config.parameters.max_iterations)

        def observe(acquisition: Acquisition) -> None:
            write_view(folder, acquisition.index, recorder.observe(acquisition))
            if watch is not None:
                watch.observe(acquisition)
            if view is not None:
                coverage = recorder.rows[-1][MAP_COVERAGE]
                view.observe(acquisition, coverage, stored_infrared(folder, acquisition.index))
            covered = percent(recorder.rows[-1][MAP_COVERAGE])
            progress.update(
                task,
                completed=acquisition.nbv_iteration,
                description=f"acquisition {acquisition.index + 1}, coverage {covered}, NBV iteration",
            )

        planner = build_planner(config.planner, config.ablation)
        camera = captures if watch is None else watch.camera(captures)
        arm = arm if watch is None else watch.arm(arm)
        run = reconstruct(camera, arm, planner, config.parameters, config.seed, config.azimuth_deg, observe)
        if watch is not None:
            watch.stop(run.stop)
        return run
