"""Area A_r of an oriented box in the image: the convex hull of its projected corners (paper, section V-B)."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.geometry.oriented_box import OrientedBox
from franbv.geometry.polygons import NEAR, clipped_polygon, convex_hull, polygon_area

BOX_EDGES = np.array([(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit])
"""Pairs of corners: those of `OrientedBox.corners` whose signs, read as binary digits, differ in one."""


def projected_box_area(region: OrientedBox, intrinsics: Intrinsics, T_world_cam: RigidTransform) -> float:
    """A_r, the area of the convex hull of the box's projected corners within the image [px^2].

    Where the box reaches behind the camera, the part in front of it is projected.
    """
    corners = T_world_cam.inv().apply(region.corners())
    start, end = corners[BOX_EDGES[:, 0]], corners[BOX_EDGES[:, 1]]
    crossing = (start[:, 2] > NEAR) != (end[:, 2] > NEAR)
    share = (NEAR - start[crossing, 2]) / (end[crossing, 2] - start[crossing, 2])
    cut = start[crossing] + share[:, None] * (end[crossing] - start[crossing])
    visible = np.concatenate([corners[corners[:, 2] > NEAR], cut])
    pixels = visible @ intrinsics.matrix.T
    return polygon_area(clipped_polygon(convex_hull(pixels[:, :2] / pixels[:, 2:]), intrinsics))
