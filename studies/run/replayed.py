"""A replayed recording as a case: what a reconstruction leaves where nobody has told the true surface."""

import time
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from jaxtyping import UInt16
from pydantic import Field

from franbv.acquisition import Acquisition
from franbv.adapters.recording.bags.choices import BagChoices, Reduce
from franbv.adapters.recording.command import recorded_parameters, replay_figures, write_replay
from franbv.adapters.recording.contents import Recording
from franbv.adapters.recording.opening import open_recording
from franbv.adapters.recording.replay import Replay, replay
from franbv.adapters.view.sight import ViewSink
from franbv.frames import Intrinsics, block_centre_intrinsics
from franbv.known_planners import PLANNERS
from franbv.parameters import Positive
from materials.input_error import InputError
from render.depth.decimation import crop_centre, decimate
from studies.base.atomic_file import file_digest, folder_digest, write_atomically
from studies.base.config import validated
from studies.base.console import strict_json
from studies.run.ablation import Ablation, build_planner
from studies.run.bursts import infrared_path
from studies.run.real_and_simulated import Twin, scene_digests
from studies.run.recorded_sensor import sensor_fields
from studies.run.recorder import RunRecorder, timing_figures
from studies.run.recording_errors import recording_errors
from studies.run.report.page import write_report
from studies.run.run_case import RunSettings, ablated, write_result
from studies.run.stored_run import TIMINGS
from studies.store.images import write_png
from studies.store.views import write_view

REPLAY_COMMAND = "replay"
"""What the case's name and its `run.json` call it."""


class ReplaySettings(RunSettings):
    """What decides a replay. The defaults are those of the recorded run."""

    decimation: Annotated[int, Field(ge=1, le=8), tyro.conf.arg(metavar="1..8")] = 1
    """Recordings of others: factor of librealsense's decimation filter, 1 = as recorded."""
    crop: tuple[int, int] | None = None
    """Recordings of others: width and height of the middle part that is kept after decimation; None = all."""
    poses: Path | None = None
    """Recordings of others: where the camera stood, a file with lines `time[s] x y z qx qy qz qw`, or our recording
    of the same run, which then says what was decided as well."""
    depth_topic: str | None = None
    """Recordings of others: the depth images, where there are several."""
    pose_topic: str | None = None
    """Recordings of others: the camera's poses, where there are several."""
    world_frame: str | None = None
    """Recordings of others: frame of the transforms in which the table is z = 0; None = their root."""
    min_z: Positive | None = None
    """Recordings of others: smallest depth that the camera measures [m], where the file does not say it."""
    simulate: Annotated[Path | None, tyro.conf.arg(metavar="SCENE.yaml")] = None
    """YAML file with part, materials, bench and lamps, as `franbv frame --config` takes it: renders the recorded poses
    and sets real and simulated holes and false depth side by side."""
    digests: Annotated[dict[str, str], tyro.conf.Suppress] = Field(default_factory=dict)
    """Filled in: hashes of the files."""


def opened_recording(path: Path, settings: ReplaySettings) -> Recording:
    """The recording, as the settings want it read; InputError for what is wrong with it."""
    choices = BagChoices(
        n_frames=settings.parameters.n_frames,
        depth_topic=settings.depth_topic,
        pose_topic=settings.pose_topic,
        world_frame=settings.world_frame,
        poses=settings.poses,
        min_z=settings.min_z,
        reduced=_reduction(settings),
    )
    with recording_errors():
        return open_recording(path, choices)


def settings_of(recording: Recording) -> ReplaySettings:
    """Those of the recorded run; InputError where this version does not know them."""
    run = recording.run
    if run.planner is None:
        return ReplaySettings()
    if run.planner not in PLANNERS:
        raise InputError(f"{recording.path}: was planned by {run.planner}, which this version does not know")
    with recording_errors():
        parameters = recorded_parameters(recording)
    said = {"planner": run.planner, "azimuth_deg": run.azimuth_deg, "seed": run.seed}
    ablation = validated(Ablation, dict(run.ablation), f"{recording.path}, ablation")
    return ReplaySettings(**said, parameters=parameters, ablation=ablation)


def resolved_replay(settings: ReplaySettings, path: Path) -> ReplaySettings:
    """The settings that decide the result: with the content of the files, and the ablation where it belongs."""
    files = {"recording": path} | ({"poses": settings.poses} if settings.poses else {})
    digests = {name: _content_digest(file) for name, file in files.items()}
    if settings.simulate is not None:
        digests |= scene_digests(settings.simulate)
    return ablated(settings).model_copy(update={"digests": digests})


def _content_digest(path: Path) -> str:
    """Of a file, or of the folder that a rosbag2 is; InputError where something in it cannot be read."""
    try:
        return folder_digest(path) if path.is_dir() else file_digest(path)
    except OSError as error:
        raise InputError(
            f"{error.filename or path}: cannot be read ({error.strerror or error}); check its permissions"
        ) from error


def write_replayed(folder: Path, config: ReplaySettings, recording: Recording, view: ViewSink | None = None) -> None:
    """Replay, and fill the case's folder; InputError where the recording cannot be used.

    view: what shows the replay.
    """
    began, processor = time.perf_counter(), time.process_time()
    recorder, times = RunRecorder(None, config.parameters), []
    twin = Twin.of(config.simulate, recording, config.decimation, config.crop) if config.simulate else None

    def observe(acquisition: Acquisition) -> None:
        write_view(folder, acquisition.index, recorder.observe(acquisition))
        times.append({"sensing": acquisition.sensing_s, **acquisition.planning_s})
        if view is not None:
            view.observe(acquisition)

    with recording_errors():
        planner = build_planner(config.planner, config.ablation)
        found = replay(recording, planner, config.parameters, config.seed, config.azimuth_deg, observe)
        write_replay(folder, found)
        _write_infrared(folder, recording, found, view)
    title = recording_title(recording)
    more = {"replay": replay_figures(found), "recorded_sensor": sensor_fields(recording)}
    if twin is not None:
        rows = twin.figures(found.run.acquisitions)
        more["simulated"] = {"scene": twin.settings.model_dump(mode="json"), "rows": rows}
    write_result(folder, config, title, found.run, None, recorder, REPLAY_COMMAND, more)
    elapsed = time.perf_counter() - began, time.process_time() - processor
    timings = {**timing_figures(times, *elapsed), "acquisitions": times}
    write_atomically(folder / TIMINGS, strict_json(timings, indent=1).encode())
    write_report(folder)


def recording_title(recording: Recording) -> str:
    """What the recorded run is called; the file's name where it has no title."""
    return recording.run.title or recording.path.stem


def _write_infrared(folder: Path, recording: Recording, found: Replay, view: ViewSink | None) -> None:
    for acquisition, number in zip(found.run.acquisitions, found.bursts, strict=True):
        image = recording.bursts[number].read_infrared()
        if image is not None:
            path = infrared_path(folder, acquisition.index)
            path.parent.mkdir(exist_ok=True)
            write_png(path, image)
            if view is not None:
                view.infrared(acquisition.index, image)


def _reduction(settings: ReplaySettings) -> Reduce | None:
    """librealsense's decimation and the crop that makes the paper's sensor."""
    if settings.decimation == 1 and settings.crop is None:
        return None

    def reduced(
        frames: UInt16[np.ndarray, "n h w"], intrinsics: Intrinsics
    ) -> tuple[UInt16[np.ndarray, "n h2 w2"], Intrinsics]:
        if settings.decimation > 1:
            frames = decimate(frames, settings.decimation)
            intrinsics = block_centre_intrinsics(intrinsics, settings.decimation)
        return (frames, intrinsics) if settings.crop is None else crop_centre(frames, intrinsics, settings.crop)

    return reduced
