"""What the viewer shows of one acquisition, whether its run lasts or was stored."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, UInt8
from scipy.spatial.transform import RigidTransform

from franbv.acquisition import Acquisition, Kind
from franbv.ellipsoids import Ellipsoids
from franbv.frames import Intrinsics
from franbv.geometry.oriented_box import OrientedBox

CURVES = ("coverage", "occupied_voxels", "gamma", "utility")
"""What is drawn over the acquisitions: shares [-], the object's occupied voxels [-], U or U_r [px^2]."""


class ViewError(ValueError):
    """A view that cannot be shown or written; the message is one line with the thing, the place and the mend."""


@dataclass(frozen=True, eq=False)
class ShownVoxels:
    """The object's voxels as cubes."""

    occupied: Float[np.ndarray, "n 3"]
    """Centres of the occupied ones, world frame [m]."""
    frontier: Float[np.ndarray, "m 3"]
    """Centres of the frontier, world frame [m]."""
    size: float
    """s_v [m]."""


@dataclass(frozen=True, eq=False)
class Sight:
    """One acquisition as it is shown. What is None is not known, and left out of the picture."""

    index: int
    """Of the acquisition, from 0: the step of the timeline."""
    kind: Kind
    iteration: int
    """NBV iteration that it belongs to."""
    T_world_cam: RigidTransform
    intrinsics: Intrinsics
    """Of `depth`."""
    depth: Float[np.ndarray, "h w"]
    """Median of the burst [m], 0 = frequently invalid."""
    points: Float[np.ndarray, "n 3"]
    """What this acquisition adds to the cloud, world frame [m]."""
    ellipsoids: Ellipsoids
    regions: tuple[OrientedBox, ...]
    """Reflective regions found in this burst, largest volume first."""
    recovery_poses: tuple[RigidTransform, ...]
    """T_world_cam of each pose from which the largest region is to be seen again."""
    voxels: ShownVoxels | None = None
    infrared: UInt8[np.ndarray, "h2 w2"] | None = None
    """Left infrared image of the first frame."""
    curves: Mapping[str, float | None] = field(default_factory=dict)
    """Values of CURVES after this acquisition; what is missing or None is not drawn."""


@runtime_checkable
class ViewSink(Protocol):
    """Where a run is drawn: `franbv.adapters.view.run_view.RunView`, which loads the extra `view`."""

    def observe(
        self,
        acquisition: Acquisition,
        coverage: float | None = None,
        infrared: UInt8[np.ndarray, "h w"] | None = None,
    ) -> None: ...
    def show(self, sight: Sight) -> None: ...
    def infrared(self, index: int, image: UInt8[np.ndarray, "h w"]) -> None: ...


def sight_of(
    acquisition: Acquisition,
    invalid_share: float,
    coverage: float | None = None,
    infrared: UInt8[np.ndarray, "h w"] | None = None,
) -> Sight:
    """The acquisition as it is shown.

    invalid_share: share of invalid frames from which on a pixel has no depth, as in `Parameters`.
    coverage: after this acquisition, None where nobody knows the true surface.
    """
    model, found, planned = acquisition.model, acquisition.detection, acquisition.recovery_poses
    return Sight(
        index=acquisition.index,
        kind=acquisition.kind,
        iteration=acquisition.nbv_iteration,
        T_world_cam=acquisition.burst.T_world_cam,
        intrinsics=acquisition.burst.intrinsics,
        depth=acquisition.burst.median_depth(invalid_share),
        points=acquisition.points,
        ellipsoids=model.ellipsoids,
        regions=() if found is None else found.boxes,
        recovery_poses=() if planned is None else planned.poses,
        voxels=ShownVoxels(model.object.occupied, model.object.frontier, model.voxel_map.voxel_size),
        infrared=infrared,
        curves={
            "coverage": coverage,
            "occupied_voxels": float(len(model.object.occupied)),
            "gamma": acquisition.gamma,
            "utility": acquisition.utility,
        },
    )
