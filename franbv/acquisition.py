"""What a run leaves: every acquisition with its reason and result, and the clouds made of them."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

from franbv.model import Model
from franbv.recovery import RecoveryPoses
from franbv.reflective_regions import Detection
from franbv.sensing import DepthBurst
from franbv.stopping import StopReason

Kind = Literal["first", "nbv", "recovery"]


@dataclass(frozen=True, eq=False)
class Acquisition:
    """One burst, why it was taken, and what it led to.

    It keeps the whole model, so that a run can be judged and drawn acquisition by acquisition. Recoveries belong to the
    iteration that triggered them and are none of their own, as in the paper's experiments (section VI). What only a
    simulated camera has, infrared images and the truth, is not in it.
    """

    index: int
    """Counts all acquisitions, from 0."""
    nbv_iteration: int
    """0 for the first view; a recovery belongs to the iteration that triggered it."""
    kind: Kind
    burst: DepthBurst
    """As the camera gave it; its pose is `burst.T_world_cam`."""
    points: Float[np.ndarray, "n 3"]
    """Points of the burst's median depth, as far as the planner keeps it, in the workspace and above the table, world
    frame [m]."""
    model: Model
    """Map, object and ellipsoids with this burst in them."""
    utility: float | None
    """U or U_r of the chosen pose [px^2]; None for the first view."""
    n_unreachable: int
    """Candidates that the arm cannot reach."""
    detection: Detection | None
    """Reflective regions in this burst; None for recoveries and planners that look for none."""
    recovery_poses: RecoveryPoses | None
    """Where the largest region is to be seen from; None if there is none."""
    missing: float | None
    """Share of the surface that the planner then believes the map lacks [0, 1]; None where it has no idea."""
    gamma: float | None
    """Gamma of the region after this recovery; None for other kinds."""
    gamma_attainable: float | None
    """Gamma over what a surface patch can attain."""
    planning_s: dict[str, float]
    """Processor time by stage, from the choice of this pose to the detection in its burst [s]."""
    sensing_s: float
    """Wall time of taking the burst [s]."""
    motion_s: float
    """Time of the move to the pose, as the arm gave it [s]."""

    @property
    def activates(self) -> bool:
        """Whether a reflective region was found and its recovery begun: without a pose the arm never moved."""
        return self.recovery_poses is not None and len(self.recovery_poses.poses) > 0


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """A finished run: its acquisitions in the order in which they were taken, and the rule that ended it.

    It says what was made and not how good it is: `franbv.evaluation` holds it against a known surface.
    """

    acquisitions: tuple[Acquisition, ...]
    stop: StopReason

    @property
    def cloud(self) -> Float[np.ndarray, "n 3"]:
        """All points of all acquisitions, in order, world frame [m]."""
        return np.concatenate([acquisition.points for acquisition in self.acquisitions])

    @property
    def is_mapped(self) -> Bool[np.ndarray, "n"]:
        """Which points of the cloud lie in voxels that are occupied in the final map: the map-filtered cloud."""
        final = self.acquisitions[-1].model.voxel_map
        return final.lookup(final.occupied, self.cloud)
