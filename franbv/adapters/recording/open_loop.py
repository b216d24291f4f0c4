"""A recording looked at view by view: what the planner detects in each burst, and where it would have gone from there.

The poses are those that were recorded, whoever chose them. At each of them the burst enters the map, regions are looked
for, and the planner proposes a next pose, which nobody takes: recoveries are proposed but not made, so that there is no
Gamma, and no stop rule ends the run.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.acquisition import Acquisition, Reconstruction
from franbv.adapters.recording.contents import RecordedBurst, Recording
from franbv.adapters.recording.forms import matrix_rows
from franbv.candidates import candidate_poses
from franbv.frames import back_project
from franbv.model import Model, model_of, model_with
from franbv.object_model import object_points
from franbv.parameters import Parameters
from franbv.planners import Planner
from franbv.recovery import RecoveryPoses
from franbv.reflective_regions import Detection
from franbv.sensing import DepthBurst
from franbv.stage_clock import StageClock
from franbv.stopping import StopReason
from franbv.voxel_map import empty_map

Reachable = Callable[[RigidTransform], bool]


@dataclass(frozen=True, eq=False)
class Proposal:
    """Where the planner would have gone from a recorded view."""

    acquisition: int
    """Index of the view."""
    kind: Literal["nbv", "recovery"]
    T_world_cam: RigidTransform
    utility: float
    """U or U_r of the pose, in the planner's unit."""
    n_unreachable: int
    """Candidates that the arm could not reach [-]."""

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        pose = {"T_world_cam": matrix_rows(self.T_world_cam), "utility": self.utility}
        return {"acquisition": self.acquisition, "kind": self.kind, **pose, "n_unreachable": self.n_unreachable}


def open_loop(
    recording: Recording,
    planner: Planner,
    parameters: Parameters,
    seed: int,
    reachable: Reachable,
    observe: Callable[[Acquisition], None] = lambda acquisition: None,
) -> tuple[Reconstruction, tuple[Proposal, ...]]:
    """Acquisitions at the recorded poses, and the proposals; none for a view from which the arm reaches nothing.

    The kind of an acquisition is the recorded one where the recording has it; its utility is the planner's for that
    pose. seed: as in `franbv.reconstruction.reconstruct`.
    """
    looker = _Looker(recording, planner, parameters, seed, reachable)
    acquisitions, proposals = [], []
    for number in range(len(recording.bursts)):
        acquisition = looker.look(number)
        acquisitions.append(acquisition)
        observe(acquisition)
        proposal = looker.propose(acquisition)
        if proposal is not None:
            proposals.append(proposal)
    return Reconstruction(tuple(acquisitions), StopReason.RECORDING_ENDED), tuple(proposals)


class _Looker:
    """The planner before one recorded view after the other."""

    def __init__(
        self, recording: Recording, planner: Planner, parameters: Parameters, seed: int, reachable: Reachable
    ) -> None:
        self.recording, self.planner, self.parameters, self.reachable = recording, planner, parameters, reachable
        azimuths, choices, self.cluster_seeds = np.random.SeedSequence(seed).spawn(3)
        self.azimuths, self.choices = np.random.default_rng(azimuths), np.random.default_rng(choices)
        self.clock = StageClock()
        self.model = model_of(empty_map(parameters), *self._modelling())

    def _modelling(self) -> tuple[Any, ...]:
        return self.planner, self.parameters, self.cluster_seeds.spawn(1)[0], self.clock.planning

    def look(self, number: int) -> Acquisition:
        recorded = self.recording.bursts[number]
        utility = None if number == 0 else self._utility(recorded)
        with self.clock.timing("sensing"):
            burst = first_frames(recorded, self.parameters.n_frames)
        before, self.model = self.model, model_with(self.model.voxel_map, burst, *self._modelling())
        detection = self._detection(burst, before)
        poses = self._recovery(detection, burst)
        depth = burst.median_depth(self.parameters.invalid_share)
        points = burst.T_world_cam.apply(back_project(depth, burst.intrinsics))
        spent = self.clock.read()
        sensing_s = spent.pop("sensing").wall_s
        said = self.recording.decisions[number] if number < len(self.recording.decisions) else {}
        return Acquisition(
            index=number,
            nbv_iteration=said.get("iteration", number),
            kind=said.get("kind", "nbv" if number else "first"),
            burst=burst,
            points=object_points(points, self.model.voxel_map, self.parameters),
            model=self.model,
            utility=utility,
            n_unreachable=0,
            detection=detection,
            recovery_poses=poses,
            gamma=None,
            gamma_attainable=None,
            planning_s={stage: time.thread_s for stage, time in spent.items()},
            sensing_s=sensing_s,
            motion_s=recorded.motion_s,
        )

    def propose(self, acquisition: Acquisition) -> Proposal | None:
        """A recovery pose where a region sets one off, else the next best view."""
        found = acquisition.recovery_poses
        if found is not None and found.poses and self.planner.recovery is not None:
            assert acquisition.detection is not None
            region, poses = acquisition.detection.boxes[0], list(found.poses)
            with self.clock.planning("score"):
                score = self.planner.recovery.score
                utilities = score(self.model, region, self.recording.camera.intrinsics, poses, self.parameters)
            return self._best("recovery", acquisition.index, poses, utilities, found.n_unreachable)
        azimuth = self.azimuths.uniform(0.0, 2 * np.pi)
        with self.clock.planning("candidates"):
            candidates = candidate_poses(self.model.object.box, self.parameters, azimuth)
        poses = [pose for pose in candidates if self.reachable(pose)]
        if not poses:
            return None
        with self.clock.planning("score"):
            utilities = self.planner.score(self.model, self.recording.camera.intrinsics, poses, self.parameters)
        return self._best("nbv", acquisition.index, poses, utilities, len(candidates) - len(poses))

    def _best(
        self,
        kind: Literal["nbv", "recovery"],
        acquisition: int,
        poses: list[RigidTransform],
        utilities: np.ndarray,
        n_unreachable: int,
    ) -> Proposal:
        best = int(self.choices.choice(np.flatnonzero(utilities == utilities.max())))
        return Proposal(acquisition, kind, poses[best], float(utilities[best]), n_unreachable)

    def _utility(self, recorded: RecordedBurst) -> float:
        """What the planner thinks of the recorded pose before it has seen what is there."""
        with self.clock.planning("score"):
            pose = [recorded.T_world_cam]
            return float(self.planner.score(self.model, self.recording.camera.intrinsics, pose, self.parameters)[0])

    def _detection(self, burst: DepthBurst, before: Model) -> Detection | None:
        if self.planner.recovery is None:
            return None
        with self.clock.planning("detection"):
            known = before if self.parameters.detection_ellipsoids == "previous" else self.model
            return self.planner.recovery.detect(burst, known, self.parameters)

    def _recovery(self, detection: Detection | None, burst: DepthBurst) -> RecoveryPoses | None:
        if detection is None or not detection.boxes or self.planner.recovery is None:
            return None
        with self.clock.planning("recovery_poses"):
            return self.planner.recovery.poses(
                detection.boxes[0], burst.T_world_cam, self.parameters, self.reachable, self.recording.camera.min_z
            )


def first_frames(recorded: RecordedBurst, n_frames: int) -> DepthBurst:
    """The burst as a camera would have given it that was asked for fewer frames."""
    burst = recorded.read()
    return DepthBurst(burst.depths[:n_frames], burst.intrinsics, burst.T_world_cam)
