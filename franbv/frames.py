"""Camera geometry: intrinsics, poses, projection and back-projection.

Conventions (used everywhere): metres; camera frame x right, y down, z forward (OpenCV); pixel centres at integers;
depth is Z-depth with 0 = invalid; `T_world_cam` maps camera points to world points; world z is up, table top at z = 0.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform, Rotation

N_DISPARITIES = 126
"""Disparities that a D4 chip searches [px] (Intel RealSense D400 datasheet, section 4.4: Min-Z = f B / 126)."""


@dataclass(frozen=True)
class Intrinsics:
    """Pinhole intrinsics without distortion (D400 depth streams are rectified): u = fx x / z + cx, v = fy y / z + cy.

    The K of the paper's P = K [R | t], and the numbers of eq. (10). Skew is left out. Frames as at the head of the
    module.
    """

    width: int
    """Image width [px]."""
    height: int
    """Image height [px]."""
    fx: float
    """Focal length along x [px]."""
    fy: float
    """Focal length along y [px]."""
    cx: float
    """Principal point [px]; the centre of the top left pixel is (0, 0)."""
    cy: float
    """Principal point [px]."""

    @property
    def matrix(self) -> Float[np.ndarray, "3 3"]:
        """Calibration matrix K."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def cropped(self, left: int, top: int, width: int, height: int) -> "Intrinsics":
        """Intrinsics of the window whose top left pixel is (left, top)."""
        return Intrinsics(width, height, self.fx, self.fy, self.cx - left, self.cy - top)

    def pixel_directions(self) -> Float[np.ndarray, "h w 3"]:
        """Viewing direction of every pixel centre in the camera frame, scaled to z = 1."""
        u, v = np.meshgrid(np.arange(self.width), np.arange(self.height))
        return np.stack([(u - self.cx) / self.fx, (v - self.cy) / self.fy, np.ones_like(u, dtype=float)], axis=-1)


def stereo_min_z(focal_baseline: float, disparity_shift: float = 0.0) -> float:
    """Smallest Z-depth that a D4 chip can measure [m]: that of the largest disparity searched, f B / (126 + shift).

    focal_baseline: f B of the stream before decimation [px m]. disparity_shift: where the search begins [px].
    Source: D400 datasheet, Min-Z = f B / 126; `disparityShift` moves the whole search (D400 advanced mode).
    """
    return focal_baseline / (N_DISPARITIES + disparity_shift)


def decimated_intrinsics(intrinsics: Intrinsics, factor: int) -> Intrinsics:
    """librealsense's intrinsics of the decimated stream, padding excluded: all divided by the factor."""
    i = intrinsics
    return Intrinsics(i.width // factor, i.height // factor, i.fx / factor, i.fy / factor, i.cx / factor, i.cy / factor)


def block_centre_intrinsics(intrinsics: Intrinsics, factor: int) -> Intrinsics:
    """Intrinsics for which a decimated pixel looks along the middle of its block."""
    divided = decimated_intrinsics(intrinsics, factor)
    shift = (factor - 1) / (2 * factor)
    return Intrinsics(divided.width, divided.height, divided.fx, divided.fy, divided.cx - shift, divided.cy - shift)


def centre_corner(size: tuple[int, int], inner: tuple[int, int]) -> tuple[int, int]:
    """Left column and top row of the middle `inner` (width, height) of an image of `size`; an odd pixel is left over at
    the right and below."""
    return (size[0] - inner[0]) // 2, (size[1] - inner[1]) // 2


def look_at(
    eye: Float[np.ndarray, "3"], target: Float[np.ndarray, "3"], up: Float[np.ndarray, "3"] | None = None
) -> RigidTransform:
    """Pose T_world_cam of a camera at `eye` whose optical axis meets `target`, image y axis away from `up` (world z).

    Looking straight along `up`, image "up" is world y instead.
    """
    eye, target = np.asarray(eye, float), np.asarray(target, float)
    up = np.array([0.0, 0.0, 1.0]) if up is None else np.asarray(up, float)
    z = target - eye
    distance = np.linalg.norm(z)
    if distance < 1e-9:
        raise ValueError(f"camera position {eye} coincides with its target")
    z = z / distance
    x = np.cross(z, up)
    if np.linalg.norm(x) < 1e-6:
        x = np.cross(z, [0.0, 1.0, 0.0])
    x = x / np.linalg.norm(x)
    return RigidTransform.from_components(eye, Rotation.from_matrix(np.column_stack([x, np.cross(z, x), z])))


def rolled(T_world_cam: RigidTransform, roll_deg: float) -> RigidTransform:
    """The pose of a camera that is turned in its mount about its optical axis, clockwise as the camera looks [deg].

    At 90 deg the image's left border looks up: its x axis points where, upright, its y axis does.
    """
    if roll_deg == 0:
        return T_world_cam  # to the last bit
    return T_world_cam * RigidTransform.from_rotation(Rotation.from_euler("z", roll_deg, degrees=True))


def project(points_cam: Float[np.ndarray, "n 3"], intrinsics: Intrinsics) -> Float[np.ndarray, "n 2"]:
    """Pixel coordinates (u, v) of camera-frame points; points with z <= 0 give NaN."""
    z = np.where(points_cam[:, 2] > 0, points_cam[:, 2], np.nan)
    u = intrinsics.fx * points_cam[:, 0] / z + intrinsics.cx
    v = intrinsics.fy * points_cam[:, 1] / z + intrinsics.cy
    return np.column_stack([u, v])


def back_project(depth: Float[np.ndarray, "h w"], intrinsics: Intrinsics) -> Float[np.ndarray, "n 3"]:
    """Camera-frame points [m] of all pixels with depth > 0, in row-major pixel order."""
    valid = depth > 0
    return intrinsics.pixel_directions()[valid] * depth[valid][:, None]
