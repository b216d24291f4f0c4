"""The object estimate O_t in the voxel map: its voxels, its frontier and its box B_t (paper, section III-A)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import label

from franbv.geometry.oriented_box import OrientedBox, axis_aligned_box, oriented_box
from franbv.parameters import Parameters
from franbv.voxel_map import VoxelMap, extent


@dataclass(frozen=True, eq=False)
class ObjectModel:
    """O_t, what is believed to be the object: its voxels, its frontier and its box B_t (paper, section III-A).

    The object is all that is occupied above the table and hangs together, but for components that are small in
    themselves or beside the largest (`Parameters.min_component_voxels`, `min_component_share`): those are taken for
    floaters of false depth. Assumed is a workspace with a table and nothing else in it; whatever large stands there
    counts as the object.
    """

    occupied: Float[np.ndarray, "n 3"]
    """Centres of the object's occupied voxels, world frame [m]."""
    frontier: Float[np.ndarray, "m 3"]
    """Centres of the frontier voxels that touch them, world frame [m]."""
    box: OrientedBox
    """B_t, around both; the prior box as long as nothing is seen."""
    is_prior: bool
    """Whether `box` is the prior box."""


def object_model(voxel_map: VoxelMap, parameters: Parameters) -> ObjectModel:
    """The object and its frontier, cut out of the map.

    The frontier is that of the object: table voxels do not count as occupied, so that the edge of the object's shadow
    on the table is no frontier. The box encloses the voxel centres of both sets, plus half a voxel on every side.
    """
    above = above_table(voxel_map, parameters)
    solid = large_components(
        voxel_map.occupied & above, parameters.min_component_voxels, parameters.min_component_share
    )
    occupied = voxel_map.centres(solid)
    if len(occupied) == 0:
        box = axis_aligned_box(np.array(parameters.prior_min), np.array(parameters.prior_max))
        return ObjectModel(occupied, np.zeros((0, 3)), box, is_prior=True)
    frontier = voxel_map.centres(voxel_map.frontier(solid) & above)
    box = oriented_box(np.concatenate([occupied, frontier])).grown(voxel_map.voxel_size / 2)
    return ObjectModel(occupied, frontier, box, is_prior=False)


def above_table(voxel_map: VoxelMap, parameters: Parameters) -> Bool[np.ndarray, "1 1 z"]:
    """Layers of the map whose voxel centres lie above the table, to be broadcast over the map."""
    heights = (np.arange(voxel_map.log_odds.shape[2]) + voxel_map.first[2]) * voxel_map.voxel_size
    return (heights > parameters.table_height + parameters.table_clearance)[None, None, :]


def large_components(mask: Bool[np.ndarray, "x y z"], min_voxels: int, min_share: float) -> Bool[np.ndarray, "x y z"]:
    """The 26-connected components with at least `min_voxels` voxels and `min_share` of the largest one's."""
    large = np.zeros(mask.shape, bool)
    filled = extent(mask)
    labels = np.zeros(mask[filled].shape, np.int32)
    label(mask[filled], structure=np.ones((3, 3, 3)), output=labels)
    sizes = np.bincount(labels.ravel(), minlength=1)
    sizes[0] = 0  # the background
    large[filled] = (sizes >= max(min_voxels, min_share * sizes.max()))[labels]
    return large


def object_points(
    points: Float[np.ndarray, "n 3"], voxel_map: VoxelMap, parameters: Parameters
) -> Float[np.ndarray, "m 3"]:
    """World points in the workspace and above the table: the raw cloud, by the same cut as the object's voxels."""
    return points[
        voxel_map.lookup(np.broadcast_to(above_table(voxel_map, parameters), voxel_map.log_odds.shape), points)
    ]
