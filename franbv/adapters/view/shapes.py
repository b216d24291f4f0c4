"""The planner's geometry in the viewer's terms: centres, half sizes and quaternions."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.ellipsoids import Ellipsoids
from franbv.geometry.oriented_box import OrientedBox

PlacedShapes = tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"], Float[np.ndarray, "n 4"]]
"""Centres [m], half sizes [m], orientations as quaternions x, y, z, w."""


def placed_ellipsoids(ellipsoids: Ellipsoids) -> PlacedShapes:
    """Semi-axes are the roots of the eigenvalues of S; its eigenvectors are turned to a right-handed frame."""
    squares, axes = np.linalg.eigh(ellipsoids.shapes)
    axes[..., 0] *= np.sign(np.linalg.det(axes))[:, None]
    return ellipsoids.centres, np.sqrt(squares), _quaternions(axes)


def placed_boxes(boxes: Sequence[OrientedBox]) -> PlacedShapes:
    """As the boxes have it: their axes are right-handed."""
    centres = np.array([box.centre for box in boxes]).reshape(-1, 3)
    half_sizes = np.array([box.half_extents for box in boxes]).reshape(-1, 3)
    return centres, half_sizes, _quaternions(np.array([box.axes for box in boxes]).reshape(-1, 3, 3))


def origins_of(poses: Sequence[RigidTransform]) -> Float[np.ndarray, "n 3"]:
    """Where the cameras stand [m]."""
    return np.array([pose.translation for pose in poses]).reshape(-1, 3)


def lines_of_sight(poses: Sequence[RigidTransform]) -> Float[np.ndarray, "n 3"]:
    """Unit vectors along the optical axes, world frame [-]."""
    return np.array([pose.rotation.as_matrix()[:, 2] for pose in poses]).reshape(-1, 3)


def _quaternions(frames):
    """x, y, z, w of rotation matrices (n, 3, 3); there may be none."""
    return Rotation.from_matrix(frames).as_quat() if len(frames) else np.zeros((0, 4))
