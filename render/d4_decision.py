"""Which winners the D4-like matcher keeps, and their sub-pixel disparity.

Left-right check and second peak decide pixel by pixel; then a pixel needs enough neighbours that agree with it.
Disparities here are whole numbers of 1/32 px, as in the chip.
"""

from dataclasses import dataclass
from typing import no_type_check

import cv2
import numpy as np
from jaxtyping import Int16, UInt16

from render.compiled import compiled
from render.d4_settings import PATHS, D4Settings
from render.matcher import SUBPIXEL_STEPS

NO_COST = np.int16(32767)
"""Marks lanes outside the search in `Evidence`."""

OUTSIDE = np.int16(-30000)
"""Winning lane of a pixel that takes no part: more than one lane from any other."""

HOLE = np.int16(-12000)
"""Stands for a hole where neighbours are compared: farther from any disparity than any tolerance."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the streaming core found, as 16-bit planes."""

    left: Int16[np.ndarray, "9 h w"]
    """Per left pixel: winning lane; rise of the path sums to the second peak; rise of the path sums to the lane below
    and above the winner (-1: none); aggregated costs of the five lanes around the winner (32767: none)."""
    right: Int16[np.ndarray, "3 h stride"]
    """Per right column, reversed: winning lane; rise of the path sums to the lane below and above it (-1: none)."""
    ahead: int
    """Left column k in lane d looks at reversed right column ahead - k + d."""


@no_type_check
@compiled
def _fraction(rise_below, rise_above, parabola):
    """Where between -1/2 and 1/2 the minimum of three samples lies: equiangular (V) fit, or parabola [px]."""
    below, above = np.float32(rise_below), np.float32(rise_above)
    span = below + above if parabola else max(below, above)
    return (below - above) / (np.float32(2) * span) if span > 0 else np.float32(0)


@no_type_check
@compiled
def _cost_minimum(costs):
    """Minimum of the aggregated costs near the winner, relative to it [px]: V fit around the lowest of three lanes."""
    lowest = 2
    for d in (1, 3):
        if costs[d] < costs[lowest]:
            lowest = d
    below, above = costs[lowest - 1], costs[lowest + 1]
    if below == 32767 or above == 32767:
        return np.float32(0)
    rise_below, rise_above = np.int32(below) - costs[lowest], np.int32(above) - costs[lowest]
    # Where the costs fall on beyond the neighbouring lane, the paths hold the winner back by more than a pixel.
    if rise_below < 0:
        return np.float32(lowest - 2.5)
    if rise_above < 0:
        return np.float32(lowest - 1.5)
    return np.float32(lowest - 2) + _fraction(rise_below, rise_above, False)


@no_type_check
@compiled
def _select(left, right, ahead, wanted, second_peak, left_right, fit_costs, parabola, found):
    _, h, w = left.shape
    for y in range(h):
        for k in range(w):
            best = left[0, y, k]
            if best < 1 or best >= wanted - 1 or left[1, y, k] < second_peak:
                continue
            fraction = _fraction(left[2, y, k], left[3, y, k], parabola)
            j = ahead - k + best
            seen_from_right = right[0, y, j] + _fraction(right[1, y, j], right[2, y, j], False)
            if abs(seen_from_right - (best + fraction)) > left_right:
                continue
            if fit_costs:
                fraction = _cost_minimum(left[4:9, y, k])
            found[y, k] = np.int16(np.floor((best + fraction) * np.float32(32) + np.float32(0.5)))


@no_type_check
@compiled
def _add_surface_costs(reference, lanes, planes, radius, sums):
    """Sum the costs of lanes reference - 1, reference, reference + 1 over the neighbours that won within one lane."""
    h, w = reference.shape
    for y in range(h):
        for yn in range(max(0, y - radius), min(h, y + radius + 1)):
            for dx in range(-radius, radius + 1):
                first, last = max(0, -dx), min(w, w - dx)
                centre, other = reference[y, first:last], lanes[yn, first + dx : last + dx]
                p0, p1 = planes[0, yn, first + dx : last + dx], planes[1, yn, first + dx : last + dx]
                p2, p3 = planes[2, yn, first + dx : last + dx], planes[3, yn, first + dx : last + dx]
                p4 = planes[4, yn, first + dx : last + dx]
                low, same, high = sums[0, y, first:last], sums[1, y, first:last], sums[2, y, first:last]
                for x in range(last - first):
                    offset = np.int16(centre[x] - other[x])
                    c0, c1, c2, c3, c4 = p0[x], p1[x], p2[x], p3[x], p4[x]
                    same_lane, above = offset == np.int16(0), offset == np.int16(1)
                    near = np.int16(-1) if (offset >= np.int16(-1)) & (offset <= np.int16(1)) else np.int16(0)
                    # All three are read and one is kept, so that the loop has no branches.
                    low[x] += np.int16(near & (c1 if same_lane else (c2 if above else c0)))
                    same[x] += np.int16(near & (c2 if same_lane else (c3 if above else c1)))
                    high[x] += np.int16(near & (c3 if same_lane else (c4 if above else c2)))


@no_type_check
@compiled
def _fit_surface(reference, sums, found):
    h, w = reference.shape
    for y in range(h):
        for x in range(w):
            if reference[y, x] < 0:
                continue
            below = np.int32(sums[0, y, x]) - sums[1, y, x]
            above = np.int32(sums[2, y, x]) - sums[1, y, x]
            fraction = np.float32(0)
            if below < 0 or above < 0:
                fraction = np.float32(-0.5 if below < above else 0.5)
            else:
                fraction = _fraction(below, above, False)
            found[y, x] = np.int16(np.floor((reference[y, x] + fraction) * np.float32(32) + np.float32(0.5)))


def fit_surfaces(
    evidence: Evidence, found: UInt16[np.ndarray, "h w"], settings: D4Settings
) -> UInt16[np.ndarray, "h w"]:
    """Sub-pixel disparity from costs averaged over the neighbours of the same surface [1/32 px, 0 = hole].

    A neighbour belongs to the surface when its winner is at most one lane away; costs are averaged at equal disparity.
    Pixels whose five lanes are not all inside the search keep what they have.
    """
    planes = evidence.left[4:9]
    complete = (found > 0) & np.all(planes != NO_COST, axis=0)
    lanes = np.where(complete, evidence.left[0], OUTSIDE)
    sums = np.zeros((3, *lanes.shape), np.int16)
    _add_surface_costs(lanes, lanes, planes, settings.surface_radius, sums)
    # The paths may hold the winner back by a lane where the surface slopes: fit around the lowest of the three.
    step = np.where(sums[0] < sums[1], np.int16(-1), np.int16(0))
    step = np.where(sums[2] < np.minimum(sums[0], sums[1]), np.int16(1), step)
    reference = np.where(complete, lanes + step, OUTSIDE)
    sums[:] = 0
    _add_surface_costs(reference, lanes, planes, settings.surface_radius, sums)
    fitted = found.copy()
    _fit_surface(reference, sums, fitted)
    return fitted


@no_type_check
@compiled
def _agreeing_neighbours(padded, radius, tolerance, counts):
    h, w = counts.shape
    for y in range(h):
        centre, count = padded[y + radius, radius : radius + w], counts[y]
        for dy in range(2 * radius + 1):
            for dx in range(2 * radius + 1):
                other = padded[y + dy, dx : dx + w]
                for x in range(w):
                    difference = np.int16(other[x] - centre[x])
                    count[x] += np.int16((difference <= tolerance) & (difference >= -tolerance))
        count -= 1  # itself


def with_support(disparity: UInt16[np.ndarray, "h w"], settings: D4Settings) -> UInt16[np.ndarray, "h w"]:
    """Drop pixels that too few neighbours agree with [1/32 px, 0 = hole]."""
    radius = settings.neighbour_radius
    values = np.where(disparity > 0, disparity.astype(np.int16), HOLE)
    padded = np.pad(values, radius, constant_values=HOLE)
    counts = np.zeros(disparity.shape, np.int16)
    _agreeing_neighbours(padded, radius, np.int16(settings.neighbour_px * SUBPIXEL_STEPS), counts)
    return np.where(counts >= settings.neighbour_least, disparity, np.uint16(0))


def without_speckles(disparity: UInt16[np.ndarray, "h w"], settings: D4Settings) -> UInt16[np.ndarray, "h w"]:
    """Drop small segments [1/32 px, 0 = hole]."""
    result = disparity.astype(np.int16)
    cv2.filterSpeckles(result, 0, settings.speckle_size, int(settings.speckle_px * SUBPIXEL_STEPS))
    return result.astype(np.uint16)


def select(evidence: Evidence, wanted: int, settings: D4Settings) -> UInt16[np.ndarray, "h w"]:
    """Winners that pass second peak and left-right check, above the search's start [1/32 px], 0 = hole.

    wanted: number of lanes that may win; winners in the first and last of them are holes.
    """
    found = np.zeros(evidence.left.shape[1:], np.uint16)
    _select(
        evidence.left,
        evidence.right,
        evidence.ahead,
        wanted,
        int(settings.second_peak * PATHS + 0.5),
        np.float32(settings.left_right_px),
        settings.subpixel == "costs",
        settings.subpixel == "totals_parabola",
        found,
    )
    return found


def decide(evidence: Evidence, wanted: int, settings: D4Settings) -> UInt16[np.ndarray, "h w"]:
    """Selected winners after median and neighbour count, above the search's start [1/32 px], 0 = hole."""
    found = select(evidence, wanted, settings)
    if settings.subpixel == "costs" and settings.surface_radius > 0:
        found = fit_surfaces(evidence, found, settings)
    if settings.median_first:
        found = with_support(np.asarray(cv2.medianBlur(found, 3)), settings)
    else:
        found = np.asarray(cv2.medianBlur(with_support(found, settings), 3))
    return without_speckles(found, settings) if settings.speckle_size else found
