"""A reconstruction on a real cell: recorded from the first burst on, taken up again where a recording of it ends."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from franbv.acquisition import Acquisition, Reconstruction
from franbv.adapters.live.guarded_arm import GuardedArm, RefusedError
from franbv.adapters.live.pulse import StandingCamera
from franbv.adapters.live.resumed import CannotResumeError, ResumedCell
from franbv.adapters.recording.contents import (
    CameraFacts,
    NothingRecordedError,
    Recording,
    RecordingError,
    RunFacts,
)
from franbv.adapters.recording.mcap_recording import read_recording
from franbv.adapters.recording.tape import Tape
from franbv.adapters.recording.watched import Watch
from franbv.adapters.recording.writer import RecordingWriter
from franbv.parameters import Parameters
from franbv.planners import Planner
from franbv.reconstruction import reconstruct
from franbv.sensing import Arm, DepthCamera

MOST_REFUSALS = 20
"""Motions that may be refused in one run before it is given up [-] (choice: as many as it has views)."""


@dataclass(frozen=True, eq=False)
class LiveRun:
    """What is there, and what shall be done with it."""

    camera: DepthCamera
    arm: GuardedArm
    planner: Planner
    parameters: Parameters
    facts: RunFacts
    camera_facts: CameraFacts
    out: Path
    """Folder of the run's recordings."""
    infrared: Callable[[], UInt8[np.ndarray, "h w"] | None] = lambda: None
    """Left infrared image of the burst that was taken last."""
    times_ns: Callable[[], tuple[int, ...] | None] = lambda: None
    """When its frames were taken [ns]."""
    observe: Callable[[Acquisition], None] = lambda acquisition: None
    """Called with each acquisition that is new."""
    show: Callable[[Acquisition, UInt8[np.ndarray, "h w"] | None], None] = lambda acquisition, infrared: None
    """Called once with each acquisition of the run, those of a recording that it goes on from too, and its image."""
    say: Callable[[str], None] = lambda words: None

    def go(self) -> Reconstruction:
        """Run to the end. A motion that is refused before it begins counts as out of reach, and the planner goes on.

        What ends it otherwise leaves a recording from which the next call goes on.
        """
        for attempt in range(MOST_REFUSALS):
            try:
                return self._on_from(last_recording(self.out), attempt == 0)
            except RefusedError as refused:
                self.say(f"{refused}; the planner chooses another pose")
        raise RefusedError(self.arm.refused[-1], f"{MOST_REFUSALS} motions were refused; check the cell's boxes")

    def _on_from(self, old: Recording | None, show_old: bool) -> Reconstruction:
        camera: DepthCamera = StandingCamera(self.camera, self.arm.camera_pose)
        arm: Arm = self.arm
        if old is not None:
            check_same_run(old, self.facts)
            self.arm.refused = [
                *self.arm.refused,
                *(T for T, can in zip(old.reachability.poses, old.reachability.reachable, strict=True) if not can),
            ]
            camera = arm = ResumedCell(Tape(old), camera, arm)
        n_old = 0 if old is None else len(old.bursts)

        def infrared(number: int) -> UInt8[np.ndarray, "h w"] | None:
            return self.infrared() if old is None or number >= n_old else old.bursts[number].read_infrared()

        def seen(acquisition: Acquisition) -> None:
            watch.observe(acquisition)
            if acquisition.index >= n_old:
                self.observe(acquisition)
            if acquisition.index >= n_old or show_old:
                self.show(acquisition, infrared(acquisition.index))

        with RecordingWriter(next_file(self.out), self.facts, self.camera_facts) as writer:
            watch = Watch(
                writer,
                infrared,
                lambda number: self.times_ns() if old is None or number >= n_old else old.bursts[number].times_ns,
            )
            seen_by = watch.camera(camera), watch.arm(arm), self.planner, self.parameters
            try:
                run = reconstruct(*seen_by, self.facts.seed, self.facts.azimuth_deg, seen)
            except RefusedError as refused:
                watch.refused(self.arm.refused[-1] if self.arm.refused else refused.T_world_cam)
                raise
            watch.stop(run.stop)
        return run


def recordings_in(out: Path) -> list[Path]:
    """Of a run's folder, the oldest first."""
    found = [path for path in out.glob("recording-*.mcap") if path.stem.removeprefix("recording-").isdigit()]
    return sorted(found, key=lambda path: int(path.stem.removeprefix("recording-")))


def next_file(out: Path) -> Path:
    """A name that no recording of the folder has; the folder is made."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordingError(f"{out}: cannot be made ({error.strerror}); name another folder") from error
    found = recordings_in(out)
    number = int(found[-1].stem.removeprefix("recording-")) + 1 if found else 1
    return out / f"recording-{number}.mcap"


def last_recording(out: Path) -> Recording | None:
    """The recording with the most bursts, the newest of those; None where the folder has none with a burst.

    RecordingError for one that is damaged.
    """
    best: Recording | None = None
    for path in recordings_in(out):
        if path.stat().st_size == 0:  # cut off before its first byte was on disk
            continue
        try:
            found = read_recording(path)
        except NothingRecordedError:
            continue
        if best is None or len(found.bursts) >= len(best.bursts):
            best = found
    return best


def check_same_run(old: Recording, facts: RunFacts) -> None:
    """CannotResumeError where the recording is of another run than the one that shall go on."""
    for name in ("planner", "parameters", "seed", "azimuth_deg", "ablation"):
        if getattr(old.run, name) != getattr(facts, name):
            raise CannotResumeError(
                f"{old.path}: was begun with another {name.replace('_deg', '')}; give the same, or another folder"
            )
