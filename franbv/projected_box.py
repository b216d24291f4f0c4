"""Area A_r of an oriented box in the image: the convex hull of its projected corners (paper, section V-B)."""

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.oriented_box import OrientedBox
from franbv.projection import NEAR, cross, image_corners

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


def convex_hull(points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "m 2"]:
    """Vertices of the convex hull in order (Andrew 1979); flat and single-point sets give what is left of them."""
    points = points[np.lexsort(points.T[::-1])]
    chain: list[np.ndarray] = []
    for pass_points in (points, points[::-1]):
        floor = len(chain)
        for point in pass_points:
            while len(chain) >= floor + 2 and cross(chain[-1] - chain[-2], point - chain[-2]) <= 0.0:
                chain.pop()
            chain.append(point)
        chain = chain[:-1]  # where the next pass begins
    return np.array(chain).reshape(-1, 2)


def clipped_polygon(polygon: Float[np.ndarray, "n 2"], intrinsics: Intrinsics) -> Float[np.ndarray, "m 2"]:
    """The part of a convex polygon within the image (Sutherland and Hodgman 1974)."""
    corners = image_corners(intrinsics)
    for corner, along in zip(corners, np.roll(corners, -1, axis=0) - corners, strict=True):
        if len(polygon) == 0:
            break
        inside = cross(along, polygon - corner)  # >= 0 on the image's side of the edge
        following, next_inside = np.roll(polygon, -1, axis=0), np.roll(inside, -1)
        kept: list[np.ndarray] = []
        for p, q, here, there in zip(polygon, following, inside, next_inside, strict=True):
            kept += [p] if here >= 0 else []
            kept += [p + here / (here - there) * (q - p)] if (here >= 0) != (there >= 0) else []
        polygon = np.array(kept).reshape(-1, 2)
    return polygon


def polygon_area(polygon: Float[np.ndarray, "n 2"]) -> float:
    """Area of a simple polygon, by the shoelace formula."""
    return float(0.5 * abs(np.sum(cross(polygon, np.roll(polygon, -1, axis=0)))))
