"""The loop: look, map, detect, recover, choose the next view (paper, fig. 2).

It drives any `DepthCamera` and `Arm`, simulated or real, and any `Planner`. Times are kept per stage; planning is apart
from sensing and motion.
"""

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.acquisition import Acquisition, Reconstruction
from franbv.candidates import first_view
from franbv.cell import ActivatedRecovery, ChosenView, PlanningCell
from franbv.model import Model
from franbv.parameters import Parameters
from franbv.planners import Planner
from franbv.sensing import Arm, DepthBurst, DepthCamera
from franbv.stopping import StopReason


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
        stop = planner.stop(model, best_utilities, parameters)
        if stop is not None:
            return Reconstruction(tuple(cell.acquisitions), stop)
        best = cell.next_best_view(model)  # (b)
        if best is None:
            return Reconstruction(tuple(cell.acquisitions), StopReason.NO_REACHABLE_VIEW)
        view = best
        best_utilities.append(view.utility)


class _Cell(PlanningCell):
    """The planner with camera and arm: goes where it proposes to, and recovers what it detects."""

    def __init__(
        self,
        camera: DepthCamera,
        arm: Arm,
        planner: Planner,
        parameters: Parameters,
        seed: int,
        observe: Callable[[Acquisition], None],
    ) -> None:
        super().__init__(camera.intrinsics, camera.min_z, arm.reachable, planner, parameters, seed, observe)
        self.camera, self.arm = camera, arm

    def first_view(self, azimuth_deg: float) -> ChosenView:
        pose = first_view(self.parameters, azimuth_deg)
        if not self.arm.reachable(pose):
            raise ValueError(f"the arm cannot reach the first view at azimuth {azimuth_deg} deg: {pose.translation} m")
        return ChosenView(pose, np.nan, 0)

    def look(self, pose: RigidTransform) -> DepthBurst:
        """Move there and take a burst."""
        self.motion_s = self.arm.move_to(pose)
        with self.clock.timing("sensing"):
            return self.camera.capture(pose, self.parameters.n_frames)

    def recovered(self, model: Model, iteration: int, recovery: ActivatedRecovery | None) -> Model:
        """The model after as many of the recovery's poses as it takes until Gamma exceeds tau_rec, and after those of
        the recoveries that follow from it, in the readings that have any."""
        n_recoveries = 1
        while recovery is not None:
            model, recovery = self._after(model, iteration, recovery, n_recoveries)
            n_recoveries += 1
        return model

    def _after(
        self, model: Model, iteration: int, recovery: ActivatedRecovery, n_recoveries: int
    ) -> tuple[Model, ActivatedRecovery | None]:
        """The model after one recovery, and the recovery that follows from it."""
        assert self.planner.recovery is not None
        at_activation, remaining, gamma, following = model, list(recovery.poses.poses), 0.0, None
        if not remaining and self.parameters.regions_recovered == "all":
            following = self.recovery_of(recovery.others, recovery.seen)
        while remaining and gamma <= self.parameters.recovered_share:
            view = self.next_recovery_view(model, recovery.region, remaining)
            burst = self.look(view.pose)
            before, model = model, self.updated(model, burst)
            with self.clock.planning("gamma"):
                gamma, attainable = self.planner.recovery.judge(at_activation, model, recovery.region, self.parameters)
            detection = None
            if not remaining or gamma > self.parameters.recovered_share:
                if self.parameters.regions_recovered == "all":
                    following = self.recovery_of(recovery.others, recovery.seen)
                if following is None and n_recoveries < self.parameters.recoveries_in_turn:
                    detection = self.detect(burst, before, model)
                    following = self.activated(detection, burst)
            self.record("recovery", iteration, view, burst, model, detection, following, (gamma, attainable))
        return model, following
