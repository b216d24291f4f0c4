"""Volumetric information by definition, ray by ray in plain Python: sort all planes that a ray crosses, look up the
voxel in the middle between each two. Shares nothing with the compiled loops but the pose and the map."""

from itertools import pairwise
from math import exp, inf, log

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.volumetric_information import MEETING
from franbv.voxel_map import UNDECIDED, VoxelMap


def plain_information(
    voxel_map: VoxelMap,
    intrinsics: Intrinsics,
    T_world_cam: RigidTransform,
    gain: str,
    box: tuple[tuple[int, ...], tuple[int, ...]] | None = None,
) -> float:
    """Sum over all pixels of one view. box: first and last but one voxel index within which rays are followed."""
    size = voxel_map.voxel_size
    first, last = box or ((0, 0, 0), voxel_map.log_odds.shape)
    origin = [float(x) / size - (int(f) - 0.5) for x, f in zip(T_world_cam.translation, voxel_map.first, strict=True)]
    total = 0.0
    for v in range(intrinsics.height):
        for u in range(intrinsics.width):
            pixel = np.array([(u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy, 1.0])
            ray = [float(x) / size for x in T_world_cam.rotation.apply(pixel)]
            total += ray_gain(voxels_on_ray(voxel_map, origin, ray, first, last), gain)
    return total


def voxels_on_ray(voxel_map, origin, ray, first, last) -> list[float]:
    """Log-odds of the voxels whose inside the ray crosses, in order."""
    begin, end = 0.0, inf
    planes = []
    for o, r, low, high in zip(origin, ray, first, last, strict=True):
        if r == 0.0:
            if not low <= o < high:
                return []
            continue
        crossings = [(plane - o) / r for plane in range(low, high + 1)]
        begin, end = max(begin, min(crossings)), min(end, max(crossings))
        planes += crossings
    if begin >= end:
        return []
    stops = [begin, *sorted(t for t in planes if begin < t < end), end]
    found = []
    for a, b in pairwise(stops):
        if b - a > 1e-12:
            x, y, z = (int((a + b) / 2 * r + o) for o, r in zip(origin, ray, strict=True))
            found.append(float(voxel_map.log_odds[x, y, z]))
    return found


def ray_gain(log_odds: list[float], gain: str) -> float:
    """What the voxels of one ray are worth."""
    reaches, sum_, behind = 1.0, 0.0, False
    for value in log_odds:
        p = 1.0 / (1.0 + exp(-value))
        entropy = -p * log(p) - (1.0 - p) * log(1.0 - p)
        if gain == "rear_side":
            if behind and value == 0.0:
                return 1.0
            behind = value > 0.0
        elif gain == "observable":
            if value > 0.0:
                return sum_
            if value > -UNDECIDED:
                sum_, reaches = sum_ + reaches * log(2.0), reaches * (1.0 - MEETING)
        elif gain == "entropy":
            sum_ += entropy
            if value > 0.0:
                return sum_
        else:
            sum_ += entropy * reaches if gain == "occlusion_aware" or value == 0.0 else 0.0
            reaches *= 1.0 - p
    return sum_
