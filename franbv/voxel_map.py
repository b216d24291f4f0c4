"""Log-odds occupancy of a voxel grid: free, occupied, uncertain and frontier voxels (paper, section III-A).

The update is OctoMap's (Hornung et al. 2013): per scan each voxel is updated once, a hit outweighs any miss. Rays are
traversed exactly: every voxel but a ray's first is entered through exactly one plane of the grid, so the voxels that a
ray crosses are read off its plane crossings, all rays at once, without sorting and without stepping.
Voxel centres lie at integer multiples of the voxel size, so one layer is centred on the table top.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import maximum_filter
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.parameters import Parameters

UNDECIDED = 1e-5
"""|L| up to which hits and misses have cancelled [-] (choice: far above what float32 rounds in a hundred updates, far
below the weakest update that `Parameters` allow)."""


@dataclass(frozen=True, eq=False)
class VoxelMap:
    """Occupancy of the workspace; an update returns a new map.

    L = ln(p / (1 - p)) of each voxel: L > `threshold` is occupied, L < 0 free, what lies between uncertain (paper,
    section III-A; the update is OctoMap's, Hornung et al. 2013, clamped). Voxels are taken as independent
    and the scene as still. Pixels without depth tell nothing, unless `Parameters.carve_on_missing`. What lies outside
    the grid is lost.
    """

    first: Int[np.ndarray, "3"]
    """Index of the lowest voxel: its centre is first * voxel_size in the world."""
    voxel_size: float
    """s_v [m]."""
    log_odds: Float[np.ndarray, "x y z"]
    """ln(p / (1 - p)) of each voxel, float32 (a run keeps one map per acquisition); 0 where nothing is known."""
    cancelled: Bool[np.ndarray, "x y z"] | None = None
    """Voxels whose hits and misses are equally strong, so that as little is known as of those that no ray has touched;
    None = there is no such voxel."""
    threshold: float = 0.0
    """Log-odds above which a voxel is occupied [-]; up to there from 0 on it is uncertain."""

    @property
    def occupied(self) -> Bool[np.ndarray, "x y z"]:
        """V_o: more likely occupied than not, and than `threshold` asks for."""
        return self.log_odds > self.threshold + UNDECIDED

    @property
    def free(self) -> Bool[np.ndarray, "x y z"]:
        """V_fr: more likely free than not."""
        return self.log_odds < -UNDECIDED

    @property
    def uncertain(self) -> Bool[np.ndarray, "x y z"]:
        """V_u: as likely occupied as free, whether rays have touched it or not; or not occupied surely enough."""
        return (self.log_odds >= -UNDECIDED) & (self.log_odds <= self.threshold + UNDECIDED)

    @property
    def untouched(self) -> Bool[np.ndarray, "x y z"]:
        """Voxels that no ray has met."""
        level = np.abs(self.log_odds) <= UNDECIDED
        return level if self.cancelled is None else level & ~self.cancelled

    @property
    def touched(self) -> Bool[np.ndarray, "x y z"]:
        """Voxels that a ray has met."""
        return ~self.untouched

    def frontier(self, occupied: Bool[np.ndarray, "x y z"] | None = None) -> Bool[np.ndarray, "x y z"]:
        """V_f: uncertain voxels with a free and an occupied voxel among their 26 neighbours.

        occupied: count only these as occupied (those of the object); default all occupied ones.
        """
        occupied = self.occupied if occupied is None else occupied
        frontier = np.zeros(self.log_odds.shape, bool)
        near = extent(occupied, margin=2)  # wide enough for every voxel that touches one, and its own neighbours
        touching = [_touches(occupied[near]), _touches(self.free[near]), self.uncertain[near]]
        frontier[near] = np.logical_and.reduce(touching)
        return frontier

    def centres(self, mask: Bool[np.ndarray, "x y z"]) -> Float[np.ndarray, "n 3"]:
        """Centres of the voxels in the mask, world frame [m], in index order."""
        return (np.argwhere(mask) + self.first) * self.voxel_size

    def indices(self, points: Float[np.ndarray, "n 3"]) -> tuple[Int[np.ndarray, "n 3"], Bool[np.ndarray, "n"]]:
        """Voxel index of each world point, and whether the point lies in the grid at all."""
        index = np.floor(points / self.voxel_size + 0.5).astype(np.int64) - self.first
        return index, np.all((index >= 0) & (index < self.log_odds.shape), axis=1)

    def lookup(self, mask: Bool[np.ndarray, "x y z"], points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, "n"]:
        """Value of the mask at each world point; False outside the grid."""
        index, inside = self.indices(points)
        found = np.zeros(len(points), bool)
        found[inside] = mask[tuple(index[inside].T)]
        return found

    def updated(
        self,
        depth: Float[np.ndarray, "h w"],
        intrinsics: Intrinsics,
        T_world_cam: RigidTransform,
        parameters: Parameters,
    ) -> "VoxelMap":
        """The map after one scan: Z-depth [m], 0 = invalid, taken from the given pose."""
        hit, miss = scan_voxels(self, depth, intrinsics, T_world_cam, parameters.carve_on_missing)
        miss &= ~hit
        log_odds = self.log_odds.copy()
        log_odds[hit] += _logit(parameters.hit_probability)
        log_odds[miss] += _logit(parameters.miss_probability)
        np.clip(log_odds, _logit(parameters.min_probability), _logit(parameters.max_probability), out=log_odds)
        level = np.abs(log_odds) <= UNDECIDED
        log_odds[level] = 0.0  # else rounding would decide
        cancelled = level & (hit | miss | self.touched)
        return replace(self, log_odds=log_odds, cancelled=cancelled if cancelled.any() else None)


def empty_map(parameters: Parameters) -> VoxelMap:
    """The workspace with nothing known."""
    first = np.round(np.array(parameters.workspace_min) / parameters.voxel_size).astype(np.int64)
    last = np.round(np.array(parameters.workspace_max) / parameters.voxel_size).astype(np.int64)
    return VoxelMap(
        first,
        parameters.voxel_size,
        np.zeros(last - first + 1, np.float32),
        threshold=float(_logit(parameters.occupied_probability)),
    )


def extent(mask: Bool[np.ndarray, "x y z"], margin: int = 0) -> tuple[slice, slice, slice]:
    """The smallest part of the grid that holds the mask, `margin` voxels wider on each side; empty for an empty one."""
    slices = []
    for axis in range(3):
        present = np.flatnonzero(mask.any(axis=tuple({0, 1, 2} - {axis})))
        slices.append(slice(max(present[0] - margin, 0), present[-1] + margin + 1) if len(present) else slice(0, 0))
    return slices[0], slices[1], slices[2]


def scan_voxels(
    grid: VoxelMap,
    depth: Float[np.ndarray, "h w"],
    intrinsics: Intrinsics,
    T_world_cam: RigidTransform,
    carve_on_missing: bool = False,
) -> tuple[Bool[np.ndarray, "x y z"], Bool[np.ndarray, "x y z"]]:
    """Voxels in which a ray of the scan ends (hit), and those that one crosses before (miss).

    Neither the voxel that a ray ends in nor the one before it is missed by that ray: depth noise of half a voxel would
    otherwise carve the surface. Rays without depth cross nothing, or with `carve_on_missing` the whole grid.
    """
    origin = T_world_cam.translation / grid.voxel_size + 0.5 - grid.first  # in voxels; voxel i spans [i, i + 1)
    rays = intrinsics.pixel_directions().reshape(-1, 3) @ T_world_cam.rotation.as_matrix().T / grid.voxel_size
    z = np.asarray(depth, float).ravel()  # the rays are scaled so that their parameter is Z-depth
    valid = z > 0
    hit = np.zeros(grid.log_odds.shape, bool)
    end = np.floor(origin + rays[valid] * z[valid, None]).astype(np.int64)
    hit[tuple(end[_in_grid(end, hit.shape)].T)] = True
    stop = np.full(len(z), np.inf if carve_on_missing else -np.inf)
    stop[valid] = _entry_before(origin, rays[valid], end)
    return hit, _crossed(origin, rays, stop, hit.shape)


def _entry_before(origin, rays, end):
    """Ray parameter (n,) at which each ray enters the voxel before the one it ends in; <= 0 if it starts there."""
    forward = rays > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        enters = np.where(rays == 0, -np.inf, (end + ~forward - origin) / rays)  # last plane crossed along each axis
        earlier = np.where(rays == 0, -np.inf, (end + ~forward - np.where(forward, 1, -1) - origin) / rays)
    last = np.argmax(enters, axis=1)[:, None]
    np.put_along_axis(enters, last, np.take_along_axis(earlier, last, axis=1), axis=1)
    return enters.max(axis=1)


def _crossed(origin, rays, stop, shape):
    """Voxels that a ray enters at a parameter in [0, stop), as a mask of the grid."""
    crossed = np.zeros(shape, bool)
    start = np.floor(origin).astype(np.int64)
    if _in_grid(start[None], shape)[0] and np.any(stop > 0):
        crossed[tuple(start)] = True
    begin, end = _within_grid(origin, rays, shape)
    end = np.minimum(end, stop)
    alive = begin < end
    rays, begin, end = rays[alive], begin[alive, None], end[alive, None]
    for axis, others in enumerate(((1, 2), (0, 2), (0, 1))):
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (np.arange(shape[axis] + 1) - origin[axis]) / rays[:, axis, None]  # (n, planes)
            within = (t >= begin) & (t < end)
        (ray, plane), t = np.nonzero(within), t[within]
        index = [plane - (rays[:, axis] < 0)[ray]] * 3  # exact along the axis, where rounding could fall to either side
        for other in others:
            index[other] = (origin[other] + t * rays[ray, other]).astype(np.int64)  # >= 0, so truncation is the floor
            np.minimum(index[other], shape[other] - 1, out=index[other])
        crossed.ravel()[(index[0] * shape[1] + index[1]) * shape[2] + index[2]] = True
    return crossed


def _within_grid(origin, rays, shape):
    """Ray parameters (n,) at which each ray enters and leaves the grid, from 0 on; empty intervals miss it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = -origin / rays, (np.array(shape) - origin) / rays
    along = rays == 0
    outside = along & ((origin < 0) | (origin >= shape))
    near = np.where(along, np.where(outside, np.inf, -np.inf), np.minimum(low, high))
    far = np.where(along, np.inf, np.maximum(low, high))
    return np.maximum(near.max(axis=1), 0.0), far.min(axis=1)


def _in_grid(index, shape):
    return np.all((index >= 0) & (index < shape), axis=1)


def _touches(mask):
    """Voxels with a voxel of the mask among their 26 neighbours or under themselves; outside the grid there is none."""
    return maximum_filter(mask, size=3, mode="constant", cval=False)


def _logit(probability):
    return np.log(probability / (1 - probability))
