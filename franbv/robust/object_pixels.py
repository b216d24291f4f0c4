"""What each pixel of a burst measured, beside what the map and the hull of the object say it should have."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from franbv.frames import project
from franbv.model import Model
from franbv.parameters import Parameters
from franbv.robust.evidence import with_scans
from franbv.robust.hull import ObjectHull
from franbv.robust.rays import cells_of, first_surfaces
from franbv.robust.settings import RobustSettings
from franbv.sensing import DepthBurst

OFFSETS = ((0.0, 0.0), (-1 / 3, -1 / 3), (1 / 3, -1 / 3), (-1 / 3, 1 / 3), (1 / 3, 1 / 3))
"""Rays of a pixel by which confirmed surface is asked for, from its middle [px] (choice: decimation takes the mean of a
block, and one ray may slip through between two voxels)."""
GRAZING = 0.1
"""Cosine below which a ray passes surface (choice: 84 deg, where only the rim of a surface is grazed)."""


@dataclass(frozen=True, eq=False)
class ObjectPixels:
    """Lengths are along the ray through a pixel's middle [m]."""

    rays: Float[np.ndarray, "h w 3"]
    """Unit directions in the world."""
    lengths: Float[np.ndarray, "h w"]
    """Measured, the median of the burst; 0 = frequently invalid."""
    covered: Bool[np.ndarray, "h w"]
    """Sees nothing but the hull. What follows is of these pixels."""
    entry: Float[np.ndarray, "h w"]
    """Where the ray meets the hull; inf elsewhere."""
    leaves: Float[np.ndarray, "h w"]
    """Where it leaves the hull; -inf elsewhere."""
    deepest: Float[np.ndarray, "h w"]
    """How deep it comes below the hull's faces; -inf elsewhere."""
    surface: Float[np.ndarray, "h w"]
    """Confirmed surface of the object, the median of the pixel's rays; inf unless most of them meet it."""
    faces_camera: Bool[np.ndarray, "h w"]
    """That surface was measured from the side that the camera stands on; else it may be the far side of the part."""
    farthest_surface: Float[np.ndarray, "h w"]
    """The farthest that any of its rays meets; inf unless all of them do."""
    disparity_slope: Float[np.ndarray, "h w"]
    """Change of the hull's disparity from pixel to pixel [px per px]; a neighbour that is not covered counts for
    nothing."""
    end_height: Float[np.ndarray, "h w"]
    """World z of what was measured [m]; NaN where nothing was."""


def object_pixels(
    burst: DepthBurst, model: Model, hull: ObjectHull, parameters: Parameters, settings: RobustSettings
) -> ObjectPixels:
    """All pixels of a burst before a model that holds it."""
    directions = burst.intrinsics.pixel_directions()
    stretch = np.linalg.norm(directions, axis=-1)
    shape = stretch.shape
    rays = burst.T_world_cam.rotation.apply((directions / stretch[..., None]).reshape(-1, 3)).reshape(*shape, 3)
    lengths = burst.median_depth(parameters.invalid_share) * stretch
    covered = hull.covered(burst.intrinsics, burst.T_world_cam)
    entry, leaves, deepest = np.full(shape, np.inf), np.full(shape, -np.inf), np.full(shape, -np.inf)
    entry[covered], leaves[covered], deepest[covered] = hull.crossed(burst.T_world_cam.translation, rays[covered])
    surface, farthest = _confirmed(burst, model, covered, leaves, parameters)
    end = burst.T_world_cam.translation[2] + lengths * rays[..., 2]
    return ObjectPixels(
        rays=rays,
        lengths=lengths,
        covered=covered,
        entry=entry,
        leaves=leaves,
        deepest=deepest,
        surface=surface,
        faces_camera=_measured_from_here(model, burst.T_world_cam.translation, rays, surface, settings),
        farthest_surface=farthest,
        disparity_slope=_slope(stretch / entry * burst.intrinsics.fx * settings.baseline),
        end_height=np.where(lengths > 0, end, np.nan),
    )


def _confirmed(
    burst: DepthBurst,
    model: Model,
    covered: Bool[np.ndarray, "h w"],
    leaves: Float[np.ndarray, "h w"],
    parameters: Parameters,
) -> tuple[Float[np.ndarray, "h w"], Float[np.ndarray, "h w"]]:
    """Median and farthest length at which the covered pixels' rays meet confirmed surface above the table, up to a
    voxel behind the hull."""
    grid, i = with_scans(model.voxel_map), burst.intrinsics
    median, farthest = np.full(covered.shape, np.inf), np.full(covered.shape, np.inf)
    v, u = np.nonzero(covered)
    across, down = (np.array(OFFSETS)[:, None, axis] for axis in (0, 1))  # (k, 1)
    camera = np.stack(np.broadcast_arrays((u + across - i.cx) / i.fx, (v + down - i.cy) / i.fy, 1.0), axis=-1)
    rays = burst.T_world_cam.rotation.apply(
        camera.reshape(-1, 3) / np.linalg.norm(camera.reshape(-1, 3), axis=1)[:, None]
    )
    eye = burst.T_world_cam.translation
    origins = np.tile(cells_of(eye[None], grid.first, grid.voxel_size), (len(rays), 1))
    reach = np.tile(leaves[covered] + grid.voxel_size, len(OFFSETS))
    found = first_surfaces(grid.surface, origins, rays / grid.voxel_size, GRAZING, reach)[0]
    above = eye[2] + np.where(np.isfinite(found), found, 0.0) * rays[:, 2]
    found[above <= parameters.table_height + parameters.table_clearance] = np.inf
    found = np.sort(found.reshape(len(OFFSETS), -1), axis=0)  # rays that meet none come last
    median[covered], farthest[covered] = found[len(OFFSETS) // 2], found[-1]
    return median, farthest


def _measured_from_here(
    model: Model,
    eye: Float[np.ndarray, "3"],
    rays: Float[np.ndarray, "h w 3"],
    surface: Float[np.ndarray, "h w"],
    settings: RobustSettings,
) -> Bool[np.ndarray, "h w"]:
    """Pixels whose surface some scan measured that stood on the same side of it."""
    grid, met = with_scans(model.voxel_map), np.isfinite(surface)
    points = eye + surface[met][:, None] * rays[met]
    normals = grid.normals_at(points)
    side = np.einsum("nk,nk->n", normals, eye - points)
    tolerance, facing = settings.contradiction_voxels * grid.voxel_size, np.zeros(len(points), bool)
    for scan in grid.scans:
        camera = scan.T_world_cam.inv().apply(points)
        u, v = np.rint(np.nan_to_num(project(camera, scan.intrinsics), nan=-1.0)).astype(np.int64).T
        seen = (u >= 0) & (u < scan.intrinsics.width) & (v >= 0) & (v < scan.intrinsics.height)
        measured = scan.lengths[np.where(seen, v * scan.intrinsics.width + u, 0)]
        hit = seen & (np.abs(measured - np.linalg.norm(camera, axis=1)) < tolerance)
        facing |= hit & (side * np.einsum("nk,nk->n", normals, scan.T_world_cam.translation - points) > 0)
    found = np.zeros(met.shape, bool)
    found[met] = facing
    return found


def _slope(disparity: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    """Magnitude of the change to a neighbour; 0 disparity is outside the hull and counts for nothing."""
    return np.hypot(_step_along_rows(disparity), _step_along_rows(disparity.T).T)


def _step_along_rows(disparity: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    step = np.abs(np.diff(disparity, axis=1))
    step[(disparity[:, 1:] == 0) | (disparity[:, :-1] == 0)] = 0.0
    padded = np.pad(step, ((0, 0), (1, 1)))
    return np.maximum(padded[:, 1:], padded[:, :-1])
