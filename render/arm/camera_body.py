"""The outline of what moves with the camera: the D435i's housing, and bracket and wrist behind it, in the camera frame.

Distances are from points to the solid, 0 inside.
"""

from itertools import product

import numpy as np
from jaxtyping import Float

CAMERA_BOX = np.array([[-0.0275, -0.0125, -0.0207], [0.0625, 0.0125, 0.0043]])
"""Lower and upper corner of the housing [m]: 90 x 25 x 25 mm (D400 datasheet). The left imager is 17.5 mm left of its
middle, and the depth origin 4.2 mm behind the glass, which is 0.1 mm behind the front (realsense-ros, D435 model)."""
WRIST_RADIUS = 0.0525
"""Of bracket and wrist [m] (ABB's CAD model of the CRB 15000-12/1.27: radius of link 6)."""
WRIST_LENGTH = 0.15
"""From the back of the housing to the wrist's centre [m]: 0.101 m from flange to axis 5 (ROS-Industrial's model of the
CRB 15000-12/1.27) and a bracket of 5 cm (choice)."""
WRIST_AXIS = np.array([[0.0175, 0.0, -0.0207 - WRIST_RADIUS], [0.0175, 0.0, -0.0207 - WRIST_LENGTH]])
"""Ends of the axis of the capsule that stands for bracket and wrist, behind the middle of the housing [m] (choice: the
camera looks along the flange axis)."""
BALL_CENTRE = (CAMERA_BOX.mean(axis=0) + WRIST_AXIS[1]) / 2
"""Centre of a ball around housing, bracket and wrist [m]."""
BALL_RADIUS = 0.14
"""Its radius [m]: 134 mm to the end of the wrist, 105 mm to the farthest corner of the housing."""


def box_corners() -> Float[np.ndarray, "8 3"]:
    """Corners of the housing [m]."""
    return np.array(list(product(*CAMERA_BOX.T)))


def box_distance(points_cam: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
    """Distance of points from the housing [m]."""
    outside = np.maximum(np.maximum(CAMERA_BOX[0] - points_cam, points_cam - CAMERA_BOX[1]), 0.0)
    return np.linalg.norm(outside, axis=1)


def wrist_distance(points_cam: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
    """Distance of points from the capsule of bracket and wrist [m]."""
    start, axis = WRIST_AXIS[0], WRIST_AXIS[1] - WRIST_AXIS[0]
    along = np.clip((points_cam - start) @ axis / (axis @ axis), 0.0, 1.0)
    from_axis = np.linalg.norm(points_cam - start - along[:, None] * axis, axis=1)
    return np.maximum(from_axis - WRIST_RADIUS, 0.0)
