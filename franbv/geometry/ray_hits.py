"""Where viewing rays meet ellipsoids (paper, eq. (9)); all rays against all ellipsoids at once, in the camera frame."""

import numpy as np
from jaxtyping import Bool, Float


def ray_hits(
    rays: Float[np.ndarray, "n 3"], centres: Float[np.ndarray, "k 3"], shapes: Float[np.ndarray, "k 3 3"]
) -> Bool[np.ndarray, "k n"]:
    """Which rays from the camera, scaled to z = 1, meet which ellipsoids of the camera frame in front of it.

    From outside, a ray meets the ellipsoid if it lies within the cone of its tangents and runs towards it; from inside
    every ray does.
    """
    inverse, polar, power = _metric(centres, shapes)
    cones = polar[:, :, None] * polar[:, None, :] - power[:, None, None] * inverse
    within = _quadratic_form(cones, rays) >= 0.0
    return (within & (polar @ rays.T > 0.0)) | (power <= 0.0)[:, None]


def first_hit_depths(
    rays: Float[np.ndarray, "n 3"], centres: Float[np.ndarray, "k 3"], shapes: Float[np.ndarray, "k 3 3"]
) -> Float[np.ndarray, "k n"]:
    """Z-depth at which each ray from the camera first meets each ellipsoid's surface [m]; inf where it does not.

    rays: in the camera frame, scaled to z = 1. From inside an ellipsoid its surface is met on the way out.
    """
    inverse, polar, power = _metric(centres, shapes)
    # (t ray - c)^T S^-1 (t ray - c) = 1, that is a t^2 - 2 b t + power = 0
    a, b = _quadratic_form(inverse, rays), polar @ rays.T
    discriminant = b * b - a * power[:, None]
    root = np.sqrt(np.maximum(discriminant, 0.0))
    depth = np.where(power[:, None] > 0.0, b - root, b + root) / a
    return np.where((discriminant >= 0.0) & (depth > 0.0), depth, np.inf)


def _metric(centres, shapes):
    """S^-1, S^-1 c, and the power c^T S^-1 c - 1 of the camera's centre, which is positive outside the ellipsoid."""
    inverse = np.linalg.inv(shapes)
    polar = np.einsum("kij,kj->ki", inverse, centres)
    return inverse, polar, np.sum(polar * centres, axis=1) - 1.0


def _quadratic_form(matrices, rays):
    """d^T M d for every symmetric matrix (k, 3, 3) and ray (n, 3): (k, n)."""
    x, y, z = rays.T
    upper = matrices[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] * [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]
    return upper @ np.stack([x * x, y * y, z * z, x * y, x * z, y * z])
