"""Polygons to triangles: a fan where it covers the polygon, else ears are clipped (Meisters 1975).

A fan from the first corner closes the notch of a concave polygon; trimesh does so in OBJ and PLY (its issue 2519).
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float, Int

FLAT = 1e-9
"""Triangles below this share of the polygon's area have none: rounding (choice, far above that of doubles)."""
MAX_CORNERS = 5_000
"""Of a concave polygon [-] (choice: the work grows with the square, this many take 4 s)."""
CROSSED = "its outline crosses or folds over itself"
TOO_MANY = f"it is concave with more than {MAX_CORNERS} corners"
"""Why a polygon cannot be cut."""


def triangulated(
    points: Float[np.ndarray, "n 3"],
    corners: Int[np.ndarray, "c"],
    counts: Int[np.ndarray, "p"],
    refused: Callable[[int, str], Exception],
) -> tuple[Int[np.ndarray, "m 3"], Int[np.ndarray, "m"]]:
    """Triangles of p polygons, in their order, and the polygon of each.

    corners: vertex indices of all polygons, one after another; counts: corners of each, 3 or more.
    refused: makes the error for a polygon that cannot be cut, of its number and the reason.
    """
    starts = np.cumsum(counts) - counts
    pieces: list[np.ndarray] = []
    owners: list[np.ndarray] = []
    for count in np.unique(counts).tolist():
        polygons = np.flatnonzero(counts == count)
        loops = corners[starts[polygons][:, None] + np.arange(count)]
        good = np.ones(len(loops), bool) if count == 3 else _fan_covers(points[loops])
        pieces.append(loops[good][:, _fan(count)].reshape(-1, 3))
        owners.append(np.repeat(polygons[good], count - 2))
        for polygon, loop in zip(polygons[~good], loops[~good], strict=True):
            clipped = _clipped_ears(points[loop])
            if clipped is None:
                raise refused(int(polygon), CROSSED if count <= MAX_CORNERS else TOO_MANY)
            pieces.append(loop[clipped])
            owners.append(np.full(len(clipped), polygon))
    if not pieces:
        return np.zeros((0, 3), np.int64), np.zeros(0, np.int64)
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(pieces)[order], owner[order]


def _fan(count: int) -> Int[np.ndarray, "k 3"]:
    second = np.arange(1, count - 1)
    return np.column_stack([np.zeros_like(second), second, second + 1])


@np.errstate(all="ignore")  # coordinates that are not finite are reported later, by body
def _fan_covers(loops: Float[np.ndarray, "p k 3"]) -> Bool[np.ndarray, "p"]:
    """Whether no triangle of the fan looks away from the polygon: then the fan covers the outline once.

    The signed areas of any fan sum to the polygon's; with none below zero nothing is covered twice.
    """
    spokes = loops[:, 1:] - loops[:, :1]
    areas = np.cross(spokes[:, :-1], spokes[:, 1:])  # (p, k - 2, 3), twice each triangle's
    sizes = np.linalg.norm(areas, axis=2).sum(axis=1)
    total = areas.sum(axis=1)
    size = np.linalg.norm(total, axis=1)
    along = np.einsum("pij,pj->pi", areas, total / np.where(size > 0, size, 1)[:, None])
    forward = (along >= -FLAT * size[:, None]).all(axis=1) & (size > FLAT * sizes)
    extent = np.square(np.ptp(loops, axis=1)).sum(axis=1)
    lines = sizes <= FLAT * extent  # without area, whichever way it is cut
    return forward | lines | ~np.isfinite(loops).all(axis=(1, 2))


@np.errstate(all="ignore")
def _clipped_ears(loop: Float[np.ndarray, "k 3"]) -> Int[np.ndarray, "m 3"] | None:
    """Triangles of one polygon, in the plane of its vector area (Newell); None if it crosses or folds over itself."""
    if len(loop) > MAX_CORNERS:
        return None
    centred = loop - loop.mean(axis=0)
    normal = np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0)
    length = float(np.linalg.norm(normal))
    if not length > FLAT * np.square(np.ptp(loop, axis=0)).sum():
        return None
    flat = centred @ _plane(normal / length)
    left = list(range(len(loop)))
    triangles: list[tuple[int, int, int]] = []
    tolerance = FLAT * length
    start = 0
    while len(left) > 3:
        ear = next((i for i in _round(len(left), start) if _is_ear(flat, left, i, tolerance)), None)
        if ear is None:
            return None
        triangles.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
        start = ear - 1
    triangles.append((left[0], left[1], left[2]))
    found = np.array(triangles)
    areas = _cross2(flat[found[:, 1]] - flat[found[:, 0]], flat[found[:, 2]] - flat[found[:, 0]])
    return found if areas.min() >= -tolerance and abs(areas.sum() - length) <= 1e-6 * length else None


def _round(count: int, start: int) -> list[int]:
    """All corners, from `start` on."""
    return [(i + start) % count for i in range(count)]


def _plane(normal: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 2"]:
    """Two axes of the plane, so that counter-clockwise round the normal stays counter-clockwise."""
    helper = np.eye(3)[np.argmin(np.abs(normal))]
    first = np.cross(helper, normal)
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(normal, first)])


def _is_ear(flat: Float[np.ndarray, "k 2"], left: list[int], i: int, tolerance: float) -> bool:
    """Whether the corner is convex and no other corner lies in its triangle, or corners beside it are one point."""
    a, b, c = flat[left[i - 1]], flat[left[i]], flat[left[(i + 1) % len(left)]]
    area = _cross2(b - a, c - a)
    if area < -tolerance:
        return False
    if area <= tolerance:  # a corner on a straight line, or a spike of a bridge to a hole
        return bool(np.array_equal(a, b) or np.array_equal(b, c) or np.dot(b - a, c - b) >= 0)
    others = flat[left]
    inside = (_cross2(b - a, others - a) >= 0) & (_cross2(c - b, others - b) >= 0) & (_cross2(a - c, others - c) >= 0)
    corner = (others == a).all(axis=1) | (others == b).all(axis=1) | (others == c).all(axis=1)
    return not bool(np.any(inside & ~corner))


def _cross2(u: np.ndarray, v: np.ndarray):
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
