"""Ellipsoids in the image: the dual conic P Q^-1 P^T, projected areas and silhouettes (paper, section III-C, eq. (1)).

An ellipsoid that lies wholly in front of the camera projects to an ellipse, whose area within the image has a closed
form. One that surrounds the camera or reaches behind it has no ellipse; its area is counted by casting rays.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform

from franbv.ellipsoids import Ellipsoids
from franbv.frames import Intrinsics
from franbv.geometry.polygons import NEAR, cross, image_corners
from franbv.geometry.ray_hits import ray_hits


def in_camera_frame(
    ellipsoids: Ellipsoids, T_world_cam: RigidTransform
) -> tuple[Float[np.ndarray, "*poses k 3"], Float[np.ndarray, "*poses k 3 3"]]:
    """Centres [m] and shapes [m^2] in the frame of one camera or of a batch of cameras."""
    T_cam_world = T_world_cam.inv().as_matrix()
    R, t = T_cam_world[..., :3, :3], T_cam_world[..., :3, 3]
    centres = ellipsoids.centres @ np.swapaxes(R, -1, -2) + t[..., None, :]
    R = R[..., None, :, :]
    return centres, R @ ellipsoids.shapes @ np.swapaxes(R, -1, -2)


def dual_conics(
    centres: Float[np.ndarray, "*k 3"], shapes: Float[np.ndarray, "*k 3 3"], intrinsics: Intrinsics
) -> Float[np.ndarray, "*k 3 3"]:
    """Phi^-1 = P Q^-1 P^T of ellipsoids in the camera frame, in homogeneous pixels; eq. (1).

    With P = K [I | 0] and the dual quadric Q^-1 = [[S - c c^T, -c], [-c^T, -1]] this is K (S - c c^T) K^T.
    """
    K = intrinsics.matrix
    return K @ (shapes - centres[..., :, None] * centres[..., None, :]) @ K.T


def ellipses(
    conics: Float[np.ndarray, "*k 3 3"],
) -> tuple[Float[np.ndarray, "*k 2"], Float[np.ndarray, "*k 2 2"]]:
    """Centre e and shape E of the ellipse (x - e)^T E^-1 (x - e) <= 1 [px] of each dual conic that is one."""
    scaled = conics / conics[..., 2:, 2:]
    centres = scaled[..., :2, 2]
    return centres, centres[..., :, None] * centres[..., None, :] - scaled[..., :2, :2]


def projected_areas(
    ellipsoids: Ellipsoids, intrinsics: Intrinsics, T_world_cam: RigidTransform, supersampling: int = 4
) -> Float[np.ndarray, "*poses k"]:
    """A_j, the area that each ellipsoid covers in the image by itself [px^2], for one pose or a batch of poses.

    supersampling: rays per pixel side for ellipsoids around the camera or partly behind it; all others are exact.
    """
    centres, shapes = in_camera_frame(ellipsoids, T_world_cam)
    depth, reach = centres[..., 2], np.sqrt(shapes[..., 2, 2])
    in_front = depth - reach > NEAR
    around = ~in_front & (depth + reach > NEAR)
    areas = np.zeros(depth.shape)
    areas[in_front] = ellipse_areas_in_image(
        *ellipses(dual_conics(centres[in_front], shapes[in_front], intrinsics)), intrinsics
    )
    if np.any(around):
        rays = _sub_pixel_directions(intrinsics, supersampling)
        areas[around] = np.mean(ray_hits(rays, centres[around], shapes[around]), axis=1) * (
            intrinsics.width * intrinsics.height
        )
    return areas


def ellipse_areas_in_image(
    centres: Float[np.ndarray, "k 2"], shapes: Float[np.ndarray, "k 2 2"], intrinsics: Intrinsics
) -> Float[np.ndarray, "k"]:
    """Area of each ellipse within the image [px^2]; pi a b where it is not clipped.

    The affine map that makes the ellipse a unit disc makes the image a parallelogram; its overlap with the disc is a
    sum over its four edges of circular sectors and triangles.
    """
    factors = np.linalg.cholesky(shapes)
    corners = np.linalg.solve(factors[:, None], (image_corners(intrinsics) - centres[:, None])[..., None])[..., 0]
    a, b = corners, np.roll(corners, -1, axis=1)  # (k, 4, 2) edges from a to b
    along = b - a
    # |a + t (b - a)| = 1 where the edge enters and leaves the disc; both at the middle where it misses it
    length2 = np.sum(along**2, axis=-1)
    middle = -np.sum(a * along, axis=-1) / length2
    half = np.sqrt(np.maximum(middle**2 - (np.sum(a**2, axis=-1) - 1.0) / length2, 0.0))
    enters = a + np.clip(middle - half, 0.0, 1.0)[..., None] * along
    leaves = a + np.clip(middle + half, 0.0, 1.0)[..., None] * along
    parts = _angle(a, enters) + cross(enters, leaves) + _angle(leaves, b)
    return 0.5 * parts.sum(axis=1) * factors[:, 0, 0] * factors[:, 1, 1]


def silhouette(ellipsoids: Ellipsoids, intrinsics: Intrinsics, T_world_cam: RigidTransform) -> Bool[np.ndarray, "h w"]:
    """I_o, the pixels whose centre lies in the projection of any ellipsoid."""
    hits = ray_hits(intrinsics.pixel_directions().reshape(-1, 3), *in_camera_frame(ellipsoids, T_world_cam))
    return hits.any(axis=0).reshape(intrinsics.height, intrinsics.width)


def _sub_pixel_directions(intrinsics, supersampling):
    """(n, 3) viewing directions of a finer grid of pixels that covers the image."""
    s = supersampling
    fine = Intrinsics(
        intrinsics.width * s,
        intrinsics.height * s,
        intrinsics.fx * s,
        intrinsics.fy * s,
        (intrinsics.cx + 0.5) * s - 0.5,
        (intrinsics.cy + 0.5) * s - 0.5,
    )
    return fine.pixel_directions().reshape(-1, 3)


def _angle(a, b):
    """Signed angle from a to b."""
    return np.arctan2(cross(a, b), np.sum(a * b, axis=-1))
