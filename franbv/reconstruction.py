"""The loop: look, map, detect, recover, choose the next view (paper, fig. 2).

It drives any `DepthCamera` and `Arm`, simulated or real, and any `Planner`. Times are kept per stage; planning is apart
from sensing and motion.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.acquisition import Acquisition, Kind, Reconstruction
from franbv.candidates import candidate_poses, first_view
from franbv.frames import back_project
from franbv.geometry.oriented_box import OrientedBox
from franbv.model import Model, Timed, model_of, model_with
from franbv.object_model import object_points
from franbv.parameters import Parameters
from franbv.planners import Planner
from franbv.recovery import RecoveryPoses
from franbv.reflective_regions import Detection
from franbv.sensing import Arm, DepthBurst, DepthCamera
from franbv.stage_clock import StageClock
from franbv.stopping import StopReason, stop_reason
from franbv.voxel_map import empty_map


def reconstruct(
    camera: DepthCamera,
    arm: Arm,
    planner: Planner,
    parameters: Parameters,
    seed: int,
    first_azimuth_deg: float = 0.0,
    observe: Callable[[Acquisition], None] = lambda acquisition: None,
) -> Reconstruction:
    """Reconstruct the object in front of the camera.

    seed: root of the planner's own randomness (candidate azimuths, clustering); the camera's noise is its own.
    observe: called with each acquisition as soon as it is complete.
    """
    cell = _Cell(camera, arm, planner, parameters, seed, observe)
    view = cell.first_view(first_azimuth_deg)
    model = cell.first_model()
    best_utilities: list[float] = []
    while True:
        iteration = len(best_utilities)  # 0 is the first view
        burst = cell.look(view.pose)  # (c)
        before, model = model, cell.updated(model, burst)  # (a)
        detection = cell.detect(burst, before, model)  # (d, e)
        recovery = cell.activated(detection, burst)
        cell.record("nbv" if iteration else "first", iteration, view, burst, model, detection, recovery)
        model = cell.recovered(model, iteration, recovery)  # (f)
        stop = stop_reason(best_utilities, parameters)
        if stop is not None:
            return Reconstruction(tuple(cell.acquisitions), stop)
        best = cell.next_best_view(model)  # (b)
        if best is None:
            return Reconstruction(tuple(cell.acquisitions), StopReason.NO_REACHABLE_VIEW)
        view = best
        best_utilities.append(view.utility)


@dataclass(frozen=True, eq=False)
class _View:
    """A pose that was chosen."""

    pose: RigidTransform
    utility: float
    n_unreachable: int


@dataclass(frozen=True, eq=False)
class _Recovery:
    """A region to recover."""

    region: OrientedBox
    """B_r*."""
    poses: RecoveryPoses
    seen: DepthBurst
    """The burst that shows the region."""
    others: tuple[OrientedBox, ...]
    """Smaller regions of the same burst."""


class _Cell:
    """Camera, arm and planner at work: times every step and keeps every acquisition."""

    def __init__(
        self,
        camera: DepthCamera,
        arm: Arm,
        planner: Planner,
        parameters: Parameters,
        seed: int,
        observe: Callable[[Acquisition], None],
    ) -> None:
        self.camera, self.arm, self.planner, self.parameters, self.observe = camera, arm, planner, parameters, observe
        self.acquisitions: list[Acquisition] = []
        self.clock = StageClock()
        azimuths, choices, self.cluster_seeds = np.random.SeedSequence(seed).spawn(3)
        self.azimuths, self.choices = np.random.default_rng(azimuths), np.random.default_rng(choices)
        self.motion_s = 0.0

    def first_view(self, azimuth_deg: float) -> _View:
        pose = first_view(self.parameters, azimuth_deg)
        if not self.arm.reachable(pose):
            raise ValueError(f"the arm cannot reach the first view at azimuth {azimuth_deg} deg: {pose.translation} m")
        return _View(pose, np.nan, 0)

    def look(self, pose: RigidTransform) -> DepthBurst:
        """Move there and take a burst."""
        self.motion_s = self.arm.move_to(pose)
        with self.clock.timing("sensing"):
            return self.camera.capture(pose, self.parameters.n_frames)

    def first_model(self) -> Model:
        """The model of an empty map."""
        return model_of(empty_map(self.parameters), *self._modelling())

    def updated(self, model: Model, burst: DepthBurst) -> Model:
        """The model with the burst in it."""
        return model_with(model.voxel_map, burst, *self._modelling())

    def _modelling(self) -> tuple[Planner, Parameters, np.random.SeedSequence, Timed]:
        return self.planner, self.parameters, self.cluster_seeds.spawn(1)[0], self.clock.planning

    def detect(self, burst: DepthBurst, before: Model, model: Model) -> Detection | None:
        """Reflective regions in the burst; before, model: without and with it (`Parameters.detection_ellipsoids`)."""
        if self.planner.recovery is None:
            return None
        with self.clock.planning("detection"):
            known = before if self.parameters.detection_ellipsoids == "previous" else model
            return self.planner.recovery.detect(burst, known, self.parameters)

    def activated(self, detection: Detection | None, burst: DepthBurst) -> _Recovery | None:
        """The recovery of the largest region; None if there is none."""
        return None if detection is None else self._recovery_of(detection.boxes, burst)

    def _recovery_of(self, regions: tuple[OrientedBox, ...], seen: DepthBurst) -> _Recovery | None:
        if self.planner.recovery is None or not regions:
            return None
        with self.clock.planning("recovery_poses"):
            poses = self.planner.recovery.poses(
                regions[0], seen.T_world_cam, self.parameters, self.arm.reachable, self.camera.min_z
            )
        return _Recovery(regions[0], poses, seen, regions[1:])

    def recovered(self, model: Model, iteration: int, recovery: _Recovery | None) -> Model:
        """The model after as many of the recovery's poses as it takes until Gamma exceeds tau_rec, and after those of
        the recoveries that follow from it, in the readings that have any."""
        n_recoveries = 1
        while recovery is not None:
            model, recovery = self._after(model, iteration, recovery, n_recoveries)
            n_recoveries += 1
        return model

    def _after(
        self, model: Model, iteration: int, recovery: _Recovery, n_recoveries: int
    ) -> tuple[Model, _Recovery | None]:
        """The model after one recovery, and the recovery that follows from it."""
        assert self.planner.recovery is not None
        at_activation, remaining, gamma, following = model, list(recovery.poses.poses), 0.0, None
        if not remaining and self.parameters.regions_recovered == "all":
            following = self._recovery_of(recovery.others, recovery.seen)
        while remaining and gamma <= self.parameters.recovered_share:
            with self.clock.planning("score"):
                utilities = self.planner.recovery.score(
                    model, recovery.region, self.camera.intrinsics, remaining, self.parameters
                )
            chosen = self._order(utilities)
            view = _View(remaining.pop(chosen), float(utilities[chosen]), 0)
            burst = self.look(view.pose)
            before, model = model, self.updated(model, burst)
            with self.clock.planning("gamma"):
                gamma, attainable = self.planner.recovery.judge(at_activation, model, recovery.region, self.parameters)
            detection = None
            if not remaining or gamma > self.parameters.recovered_share:
                if self.parameters.regions_recovered == "all":
                    following = self._recovery_of(recovery.others, recovery.seen)
                if following is None and n_recoveries < self.parameters.recoveries_in_turn:
                    detection = self.detect(burst, before, model)
                    following = self.activated(detection, burst)
            self.record("recovery", iteration, view, burst, model, detection, following, (gamma, attainable))
        return model, following

    def next_best_view(self, model: Model) -> _View | None:
        """The reachable candidate of largest utility; None if the arm reaches none."""
        with self.clock.planning("candidates"):
            azimuth = self.azimuths.uniform(0.0, 2 * np.pi)
            candidates = candidate_poses(model.object.box, self.parameters, azimuth)
        with self.clock.planning("reachability"):
            reachable = [pose for pose in candidates if self.arm.reachable(pose)]
        if not reachable:
            return None
        with self.clock.planning("score"):
            utilities = self.planner.score(model, self.camera.intrinsics, reachable, self.parameters)
        chosen = self._best(utilities)
        return _View(reachable[chosen], float(utilities[chosen]), len(candidates) - len(reachable))

    def record(
        self,
        kind: Kind,
        iteration: int,
        view: _View,
        burst: DepthBurst,
        model: Model,
        detection: Detection | None = None,
        recovery: _Recovery | None = None,
        gammas: tuple[float, float] | None = None,
    ) -> None:
        """Keep the acquisition and show it to the observer. recovery: what it sets off; gammas: Gamma and attained."""
        depth = burst.median_depth(self.parameters.invalid_share)
        points = burst.T_world_cam.apply(back_project(depth, burst.intrinsics))
        spent = self.clock.read()
        sensing_s = spent.pop("sensing").wall_s
        self.acquisitions.append(
            Acquisition(
                index=len(self.acquisitions),
                nbv_iteration=iteration,
                kind=kind,
                burst=burst,
                points=object_points(points, model.voxel_map, self.parameters),
                model=model,
                utility=None if kind == "first" else view.utility,
                n_unreachable=view.n_unreachable,
                detection=detection,
                recovery_poses=None if recovery is None else recovery.poses,
                gamma=gammas[0] if gammas else None,
                gamma_attainable=gammas[1] if gammas else None,
                planning_s={stage: time.thread_s for stage, time in spent.items()},
                sensing_s=sensing_s,
                motion_s=self.motion_s,
            )
        )
        self.observe(self.acquisitions[-1])

    def _best(self, utilities: Float[np.ndarray, "n"]) -> int:
        """Index of the largest; among equals (nothing seen yet) any, so that not one ring is always taken."""
        return int(self.choices.choice(np.flatnonzero(utilities == utilities.max())))

    def _order(self, utilities: Float[np.ndarray, "n"]) -> int:
        """Index of the recovery pose to take next."""
        if self.parameters.recovery_order == "random":
            return int(self.choices.integers(len(utilities)))
        return self._best(utilities)
