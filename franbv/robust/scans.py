"""A burst as evidence: rays with lengths, and how far each is to be trusted before anything else was seen."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.parameters import Parameters
from franbv.robust.settings import RobustSettings
from franbv.sensing import DepthBurst

OPPOSITE = (((0, 1), (2, 1)), ((1, 0), (1, 2)), ((0, 0), (2, 2)), ((0, 2), (2, 0)))
"""Row and column of opposite neighbours in the 3 x 3 pixels around one."""


@dataclass(frozen=True, eq=False)
class Scan:
    """One burst from one pose."""

    depth: Float[np.ndarray, "h w"]
    """Median of the burst [m], 0 = invalid."""
    trust: Float[np.ndarray, "h w"]
    """In each depth by itself [0, 1]: less at edges and in blocks that mix near and far."""
    cosine: Float[np.ndarray, "h w"]
    """Of the incidence, from the neighbours' depths; 1 where they do not tell."""
    intrinsics: Intrinsics
    T_world_cam: RigidTransform

    @cached_property
    def rays(self) -> Float[np.ndarray, "n 3"]:
        """Unit directions of all pixels, row by row, in the world."""
        rays = self.intrinsics.pixel_directions().reshape(-1, 3)
        return self.T_world_cam.rotation.apply(rays / np.linalg.norm(rays, axis=1, keepdims=True))

    @cached_property
    def lengths(self) -> Float[np.ndarray, "n"]:
        """Along each ray [m]; 0 = invalid."""
        rays = self.intrinsics.pixel_directions().reshape(-1, 3)
        return self.depth.ravel() * np.linalg.norm(rays, axis=1)

    @cached_property
    def turn(self) -> int:
        """Of the camera about its axis, in quarter turns from upright, 0 or 1: half a turn shows the same."""
        return int(quarter_turns(self.T_world_cam))


def scan_of(burst: DepthBurst, parameters: Parameters, settings: RobustSettings) -> Scan:
    """The burst's median depth and what of it is mixed."""
    depth = burst.median_depth(parameters.invalid_share)
    trust = np.where(
        supporting_neighbours(depth, settings.support_step) >= settings.supporting, 1.0, settings.unsupported_trust
    )
    trust[mixed_blocks(depth, settings.mixed_step)] = settings.mixed_trust
    return Scan(depth, trust, incidence_cosines(depth, burst.intrinsics), burst.intrinsics, burst.T_world_cam)


def mixed_blocks(depth: Float[np.ndarray, "h w"], step: float) -> Bool[np.ndarray, "h w"]:
    """Pixels between a nearer and a farther neighbour, each by more than `step` [m], that lie opposite each other.

    Decimation takes the mean of a block, so that one which holds a silhouette lies where nothing is.
    """
    padded = np.pad(depth, 1)
    height, width = depth.shape
    mixed = np.zeros(depth.shape, bool)
    for pair in OPPOSITE:
        one, other = (padded[r : r + height, c : c + width] for r, c in pair)
        near, far = np.minimum(one, other), np.maximum(one, other)
        mixed |= (near > 0) & (near < depth - step) & (far > depth + step)
    return mixed & (depth > 0)


def supporting_neighbours(depth: Float[np.ndarray, "h w"], step: float) -> Int[np.ndarray, "h w"]:
    """How many of each pixel's eight neighbours differ from it by less than `step` [m]; 0 where it has no depth."""
    padded = np.pad(depth, 1)
    height, width = depth.shape
    count = np.zeros(depth.shape, int)
    for r, c in np.ndindex(3, 3):
        neighbour = padded[r : r + height, c : c + width]
        count += (neighbour > 0) & (np.abs(neighbour - depth) < step)
    return np.where(depth > 0, count - 1, 0)  # it supports itself


def incidence_cosines(depth: Float[np.ndarray, "h w"], intrinsics: Intrinsics) -> Float[np.ndarray, "h w"]:
    """Cosine of the incidence of each pixel's ray, from the slopes between opposite neighbours; 1 without them.

    On a plane inverse depth is linear in the image: 1 / Z = a u + b v + c has the normal (a fx, b fy, a cx + b cy + c).
    """
    inverse = np.divide(1.0, depth, out=np.zeros(depth.shape), where=depth > 0)
    known = np.pad(depth > 0, 1)
    padded = np.pad(inverse, 1)
    a, b = (padded[1:-1, 2:] - padded[1:-1, :-2]) / 2, (padded[2:, 1:-1] - padded[:-2, 1:-1]) / 2
    tells = known[1:-1, 2:] & known[1:-1, :-2] & known[2:, 1:-1] & known[:-2, 1:-1] & (depth > 0)
    height, width = depth.shape
    u, v = np.arange(width) - intrinsics.cx, (np.arange(height) - intrinsics.cy)[:, None]
    normal = np.stack([a * intrinsics.fx, b * intrinsics.fy, inverse - a * u - b * v], axis=-1)
    rays = intrinsics.pixel_directions()
    lengths = np.linalg.norm(normal, axis=-1) * np.linalg.norm(rays, axis=-1)
    cosine = np.divide(np.abs(np.sum(normal * rays, axis=-1)), lengths, out=np.ones(depth.shape), where=lengths > 0)
    return np.where(tells, cosine, 1.0)


def quarter_turns(T_world_cam: RigidTransform) -> Int[np.ndarray, "*n"]:
    """Of each pose 0 where the image's x axis is nearer to the horizontal than its y axis, else 1."""
    up = np.abs(T_world_cam.rotation.as_matrix()[..., 2, :2])
    return np.asarray(up[..., 0] > up[..., 1], int)
