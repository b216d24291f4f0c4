"""How much a sensor pose promises: U of eq. (2) for next views and U_r of eq. (14) for recovery poses."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.transform import RigidTransform

from franbv.ellipsoids import Ellipsoids
from franbv.frames import Intrinsics
from franbv.geometry.oriented_box import OrientedBox
from franbv.geometry.projected_box import projected_box_area
from franbv.parameters import Parameters, RankBy
from franbv.projection import in_camera_frame, projected_areas


def view_utility(
    ellipsoids: Ellipsoids, intrinsics: Intrinsics, T_world_cam: RigidTransform, parameters: Parameters
) -> float:
    """U(x), eq. (2) [px^2]: weighted areas of frontier ellipsoids less those of occupied ones."""
    return float(view_utilities(ellipsoids, intrinsics, [T_world_cam], parameters)[0])


def view_utilities(
    ellipsoids: Ellipsoids, intrinsics: Intrinsics, Ts_world_cam: Sequence[RigidTransform], parameters: Parameters
) -> Float[np.ndarray, "n"]:
    """U(x), eq. (2) [px^2], of every pose."""
    if len(Ts_world_cam) == 0:
        return np.zeros(0)
    poses = RigidTransform.concatenate(list(Ts_world_cam))
    areas = projected_areas(ellipsoids, intrinsics, poses, parameters.area_supersampling)  # (n, k)
    weights = rank_weights(ranks(nearness(ellipsoids, poses, parameters.rank_by)), parameters)
    return np.sum(weights * areas * np.where(ellipsoids.is_frontier, 1.0, -1.0), axis=1)


def recovery_utility(
    ellipsoids: Ellipsoids,
    region: OrientedBox,
    intrinsics: Intrinsics,
    T_world_cam: RigidTransform,
    parameters: Parameters,
) -> float:
    """U_r(x), eq. (14) [px^2]: U(x) plus the weighted area of the region B_r*, ranked among the ellipsoids."""
    areas = projected_areas(ellipsoids, intrinsics, T_world_cam, parameters.area_supersampling)
    areas = np.append(areas, projected_box_area(region, intrinsics, T_world_cam))
    T_cam_world = T_world_cam.inv()
    in_sight = T_cam_world.apply(region.corners())[:, 2].max() > 0.0
    of_region = _far(T_cam_world.apply(region.centre), parameters.rank_by) if in_sight else np.inf
    all_of_them = np.append(nearness(ellipsoids, T_world_cam, parameters.rank_by), of_region)
    weights = rank_weights(ranks(all_of_them), parameters)
    return float(np.sum(weights * areas * np.append(np.where(ellipsoids.is_frontier, 1.0, -1.0), 1.0)))


def nearness(ellipsoids: Ellipsoids, T_world_cam: RigidTransform, rank_by: RankBy) -> Float[np.ndarray, "*poses k"]:
    """What ellipsoids are ranked by [m], of one camera or of many; inf for those wholly behind it, which hide nothing.

    `distance`: of the centre from the camera (paper, section III-C). `depth`: the centre's Z-depth.
    """
    centres, shapes = in_camera_frame(ellipsoids, T_world_cam)
    return np.where(centres[..., 2] + np.sqrt(shapes[..., 2, 2]) > 0.0, _far(centres, rank_by), np.inf)


def _far(points: Float[np.ndarray, "*k 3"], rank_by: RankBy) -> Float[np.ndarray, "*k"]:
    """Distance or Z-depth of points in the camera frame [m]."""
    return np.asarray(np.linalg.norm(points, axis=-1) if rank_by == "distance" else points[..., 2])


def rank_weights(rank: Int[np.ndarray, "*poses k"], parameters: Parameters) -> Float[np.ndarray, "*poses k"]:
    """w_j of each rank, 1 for the nearest; see `Parameters.weighting`."""
    return parameters.weight_base**rank if parameters.weighting == "geometric" else 1.0 / (rank + 1.0)


def ranks(values: Float[np.ndarray, "*poses k"]) -> Int[np.ndarray, "*poses k"]:
    """Rank of each value within its row, 0 for the least; equal values rank in the order in which they stand."""
    order = np.argsort(values, axis=-1, kind="stable")
    return np.argsort(order, axis=-1)  # the inverse permutation: `order` says who comes first, not who is first
