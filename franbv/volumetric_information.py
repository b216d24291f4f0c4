"""Volumetric information of a view: what its rays may still learn of the map (the ray-cast entropy baseline, RE).

A ray is followed voxel by voxel through the map. Each voxel adds what it is worth, times the chance that the ray gets
there; a view is worth the sum over one ray per pixel. Which voxels are worth what is the gain's affair (Isler et al.,
ICRA 2016; Delmerico et al., Autonomous Robots 2018).
"""

import math
from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float
from numba import njit
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.geometry.oriented_box import OrientedBox
from franbv.geometry.ray_packets import ray_sum
from franbv.voxel_map import UNDECIDED, VoxelMap

Gain = Literal["observable", "occlusion_aware", "unobserved", "entropy", "rear_side"]
"""What a voxel adds to its ray, with P its occupancy and H(P) its entropy [nat]:
- observable: H(P) of uncertain voxels times the chance that the ray observes them (Potthast and Sukhatme, J. Vis.
  Commun. Image Represent. 25, 2014, the paper's [24]): free voxels let it pass, occupied ones end it, and of uncertain
  ones, whose occupancy the map does not know, a model of unseen space says how many it passes: `MEETING`.
- occlusion_aware: H(P) times the product of 1 - P over the voxels before it.
- unobserved: the same, of voxels that were never touched only.
- entropy: H(P) of all voxels up to the first occupied one, that one included.
- rear_side: 1 for the first untouched voxel directly behind an occupied one, and the ray ends."""

GAINS: tuple[Gain, ...] = get_args(Gain)
OBSERVABLE, OCCLUSION_AWARE, UNOBSERVED, ENTROPY = range(4)
"""Their places in it, which compiled code compares."""

DEFAULT_GAIN: Gain = "observable"
"""That of the paper's baseline."""

MEETING = 0.07
"""Share of rays from empty space into a voxel of unseen space that end in it [-]. Choice: a ray into a box meets what
is in it within the box's mean chord, 4 V / S (Cauchy): 0.11 m or 14.5 voxels in the prior box. With the map's 1/2 of an
unknown voxel no ray would look deeper than two of them."""

MEMORY_BITS = 8
"""A map holds few distinct log-odds, sums of hits and misses: the cells of 2^8 are remembered (choice: a map of six
views has forty)."""
SPREAD = 2654435769
"""2^32 over the golden ratio: the highest bits of a number times this are a good place for it (Knuth, The Art of
Computer Programming 3, 6.4)."""

TINY = 1e-30
"""Log-odds that are not zero and tell as little [-] (choice: any that single precision holds)."""


def view_information(
    voxel_map: VoxelMap,
    intrinsics: Intrinsics,
    Ts_world_cam: Sequence[RigidTransform],
    gain: Gain = DEFAULT_GAIN,
    region: OrientedBox | None = None,
) -> Float[np.ndarray, "n"]:
    """Information of each view: sum over its pixels' rays, within the map [nat; for `rear_side` voxels].

    region: rays begin and end where they enter and leave this box (its extent along the world's axes, in whole voxels)
    as if all around it were empty; None = the whole map.
    """
    if gain not in GAINS:
        raise ValueError(f"unknown gain {gain!r}; choose {', '.join(GAINS)}")
    low, high = np.zeros(3, np.int64), np.array(voxel_map.log_odds.shape)
    if region is not None:
        low, high = _extent(voxel_map, region)
    log_odds = voxel_map.log_odds
    if voxel_map.cancelled is not None:  # the loops know an untouched voxel by its zero
        log_odds = np.where(voxel_map.cancelled, np.float32(-TINY), log_odds)
    cells = voxel_cells(log_odds[tuple(map(slice, low, high))], gain, voxel_map.threshold)
    if len(Ts_world_cam) == 0:
        return np.zeros(0)
    origins, axes, columns, rows = view_rays(voxel_map, intrinsics, Ts_world_cam)
    rear_side = gain == "rear_side"
    return np.array([ray_sum(cells, *pose, columns, rows, rear_side) for pose in zip(origins - low, axes, strict=True)])


def view_rays(
    voxel_map: VoxelMap, intrinsics: Intrinsics, Ts_world_cam: Sequence[RigidTransform]
) -> tuple[Float[np.ndarray, "v 3"], Float[np.ndarray, "v 3 3"], Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Where each view stands and its axes, in cells of the whole map; column and row of each pixel at Z = 1."""
    poses = RigidTransform.concatenate(list(Ts_world_cam))
    # The cell of voxel i spans [i + 1, i + 2): the border comes first.
    origins = poses.translation / voxel_map.voxel_size + 1.5 - voxel_map.first
    axes = poses.rotation.as_matrix() / voxel_map.voxel_size
    columns = (np.arange(intrinsics.width) - intrinsics.cx) / intrinsics.fx
    rows = (np.arange(intrinsics.height) - intrinsics.cy) / intrinsics.fy
    return origins, axes, np.tile(columns, len(rows)), np.repeat(rows, len(columns))


def voxel_cells(
    log_odds: Float[np.ndarray, "x y z"], gain: Gain, threshold: float = 0.0
) -> Float[np.ndarray, "x+2 y+2 z+2 2"]:
    """What a ray meets in each voxel: the voxel's worth, and the share of the ray that passes it.

    threshold: log-odds above which a voxel is occupied, as `VoxelMap.threshold`.

    A border of one voxel that lets nothing pass surrounds them. For `rear_side` the second number is 1 in occupied
    voxels, else 0, and -1 in the border.
    """
    cells = np.zeros((*(n + 2 for n in log_odds.shape), 2))
    cells[..., 1] = -1.0 if gain == "rear_side" else 0.0
    log_odds = np.ascontiguousarray(log_odds, np.float32)
    _fill(log_odds, log_odds.view(np.uint32), cells, GAINS.index(gain), threshold + UNDECIDED)
    return cells


def compile_rays() -> None:
    """Compile the loops, or load them compiled: seconds or milliseconds, which no decision should be charged with."""
    grid = VoxelMap(np.zeros(3, np.int64), 1.0, np.zeros((1, 1, 1), np.float32))
    view_information(grid, Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0), [RigidTransform.identity()])


def _extent(voxel_map, region):
    """First and last but one index of the voxels that the box's extent touches, cut to the map, never empty."""
    corners = np.floor(region.corners() / voxel_map.voxel_size + 0.5).astype(np.int64) - voxel_map.first
    low = np.clip(corners.min(axis=0), 0, np.array(voxel_map.log_odds.shape) - 1)
    return low, np.clip(corners.max(axis=0) + 1, low + 1, voxel_map.log_odds.shape)


@njit(nogil=True, cache=True)
def _cell(log_odds, gain, threshold):
    """Worth of a voxel and what lets a ray pass, by the index of the gain. threshold: above it, a voxel is occupied."""
    occupied = 1.0 / (1.0 + math.exp(-log_odds))
    empty = 1.0 / (1.0 + math.exp(log_odds))
    entropy = -occupied * math.log(occupied) - empty * math.log(empty)
    if gain == OBSERVABLE:
        if log_odds > threshold:
            return 0.0, 0.0
        return (0.0, 1.0) if log_odds < -UNDECIDED else (entropy, 1.0 - MEETING)
    if gain == OCCLUSION_AWARE:
        return entropy, empty
    if gain == UNOBSERVED:
        return (entropy if log_odds == 0.0 else 0.0), empty
    if gain == ENTROPY:
        return entropy, (0.0 if log_odds > threshold else 1.0)
    return (1.0 if log_odds == 0.0 else 0.0), (1.0 if log_odds > threshold else 0.0)


@njit(nogil=True, cache=True)
def _fill(log_odds, bits, cells, gain, threshold):
    """Fill the cells of all voxels. bits: the log-odds' own, as unsigned integers."""
    known = np.zeros(1 << MEMORY_BITS, np.uint32)
    numbers = np.zeros((1 << MEMORY_BITS, 2))
    numbers[:, 0], numbers[:, 1] = _cell(0.0, gain, threshold)  # zero has no bits
    for x in range(log_odds.shape[0]):
        for y in range(log_odds.shape[1]):
            for z in range(log_odds.shape[2]):
                own = bits[x, y, z]
                place = np.uint32(own * np.uint32(SPREAD)) >> np.uint32(32 - MEMORY_BITS)
                if known[place] != own:
                    known[place] = own
                    numbers[place] = _cell(np.float64(log_odds[x, y, z]), gain, threshold)
                cells[x + 1, y + 1, z + 1, 0] = numbers[place, 0]
                cells[x + 1, y + 1, z + 1, 1] = numbers[place, 1]
