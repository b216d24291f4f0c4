"""The outline of what moves with the camera: its housing, and bracket and wrist behind it, in the camera frame.

The frame is that of the pose, so an outline rolls with a camera that is turned in its mount; the wrist stays behind the
middle of the housing. Distances are from points to the solid, 0 inside.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Float

WRIST_RADIUS = 0.0525
"""Of bracket and wrist [m] (ABB's CAD model of the CRB 15000-12/1.27: radius of link 6)."""
WRIST_LENGTH = 0.15
"""From the back of the housing to the wrist's centre [m]: 0.101 m from flange to axis 5 (ROS-Industrial's model of the
CRB 15000-12/1.27) and a bracket of 5 cm (choice)."""
BALL_MARGIN = 0.006
"""By which the ball around the outline is larger than need be [m] (choice)."""


@dataclass(frozen=True, eq=False)
class CameraBody:
    """A housing and the wrist behind it."""

    box: Float[np.ndarray, "2 3"]
    """Lower and upper corner of the housing [m]."""

    @property
    def middle(self) -> Float[np.ndarray, "2"]:
        """Of the housing, across the optical axis [m]."""
        return self.box.mean(axis=0)[:2]

    @property
    def wrist_axis(self) -> Float[np.ndarray, "2 3"]:
        """Ends of the axis of the capsule that stands for bracket and wrist, behind the middle of the housing [m]
        (choice: the camera looks along the flange axis)."""
        back = self.box[0, 2]
        return np.array([[*self.middle, back - WRIST_RADIUS], [*self.middle, back - WRIST_LENGTH]])

    @property
    def corners(self) -> Float[np.ndarray, "8 3"]:
        """Of the housing [m]."""
        return np.array(list(product(*self.box.T)))

    @property
    def ball_centre(self) -> Float[np.ndarray, "3"]:
        """Centre of a ball around housing, bracket and wrist [m]."""
        return (self.box.mean(axis=0) + self.wrist_axis[1]) / 2

    @property
    def ball_radius(self) -> float:
        """Its radius [m]: of the D435i 140 mm, 134 mm to the end of the wrist, 105 mm to the farthest corner."""
        ends = np.linalg.norm(self.wrist_axis - self.ball_centre, axis=1).max() + WRIST_RADIUS
        return float(max(ends, np.linalg.norm(self.corners - self.ball_centre, axis=1).max())) + BALL_MARGIN

    def box_distance(self, points_cam: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
        """Distance of points from the housing [m]."""
        outside = np.maximum(np.maximum(self.box[0] - points_cam, points_cam - self.box[1]), 0.0)
        return np.linalg.norm(outside, axis=1)

    def wrist_distance(self, points_cam: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
        """Distance of points from the capsule of bracket and wrist [m]."""
        start, end = self.wrist_axis
        axis = end - start
        along = np.clip((points_cam - start) @ axis / (axis @ axis), 0.0, 1.0)
        from_axis = np.linalg.norm(points_cam - start - along[:, None] * axis, axis=1)
        return np.maximum(from_axis - WRIST_RADIUS, 0.0)

    def reach_below(self, roll_deg: float) -> float:
        """How far the housing of a level camera, turned clockwise about its axis, reaches below that axis [m].

        Down in the world is (sin roll, cos roll) in the image.
        """
        roll = np.radians(roll_deg)
        return float((self.corners[:, :2] @ [np.sin(roll), np.cos(roll)]).max())


CAMERA_BODIES = {
    "d435i": CameraBody(np.array([[-0.0275, -0.0125, -0.0207], [0.0625, 0.0125, 0.0043]])),
    "d415": CameraBody(np.array([[-0.0295, -0.0115, -0.01885], [0.0695, 0.0115, 0.0012]])),
}
"""By camera model. D435i: 90 x 25 x 25 mm (D400 datasheet); the left imager is 17.5 mm left of its middle, the depth
origin 4.2 mm behind the glass, which is 0.1 mm behind the front (realsense-ros, D435 model). D415: 99 x 23 x 20.05 mm,
the left imager 20 mm left of its middle (realsense-ros, D415 model), the depth origin 1.1 mm behind the glass (D400
datasheet), the glass as far behind the front as the D435i's (choice)."""
