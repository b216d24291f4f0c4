"""Rays through a grid of voxels, plane by plane (Amanatides and Woo 1987), for evidence that is weighed ray by ray.

Lengths along rays are in metres; origins and directions are in cells, so that voxel i spans [i, i + 1) and a direction
is what a ray passes in one metre.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, Int
from numba import njit

from franbv.voxel_map import extent

GridShape = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class SurfaceGrid:
    """The part of a grid that holds surface, so that rays need not be followed elsewhere."""

    first: Int[np.ndarray, "3"]
    """Cell of the whole grid that this part begins with."""
    normals: Float32[np.ndarray, "x y z 3"]
    """Unit normals of the voxels that hold surface, 0 elsewhere."""
    solid: Bool[np.ndarray, "n"]
    """The voxels that hold surface, in one row."""

    @classmethod
    def of(cls, normals: Float32[np.ndarray, "x y z 3"], solid: Bool[np.ndarray, "x y z"]) -> "SurfaceGrid":
        """Of the whole grid: normals, and the voxels that hold surface."""
        near = extent(solid)
        first, inside = np.array([part.start for part in near]), np.ascontiguousarray(solid[near])
        return cls(first, normals[near] * inside[..., None], inside.reshape(-1))


def first_surfaces(
    surface: SurfaceGrid,
    origins: Float[np.ndarray, "n 3"],
    directions: Float[np.ndarray, "n 3"],
    least_cosine: float,
    reach: Float[np.ndarray, "n"],
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Length at which each ray first meets surface that it does not graze [m], inf where there is none up to `reach`,
    and the cosine there. Origins in cells of the whole grid."""
    lengths, cosines = np.full(len(directions), np.inf), np.zeros(len(directions))
    shape, normals, solid = surface.normals.shape[:3], surface.normals.reshape(-1, 3), surface.solid
    _first_surfaces(shape, origins - surface.first, directions, solid, normals, least_cosine, reach, lengths, cosines)
    return lengths, cosines


def add_evidence(
    shape: GridShape,
    origin: Float[np.ndarray, "3"],
    directions: Float[np.ndarray, "n 3"],
    ends: Float[np.ndarray, "n"],
    crossed: Float[np.ndarray, "n"],
    trust: Float[np.ndarray, "n"],
    hits: Float[np.ndarray, "x y z"],
    passes: Float[np.ndarray, "x y z"],
) -> None:
    """Add one scan: in each voxel the trust of the best ray that ends there, or else of the best one that crosses it.

    ends: length at which a ray ends [m], 0 = has no end; crossed: length up to which it passes [m]. Neither the voxel
    that a ray ends in nor the one before it is crossed by it.
    """
    hit, crossing = np.zeros(math.prod(shape), np.float32), np.zeros(math.prod(shape), np.float32)
    _scan(shape, origin, directions, ends, crossed, trust, hit, crossing)
    hits += hit.reshape(shape)
    passes += np.where(hit > 0, 0.0, crossing).astype(np.float32).reshape(shape)


def cells_of(points: Float[np.ndarray, "n 3"], first: Int[np.ndarray, "3"], voxel_size: float) -> np.ndarray:
    """World points [m] in cells of the grid."""
    return points / voxel_size + 0.5 - first


@njit(nogil=True, cache=True, error_model="numpy")
def _first_surfaces(shape, origins, directions, solid, normals, least_cosine, reach, lengths, cosines):
    for ray in range(len(directions)):
        direction = directions[ray]
        size = math.sqrt(direction[0] ** 2 + direction[1] ** 2 + direction[2] ** 2)
        spacing = abs(1.0 / direction[0]), abs(1.0 / direction[1]), abs(1.0 / direction[2])
        state = _begin(shape, origins[ray], direction)
        while state[0] >= 0 and state[1] < reach[ray]:
            if solid[state[0]]:
                normal = normals[state[0]]
                along = -(normal[0] * direction[0] + normal[1] * direction[1] + normal[2] * direction[2]) / size
                if abs(along) > least_cosine:
                    lengths[ray] = (state[1] + min(state[5], state[6], state[7])) / 2
                    cosines[ray] = abs(along)
                    break
            state = _next(shape, state, direction, spacing)


@njit(nogil=True, cache=True, error_model="numpy")
def _scan(shape, origin, directions, ends, crossed, trust, hit, crossing):
    for ray in range(len(directions)):
        direction = directions[ray]
        stop = max(ends[ray], crossed[ray])
        if stop <= 0.0:
            continue
        end = -1
        if ends[ray] > 0.0:
            end = _cell_at(shape, origin, direction, ends[ray])
            if end >= 0:
                hit[end] = max(hit[end], trust[ray])
        spacing = abs(1.0 / direction[0]), abs(1.0 / direction[1]), abs(1.0 / direction[2])
        state = _begin(shape, origin, direction)
        last = -1  # one behind, since the voxel before the end is not crossed
        while state[0] >= 0 and state[1] < crossed[ray]:
            if state[0] == end:
                break
            if last >= 0:
                crossing[last] = max(crossing[last], trust[ray])
            last = state[0]
            state = _next(shape, state, direction, spacing)
        if state[0] < 0 and last >= 0 and not 0.0 < ends[ray] < min(state[5], state[6], state[7]):  # it goes on outside
            crossing[last] = max(crossing[last], trust[ray])


@njit(nogil=True, error_model="numpy")
def _cell_at(shape, origin, direction, length):
    i = math.floor(origin[0] + length * direction[0])
    j = math.floor(origin[1] + length * direction[1])
    k = math.floor(origin[2] + length * direction[2])
    if i < 0 or j < 0 or k < 0 or i >= shape[0] or j >= shape[1] or k >= shape[2]:
        return -1
    return (i * shape[1] + j) * shape[2] + k


@njit(nogil=True, error_model="numpy")
def _begin(shape, origin, direction):
    """Cell (-1 = none), length at which the ray enters it, its three indices, lengths at the next planes."""
    begin, end = 0.0, math.inf
    for axis in range(3):
        if direction[axis] == 0.0:
            if origin[axis] < 0.0 or origin[axis] >= shape[axis]:
                return -1, 0.0, 0, 0, 0, 0.0, 0.0, 0.0
        else:
            one, other = -origin[axis] / direction[axis], (shape[axis] - origin[axis]) / direction[axis]
            begin, end = max(begin, min(one, other)), min(end, max(one, other))
    if begin >= end:
        return -1, 0.0, 0, 0, 0, 0.0, 0.0, 0.0
    i, tx = _axis(shape[0], origin[0], direction[0], begin)
    j, ty = _axis(shape[1], origin[1], direction[1], begin)
    k, tz = _axis(shape[2], origin[2], direction[2], begin)
    return (i * shape[1] + j) * shape[2] + k, begin, i, j, k, tx, ty, tz


@njit(nogil=True, error_model="numpy")
def _axis(length, origin, direction, begin):
    at = min(max(math.floor(origin + begin * direction), 0), length - 1)
    if direction == 0.0:
        return at, math.inf
    return at, (at + (1 if direction > 0.0 else 0) - origin) / direction


@njit(nogil=True, error_model="numpy")
def _next(shape, state, direction, spacing):
    """spacing: lengths between planes of the three axes."""
    _, _, i, j, k, tx, ty, tz = state
    if tx <= ty and tx <= tz:
        i, at, tx = i + (1 if direction[0] > 0.0 else -1), tx, tx + spacing[0]
    elif ty <= tz:
        j, at, ty = j + (1 if direction[1] > 0.0 else -1), ty, ty + spacing[1]
    else:
        k, at, tz = k + (1 if direction[2] > 0.0 else -1), tz, tz + spacing[2]
    if i < 0 or j < 0 or k < 0 or i >= shape[0] or j >= shape[1] or k >= shape[2]:
        return -1, at, i, j, k, tx, ty, tz
    return (i * shape[1] + j) * shape[2] + k, at, i, j, k, tx, ty, tz
