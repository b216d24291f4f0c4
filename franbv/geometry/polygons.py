"""Polygons in the image: the image's own outline, convex hulls, clipping, areas."""

import numpy as np
from jaxtyping import Float

from franbv.frames import Intrinsics

NEAR = 1e-3
"""What is closer to the camera's plane than this is cut off [m]. Choice: the lens is thicker."""


def image_corners(intrinsics: Intrinsics) -> Float[np.ndarray, "4 2"]:
    """Corners of the image [px], in the sense that turns x towards y; pixel centres are at integers."""
    right, bottom = intrinsics.width - 0.5, intrinsics.height - 0.5
    return np.array([[-0.5, -0.5], [right, -0.5], [right, bottom], [-0.5, bottom]])


def cross(a: Float[np.ndarray, "*#n 2"], b: Float[np.ndarray, "*#n 2"]) -> Float[np.ndarray, "*#n"]:
    """Cross product of plane vectors, positive where b lies on the side of a towards which x turns to y."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


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
