"""The D4-like matcher's recipe in plain numpy: whole volumes, float64, no streaming. Slow, for small images.

Written from the recipe's words (see `render.matcher.d4.settings`), not from the streaming code.
"""

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from render.matcher.d4.settings import PATHS, D4Settings

MAX_COST = 1023.0


def census_cost(left: UInt8[np.ndarray, "h w"], right: UInt8[np.ndarray, "h w"], n: int) -> Float[np.ndarray, "h w n"]:
    """1023 (1 - exp(-h / 52)) of the Hamming distance of 9 x 9 censuses; that of 80 bits where x - d < 0."""
    h, w = left.shape
    bits = []
    for image in (left, right):
        padded = np.pad(image, 4, mode="edge")
        planes = [padded[dy : dy + h, dx : dx + w] > image for dy in range(9) for dx in range(9) if (dy, dx) != (4, 4)]
        bits.append(np.stack(planes, -1))
    distance = np.full((h, w, n), 80)
    for d in range(min(n, w)):
        distance[:, d:, d] = np.sum(bits[0][:, d:] != bits[1][:, : w - d], axis=-1)
    return MAX_COST * (1 - np.exp(-distance / 52))


def arm(row: Float[np.ndarray, " n"], x: int, step: int, reach: int, shrink: int, threshold: float) -> int:
    """Length of one arm from `x` along a line of pixels in 10-bit units."""
    room = x if step < 0 else len(row) - 1 - x
    length = 0
    while length < min(room, reach + shrink):
        if length >= 1 and abs(row[x + step * (length + 1)] - row[x]) > threshold:
            break
        length += 1
    if length < room:
        length = max(length - shrink, min(1, room))
    return min(length, reach)


def aggregate(cost: Float[np.ndarray, "h w n"], left: UInt8[np.ndarray, "h w"], s: D4Settings) -> np.ndarray:
    """Mean cost over support crosses: along rows first, then along columns, over the pixels in it."""
    if s.arm_blur_px:
        left = np.asarray(cv2.GaussianBlur(left, (0, 0), s.arm_blur_px))
    image = 4.0 * left
    h, w, _ = cost.shape
    row_sum, row_count = np.zeros_like(cost), np.zeros((h, w))
    for y in range(h):
        for x in range(w):
            a, b = (arm(image[y], x, step, s.arm_reach_u, s.arm_shrink_u, s.arm_threshold) for step in (-1, 1))
            row_sum[y, x] = cost[y, x - a : x + b + 1].sum(axis=0)
            row_count[y, x] = a + b + 1
    mean = np.zeros_like(cost)
    for y in range(h):
        for x in range(w):
            a, b = (arm(image[:, x], y, step, s.arm_reach_v, s.arm_shrink_v, s.arm_threshold) for step in (-1, 1))
            mean[y, x] = row_sum[y - a : y + b + 1, x].sum(axis=0) / row_count[y - a : y + b + 1, x].sum()
    return mean


def optimise(cost: Float[np.ndarray, "h w n"], left: np.ndarray, right: np.ndarray, s: D4Settings) -> np.ndarray:
    """Mean of five paths, Hirschmueller (2008) eq. 12, penalties by the edges in both images."""
    h, w, n = cost.shape
    total = np.zeros_like(cost)
    lanes = np.arange(n)
    for dy, dx in ((0, -1), (0, 1), (-1, 0), (-1, -1), (-1, 1)):
        path = np.zeros_like(cost)
        for y in range(h):
            for x in range(w) if dx <= 0 else range(w - 1, -1, -1):
                if y + dy < 0 or not 0 <= x + dx < w:
                    path[y, x] = cost[y, x]
                    continue
                before = path[y + dy, x + dx]
                xr = x - lanes
                seen = (xr >= 0) & (xr + dx >= 0) & (xr + dx < w)
                step_right = np.where(
                    seen, right[y, np.clip(xr, 0, None)] - right[y + dy, np.clip(xr + dx, 0, w - 1)], 0
                )
                edges = (np.abs(step_right) > s.edge_threshold).astype(int)
                edges += abs(left[y, x] - left[y + dy, x + dx]) > s.edge_threshold
                p1, p2 = np.array(s.p1)[edges], np.array(s.p2)[edges]
                beside = np.minimum(np.r_[np.inf, before[:-1]], np.r_[before[1:], np.inf]) + p1
                path[y, x] = cost[y, x] + np.minimum(np.minimum(before, beside), before.min() + p2) - before.min()
        total += path
    return total / PATHS


def v_fit(low: float, centre: float, high: float) -> float:
    """Equiangular fit."""
    span = max(low, high) - centre
    return (low - high) / (2 * span) if span > 0 else 0.0


def winner(totals: Float[np.ndarray, " n"]) -> int:
    """First lowest."""
    return int(np.argmin(totals))


def match_reference(left: np.ndarray, right: np.ndarray, n: int, s: D4Settings) -> Float[np.ndarray, "h w"]:
    """Disparity [px] before the neighbour count, not rounded, 0 = hole."""
    h, w = left.shape
    cost = aggregate(census_cost(left, right, n), left, s)
    totals = optimise(cost, 4.0 * left, 4.0 * right, s)
    from_right = np.zeros((h, w))
    for y in range(h):
        for xr in range(w):
            line = np.array([totals[y, xr + d, d] for d in range(min(n, w - xr))])
            b = winner(line)
            from_right[y, xr] = b + (v_fit(*line[b - 1 : b + 2]) if 0 < b < len(line) - 1 else 0)
    disparity = np.zeros((h, w))
    for y in range(h):
        for x in range(w):
            line = totals[y, x, : min(n, x + 1)]
            b = winner(line)
            valleys = [
                d for d in range(1, len(line) - 1) if abs(d - b) > 1 and line[d] <= min(line[d - 1], line[d + 1])
            ]
            second = min((line[d] for d in valleys), default=np.inf)
            inside = 0 < b < min(n - 1, x)
            fraction = v_fit(*totals[y, x, b - 1 : b + 2]) if inside else 0.0
            if not 1 <= b < n - 1 or second - line[b] < s.second_peak:
                continue
            if abs(from_right[y, x - b] - (b + fraction)) > s.left_right_px:
                continue
            disparity[y, x] = b + (
                _cost_fraction(cost[y, x, : min(n, x + 1)], b) if s.subpixel == "costs" else fraction
            )
    return disparity


def _cost_fraction(costs: Float[np.ndarray, " n"], b: int) -> float:
    c = min((b, b - 1, b + 1), key=lambda d: costs[d] if 0 <= d < len(costs) else np.inf)
    if not 0 < c < len(costs) - 1:
        return 0.0
    low, centre, high = costs[c - 1 : c + 2]
    if low < centre:
        return c - b - 0.5
    if high < centre:
        return c - b + 0.5
    return c - b + v_fit(low, centre, high)
