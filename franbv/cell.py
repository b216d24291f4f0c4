"""The planner at work, whoever moves the camera: models, detects, proposes and keeps, each step timed.

`franbv.reconstruction` sends a camera to what it proposes; `franbv.adapters.recording.open_loop` shows it a recording.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.acquisition import Acquisition, Kind
from franbv.frames import Intrinsics, back_project
from franbv.geometry.oriented_box import OrientedBox
from franbv.model import Model, Timed, model_of, model_with
from franbv.object_model import object_points
from franbv.parameters import Parameters
from franbv.planners import Planner
from franbv.recovery import RecoveryPoses
from franbv.reflective_regions import Detection
from franbv.sensing import DepthBurst
from franbv.stage_clock import StageClock
from franbv.voxel_map import empty_map

Reachable = Callable[[RigidTransform], bool]
"""T_world_cam -> whether the arm can bring the camera there."""


@dataclass(frozen=True, eq=False)
class ChosenView:
    """A pose that was chosen."""

    pose: RigidTransform
    utility: float
    """U or U_r of the pose, in the planner's unit; NaN where nobody asked for it."""
    n_unreachable: int
    """Candidates that the arm cannot reach [-]."""


@dataclass(frozen=True, eq=False)
class ActivatedRecovery:
    """A region to recover."""

    region: OrientedBox
    """B_r*."""
    poses: RecoveryPoses
    seen: DepthBurst
    """The burst that shows the region."""
    others: tuple[OrientedBox, ...]
    """Smaller regions of the same burst."""


class PlanningCell:
    """The planner before one burst after the other: what it does with each, its randomness and its clock.

    It neither moves nor looks: who does says where the camera stands, hands over bursts, and sets `motion_s`, the time
    of the last move [s]. Steps of the method that need no new burst are here, by the letters of the paper's figure 2:
    the model (a), the next best view (b), regions (d, e) and the poses from which they are seen again (f).
    """

    def __init__(
        self,
        intrinsics: Intrinsics,
        min_z: float,
        reachable: Reachable,
        planner: Planner,
        parameters: Parameters,
        seed: int,
        observe: Callable[[Acquisition], None],
    ) -> None:
        """Arguments as in `franbv.reconstruction.reconstruct`; intrinsics and min_z [m] are the camera's."""
        self.intrinsics, self.min_z, self.reachable = intrinsics, min_z, reachable
        self.planner, self.parameters, self.observe = planner, parameters, observe
        self.acquisitions: list[Acquisition] = []
        self.clock = StageClock()
        azimuths, choices, self.cluster_seeds = np.random.SeedSequence(seed).spawn(3)
        self.azimuths, self.choices = np.random.default_rng(azimuths), np.random.default_rng(choices)
        self.motion_s = 0.0

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
        known = before if self.parameters.detection_ellipsoids == "previous" else model
        if self.planner.recovery is not None:
            with self.clock.planning("detection"):
                return self.planner.recovery.detect(burst, known, self.parameters)
        if self.planner.detect is not None:
            with self.clock.planning("detection"):
                return self.planner.detect(burst, known, self.parameters, self.min_z)
        return None

    def activated(self, detection: Detection | None, burst: DepthBurst) -> ActivatedRecovery | None:
        """The recovery of the largest region; None if there is none."""
        return None if detection is None else self.recovery_of(detection.boxes, burst)

    def recovery_of(self, regions: tuple[OrientedBox, ...], seen: DepthBurst) -> ActivatedRecovery | None:
        """The recovery of the first of these regions, of which the burst shows all; None if there is none."""
        if self.planner.recovery is None or not regions:
            return None
        with self.clock.planning("recovery_poses"):
            poses = self.planner.recovery.poses(
                regions[0], seen.T_world_cam, self.parameters, self.reachable, self.min_z
            )
        return ActivatedRecovery(regions[0], poses, seen, regions[1:])

    def next_recovery_view(self, model: Model, region: OrientedBox, remaining: list[RigidTransform]) -> ChosenView:
        """The recovery pose to take next, and it is taken out of those that remain, of which there is one at least."""
        assert self.planner.recovery is not None
        with self.clock.planning("score"):
            utilities = self.planner.recovery.score(model, region, self.intrinsics, remaining, self.parameters)
        chosen = self._order(utilities)
        return ChosenView(remaining.pop(chosen), float(utilities[chosen]), 0)

    def next_best_view(self, model: Model) -> ChosenView | None:
        """The reachable candidate of largest utility; None if the arm reaches none."""
        with self.clock.planning("candidates"):
            azimuth = self.azimuths.uniform(0.0, 2 * np.pi)
            candidates = self.planner.candidates(model, self.parameters, azimuth)
        with self.clock.planning("reachability"):
            reachable = [pose for pose in candidates if self.reachable(pose)]
        if not reachable:
            return None
        utilities = self.utilities(model, reachable)
        chosen = self._best(utilities)
        return ChosenView(reachable[chosen], float(utilities[chosen]), len(candidates) - len(reachable))

    def utilities(self, model: Model, poses: list[RigidTransform]) -> Float[np.ndarray, "n"]:
        """U of each pose, in the planner's unit."""
        with self.clock.planning("score"):
            return self.planner.score(model, self.intrinsics, poses, self.parameters)

    def record(
        self,
        kind: Kind,
        iteration: int,
        view: ChosenView,
        burst: DepthBurst,
        model: Model,
        detection: Detection | None = None,
        recovery: ActivatedRecovery | None = None,
        gammas: tuple[float, float] | None = None,
    ) -> None:
        """Keep the acquisition and show it to the observer. recovery: what it sets off; gammas: Gamma and attained."""
        depth = self.planner.points(burst, self.parameters)
        points = burst.T_world_cam.apply(back_project(depth, burst.intrinsics))
        missing = self._missing(model)
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
                utility=None if np.isnan(view.utility) else view.utility,
                n_unreachable=view.n_unreachable,
                detection=detection,
                recovery_poses=None if recovery is None else recovery.poses,
                missing=missing,
                gamma=gammas[0] if gammas else None,
                gamma_attainable=gammas[1] if gammas else None,
                planning_s={stage: time.thread_s for stage, time in spent.items()},
                sensing_s=sensing_s,
                motion_s=self.motion_s,
            )
        )
        self.observe(self.acquisitions[-1])

    def _missing(self, model: Model) -> float | None:
        if self.planner.missing is None:
            return None
        with self.clock.planning("missing"):
            return self.planner.missing(model, self.parameters)

    def _best(self, utilities: Float[np.ndarray, "n"]) -> int:
        """Index of the largest; among equals (nothing seen yet) any, so that not one ring is always taken."""
        return int(self.choices.choice(np.flatnonzero(utilities == utilities.max())))

    def _order(self, utilities: Float[np.ndarray, "n"]) -> int:
        """Index of the recovery pose to take next."""
        if self.parameters.recovery_order == "random":
            return int(self.choices.integers(len(utilities)))
        return self._best(utilities)
