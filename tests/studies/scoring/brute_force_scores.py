"""The scores of detection and recovery once more, slowly: pixel by pixel and pair by pair, from their definitions.

Nothing of the code under test is used. Inputs are what a frame and the detector gave (label codes, true depth,
incidence and normals, masks, points, boxes, bursts), and the camera's numbers, which stand here again: 640x360,
f = 321 px, blocks of 8 x 8, of which the middle 60 x 40 are kept.
"""

from itertools import pairwise
from math import acos, cos, degrees, dist, isfinite, isnan, sqrt
from statistics import median
from typing import Any

import numpy as np

F, CX, CY = 321.0, 319.5, 179.5
BLOCK, LEFT, TOP, WIDTH, HEIGHT = 8, 80, 16, 60, 40
REFLECTION = {8, 9, 10, 11}
"""Label codes of the sub-kinds of reflection: dark, saturated, disagreeing, interreflection."""
MEASURED = 0
TOLERANCE = 0.005
"""Surface is regained within this distance of a point [m] (the paper's)."""
LEAST_COSINE = 0.02
Areas = dict[str, float]


def sources(v: int, u: int) -> list[tuple[int, int]]:
    """Full-resolution pixels (v, u) of a decimated one."""
    rows, columns = range(BLOCK), range(BLOCK)
    return [(TOP + v * BLOCK + i, LEFT + u * BLOCK + j) for i in rows for j in columns]


def stages(labels: Any, detection: Any) -> dict[str, tuple[int, ...]]:
    """Found, true and both after each filter and all before it, then after location and clustering."""
    clustered = {
        (v, u) for (u, v), k in zip(detection.pixels.tolist(), detection.labels.tolist(), strict=True) if k >= 0
    }
    names = [*detection.masks, "located", "in a region"]
    counts = {name: [0, 0, 0] for name in names}
    for v in range(HEIGHT):
        for u in range(WIDTH):
            true = int(labels.cause_decimated[v, u]) in REFLECTION
            kept = True
            for name in names:
                if name in detection.masks:
                    kept = kept and bool(detection.masks[name][v, u])
                else:
                    kept = bool(detection.retained[v, u]) if name == "located" else (v, u) in clustered
                counts[name][0] += kept
                counts[name][1] += true
                counts[name][2] += kept and true
    return {name: tuple(values) for name, values in counts.items()}


def fates(labels: Any) -> dict[str, tuple[int, ...]]:
    """What becomes of reflective holes and of false depths: pixels in blocks without, with false, with right depth."""
    found = {"holes": [0, 0, 0], "false": [0, 0, 0]}
    for v in range(HEIGHT):
        for u in range(WIDTH):
            lost = int(labels.cause_decimated[v, u]) != MEASURED
            place = 0 if lost else 1 if labels.false_decimated[v, u] else 2
            for pixel in sources(v, u):
                found["holes"][place] += int(labels.cause[pixel]) in REFLECTION
                found["false"][place] += bool(labels.false_by_reflection[pixel])
    return {name: tuple(values) for name, values in found.items()}


def patches(labels: Any) -> list[list[tuple[int, int]]]:
    """Connected reflective holes, by flood fill over sides and corners; of each its reflective source pixels."""
    left = {(v, u) for v in range(HEIGHT) for u in range(WIDTH) if int(labels.cause_decimated[v, u]) in REFLECTION}
    found = []
    while left:
        front, component = [left.pop()], []
        while front:
            v, u = front.pop()
            component.append((v, u))
            near = {(v + i, u + j) for i in (-1, 0, 1) for j in (-1, 0, 1)} & left
            left -= near
            front += near
        found.append([p for v, u in component for p in sources(v, u) if int(labels.cause[p]) in REFLECTION])
    return found


def element(truth: Any, pose: Any, v: int, u: int) -> tuple[np.ndarray, float]:
    """World point and area [m^2] of the surface behind a pixel: its solid angle times distance squared over cosine."""
    ray = np.array([(u - CX) / F, (v - CY) / F, 1.0])
    length, depth = sqrt(float(ray @ ray)), float(truth.depth[v, u])
    incidence = float(truth.incidence[v, u])
    cosine = max(cos(0.0 if isnan(incidence) else incidence), LEAST_COSINE)
    solid_angle = 1 / (F * F * length**3)
    return pose.apply(depth * ray), solid_angle * (depth * length) ** 2 / cosine


def regions(
    truth: Any, pose: Any, labels: Any, detection: Any
) -> tuple[list[dict[str, float]], list[dict[str, float]]]:
    """Areas of each box and of the missing patch that it overlaps best; and of each patch, with its share in boxes."""
    elements = {p: element(truth, pose, *p) for v in range(HEIGHT) for u in range(WIDTH) for p in sources(v, u)}
    inside = [{p for p, (point, _) in elements.items() if in_box(box, point)} for box in detection.boxes]

    def area(pixels: Any) -> float:
        return sum(elements[p][1] for p in pixels)

    missing = [set(patch) for patch in patches(labels)]
    boxes = []
    for k, box in enumerate(inside):
        best = {"found": area(box), "patch": 0.0, "both": 0.0, "iou": 0.0}
        for patch in missing:
            both = area(box & patch)
            iou = both / (area(box) + area(patch) - both) if both > 0 else 0.0
            if iou > best["iou"]:
                best |= {"patch": area(patch), "both": both, "iou": iou}
        boxes.append(best | {"in_front": in_front(truth, pose, detection, k)})
    covered = set().union(*inside)
    return boxes, [{"area": area(patch), "found": area(patch & covered)} for patch in missing]


def in_box(box: Any, point: np.ndarray) -> bool:
    """Whether a point lies in a box, on its surface to 1 nm included."""
    along = [abs(float(axis @ (point - box.centre))) for axis in box.axes.T]
    return all(a <= half + 1e-9 for a, half in zip(along, box.half_extents.tolist(), strict=True))


def in_front(truth: Any, pose: Any, detection: Any, k: int) -> float:
    """Median over a region's points of their distance before the mean true depth of their pixel, along the ray [m]."""
    offsets = []
    for (u, v), point, label in zip(
        detection.pixels.tolist(), detection.points, detection.labels.tolist(), strict=True
    ):
        depths = [float(truth.depth[p]) for p in sources(v, u) if truth.depth[p] > 0]
        if label != k or not depths:
            continue
        x, y, z = pose.inv().apply(point)
        offsets.append((sum(depths) / len(depths) - z) * sqrt((x / z) ** 2 + (y / z) ** 2 + 1))
    return median(offsets) if offsets else float("nan")


def points_of(burst: Any) -> list[np.ndarray]:
    """World points of a burst: the median of each pixel's valid frames, if more than half of them are valid."""
    found, k, n = [], burst.intrinsics, len(burst.depths)
    for v in range(burst.depths.shape[1]):
        for u in range(burst.depths.shape[2]):
            valid = [float(z) for z in burst.depths[:, v, u] if z > 0]
            if 2 * (n - len(valid)) < n:
                z = median(valid)
                found.append(burst.T_world_cam.apply(np.array([(u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z])))
    return found


def regained(surface: Any, bursts: list[Any]) -> float:
    """Share of the area whose element has a measured point within TOLERANCE, by trying all pairs."""
    cloud = [tuple(p) for burst in bursts for p in points_of(burst)]
    cells: dict[tuple[int, ...], list] = {}
    for p in cloud:
        cells.setdefault(tuple(int(x // TOLERANCE) for x in p), []).append(p)
    total = sum(
        float(area)
        for point, area in zip(surface.points, surface.areas, strict=True)
        if any(dist(point, p) <= TOLERANCE for p in _around(cells, point))
    )
    return total / float(surface.areas.sum())


def _around(cells: dict[tuple[int, ...], list], point: np.ndarray) -> list:
    """Points in the cube of 27 cells about a point: all that can lie within TOLERANCE, and more."""
    x, y, z = (int(c // TOLERANCE) for c in point)
    steps = (-1, 0, 1)
    return [p for i in steps for j in steps for k in steps for p in cells.get((x + i, y + j, z + k), [])]


def mean_angles(surface: Any, before: Any, now: Any) -> tuple[float, float]:
    """Mean incidence in a view and mean angle between the rays of two views [deg], weighted by area."""
    incidence = turn = 0.0
    for point, normal, area in zip(surface.points, surface.normals, surface.areas, strict=True):
        rays = [(pose.translation - point) / dist(pose.translation, point) for pose in (now, before)]
        incidence += area * degrees(acos(min(1.0, max(-1.0, float(rays[0] @ normal)))))
        turn += area * degrees(acos(min(1.0, max(-1.0, float(rays[0] @ rays[1])))))
    return incidence / float(surface.areas.sum()), turn / float(surface.areas.sum())


def lost_between(counts: dict[str, tuple[int, ...]]) -> dict[str, int]:
    """Reflective pixels that each stage loses."""
    return {name: before[2] - now[2] for (_, before), (name, now) in pairwise(counts.items())}


def same(mine: float, theirs: float, tolerance: float = 1e-6) -> bool:
    """Equal to a millionth, relative or absolute; both undefined is equal too."""
    if not (isfinite(mine) and isfinite(theirs)):
        return isnan(mine) and isnan(theirs)
    return abs(mine - theirs) <= tolerance * max(1.0, abs(mine))
