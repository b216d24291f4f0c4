"""What a cell can tell of a run without truth: three numbers, from its folder, its recording or its acquisitions.

They are chosen for what shine does to a run: recoveries that gain nothing, holes on the object, depth that flickers. A
run is one draw, however many bursts it has, since its bursts show one scene.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

from franbv.acquisition import Acquisition
from franbv.adapters.recording.command import recorded_parameters
from franbv.adapters.recording.contents import Recording, RecordingError
from franbv.adapters.recording.open_loop import first_frames
from franbv.cell import PlanningCell
from franbv.ellipsoids import Ellipsoids
from franbv.known_planners import PLANNERS
from franbv.parameters import Parameters
from franbv.reflective_regions import View, persistent_invalid
from franbv.robust.regions import RobustDetection
from franbv.sensing import DepthBurst
from franbv.stopping import StopReason
from studies.run.acquisition_table import RECOVERY
from studies.run.stored_run import StoredRun

SignalName = Literal["recovery_without_gain", "invalid_share", "burst_spread"]
"""What is watched."""
NOTHING_SEEN = 1.0
"""`invalid_share` where a planner that looks for regions sees no object at all [-]. Choice: all of it is missing."""


@dataclass(frozen=True)
class Observed:
    """A run's numbers. None: the run says nothing of that."""

    recoveries: int | None
    """Recoveries of which a view was taken [-]. None for a run that has not come to its end, which may begin further
    ones, and for a planner that makes none."""
    least_gain: float | None
    """Smallest of the Gammas, eq. (15), with which its recoveries ended [-]; None where there was none."""
    invalid_share: float | None
    """Share of the object's silhouette in the first burst, I_o with that burst in the map, that is frequently invalid,
    eq. (7) [-]. None for planners without a silhouette."""
    burst_spread: float | None
    """Of the first burst, as `depth_spread` has it [1/m]; None where its frames were not kept."""


@dataclass(frozen=True)
class RecoveryStep:
    """What an acquisition says of recoveries."""

    is_recovery: bool
    """Whether it was taken for one."""
    activates: bool
    """Whether it sets one off."""
    gamma: float | None
    """After it, where it was taken for one [-]."""


def depth_spread(depths: Float[np.ndarray, "n h w"]) -> float | None:
    """Median over the pixels that are valid in all frames of their standard deviation over the frames divided by the
    square of their mean depth [1/m]; None for one frame alone, and where no pixel is valid in all of them.

    depths: Z-depth of a burst [m], 0 = invalid. Divided by Z^2 since the noise of stereo depth grows so (Z = f b / d,
    dZ = Z^2 dd / (f b)), so that runs at other distances compare. The deviation is that with n - 1.
    """
    always = (depths > 0).all(axis=0)
    if len(depths) < 2 or not always.any():
        return None
    seen = depths[:, always].astype(float)
    return float(np.median(np.std(seen, axis=0, ddof=1) / np.mean(seen, axis=0) ** 2))


def share_in(silhouette: Bool[np.ndarray, "h w"], invalid: Bool[np.ndarray, "h w"], detects: bool) -> float | None:
    """Share of the silhouette that is invalid [-]; without one NOTHING_SEEN, or None where nobody looks for regions.

    detects: whether the run's planner looks for reflective regions, and recovers them.
    """
    if not silhouette.any():
        return NOTHING_SEEN if detects else None
    return float(np.mean(invalid[silhouette]))


def last_gammas(steps: Iterable[RecoveryStep]) -> list[float]:
    """The Gamma with which each recovery ended, in their order. steps: of all acquisitions of a run."""
    ended: list[float] = []
    open_one: float | None = None
    for step in steps:
        if step.is_recovery:
            open_one = step.gamma
        if open_one is not None and (step.activates or not step.is_recovery):
            ended.append(open_one)
            open_one = None
    return ended if open_one is None else [*ended, open_one]


def observed_in(acquisitions: Sequence[Acquisition], parameters: Parameters, stop: StopReason | None) -> Observed:
    """Of a run's acquisitions, one at least. stop: the rule that ended it, None while it lasts."""
    first = acquisitions[0]
    steps = [RecoveryStep(a.kind == RECOVERY, a.activates, a.gamma) for a in acquisitions]
    detects = first.detection is not None and not isinstance(first.detection, RobustDetection)
    share = _share_of(first.burst, first.model.ellipsoids, parameters, detects)
    return _observed(steps, detects and _is_end(stop), share, depth_spread(first.burst.depths))


def observed_of_stored(stored: StoredRun) -> Observed:
    """Of a finished run's folder; InputError for files that cannot be read."""
    rows = stored.rows
    steps = [RecoveryStep(row["kind"] == RECOVERY, bool(row["recovery_poses"]), row["gamma"]) for row in rows]
    detects = rows[0]["regions"] is not None and PLANNERS[stored.run["config"]["planner"]].build().recovery is not None
    view, depths = stored.view(0), stored.depths(0)
    share = share_in(view.silhouette, view.invalid, detects)
    ended = _is_end(stored.run["summary"].get("stop"))
    return _observed(steps, detects and ended, share, None if depths is None else depth_spread(depths))


def observed_of_recording(recording: Recording) -> Observed:
    """Of a recording, as far as it was written.

    The first burst is put into an empty map as the run did it, with its seed, since a recording holds no silhouette.
    RecordingError where no planner was there, or one that this version does not know.
    """
    run = recording.run
    if run.planner is None:
        raise RecordingError(f"{recording.path}: was not made by a planner; give recordings of runs")
    if run.planner not in PLANNERS:
        raise RecordingError(f"{recording.path}: was planned by {run.planner}, which this version does not know")
    parameters = recorded_parameters(recording)
    planner, camera = PLANNERS[run.planner].build(), recording.camera
    detects = planner.recovery is not None
    cell = PlanningCell(
        camera.intrinsics, camera.min_z, lambda pose: True, planner, parameters, run.seed, lambda acquisition: None
    )
    burst = first_frames(recording.bursts[0], parameters.n_frames)
    share = _share_of(burst, cell.updated(cell.first_model(), burst).ellipsoids, parameters, detects)
    steps = [
        RecoveryStep(said["kind"] == RECOVERY, bool((said["recovery"] or {}).get("poses")), said["gamma"])
        for said in recording.decisions
    ]
    return _observed(steps, detects and _is_end(recording.stop), share, depth_spread(burst.depths))


def _share_of(burst: DepthBurst, ellipsoids: Ellipsoids, parameters: Parameters, detects: bool) -> float | None:
    """`share_in` before these ellipsoids."""
    view = View(burst, ellipsoids, parameters)
    return share_in(view.silhouette, persistent_invalid(view), detects)


def _is_end(stop: str | None) -> bool:
    """Whether a run came to its own end: a replay that ran out of bursts did not."""
    return stop is not None and stop != StopReason.RECORDING_ENDED


def _observed(steps: Iterable[RecoveryStep], tells: bool, share: float | None, spread: float | None) -> Observed:
    """tells: whether the run says anything of recoveries."""
    gammas = last_gammas(steps) if tells else []
    return Observed(len(gammas) if tells else None, min(gammas, default=None), share, spread)
