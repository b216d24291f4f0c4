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
from franbv.cell import ActivatedRecovery, ChosenView, PlanningCell, Reachable
from franbv.model import Model
from franbv.parameters import Parameters
from franbv.planners import Planner
from franbv.sensing import DepthBurst
from franbv.stopping import StopReason


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
    camera = recording.camera
    cell = PlanningCell(camera.intrinsics, camera.min_z, reachable, planner, parameters, seed, observe)
    model, proposals = cell.first_model(), []
    for number, recorded in enumerate(recording.bursts):
        pose = recorded.T_world_cam
        utility = float(cell.utilities(model, [pose])[0]) if number else np.nan
        with cell.clock.timing("sensing"):
            burst = first_frames(recorded, parameters.n_frames)
        cell.motion_s = recorded.motion_s
        before, model = model, cell.updated(model, burst)
        detection = cell.detect(burst, before, model)
        recovery = cell.activated(detection, burst)
        said = recording.decisions[number] if number < len(recording.decisions) else {}
        kind, iteration = said.get("kind", "nbv" if number else "first"), said.get("iteration", number)
        cell.record(kind, iteration, ChosenView(pose, utility, 0), burst, model, detection, recovery)
        proposal = _proposal(cell, model, recovery)
        if proposal is not None:
            proposals.append(proposal)
    return Reconstruction(tuple(cell.acquisitions), StopReason.RECORDING_ENDED), tuple(proposals)


def _proposal(cell: PlanningCell, model: Model, recovery: ActivatedRecovery | None) -> Proposal | None:
    """A recovery pose where a region sets one off, else the next best view, from the last acquisition."""
    number = len(cell.acquisitions) - 1
    if recovery is not None and recovery.poses.poses:
        view = cell.next_recovery_view(model, recovery.region, list(recovery.poses.poses))
        return Proposal(number, "recovery", view.pose, view.utility, recovery.poses.n_unreachable)
    view = cell.next_best_view(model)
    return None if view is None else Proposal(number, "nbv", view.pose, view.utility, view.n_unreachable)


def first_frames(recorded: RecordedBurst, n_frames: int) -> DepthBurst:
    """The burst as a camera would have given it that was asked for fewer frames."""
    burst = recorded.read()
    return DepthBurst(burst.depths[:n_frames], burst.intrinsics, burst.T_world_cam)
