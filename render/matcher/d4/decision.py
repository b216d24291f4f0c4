"""Which winners the D4-like matcher keeps, and their sub-pixel disparity.

Left-right check and second peak decide pixel by pixel; then a pixel needs enough neighbours that agree with it.
Disparities here are whole numbers of 1/32 px, as in the chip.
"""

from dataclasses import dataclass
from typing import no_type_check

import cv2
import numpy as np
from jaxtyping import Int16, UInt16
from numba import njit

from render.matcher.compiled import compiled
from render.matcher.d4.lane_instructions import (
    choose,
    is_among,
    is_below,
    is_equal,
    lane_numbers,
    load,
    minimum,
    minus,
    plus,
    spread,
    store,
)
from render.matcher.d4.lane_types import PART
from render.matcher.d4.settings import PATHS, D4Settings
from render.matcher.interface import SUBPIXEL_STEPS

NO_COST = np.int16(32767)
"""Marks lanes outside the search in `Evidence`."""

OUTSIDE = np.int16(-30000)
"""Winning lane of a pixel that takes no part: more than one lane from any other."""

HOLE = np.int16(-12000)
"""Stands for a hole where neighbours are compared: farther from any disparity than any tolerance."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the streaming core found, as 16-bit planes; lane d is a disparity of d more than the search's start [px]."""

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
def _cost_minimum(c0, c1, c2, c3, c4):
    """Minimum of the aggregated costs near the winner, relative to it [px]: V fit around the lowest of three lanes."""
    lowest, below, cost, above = 2, c1, c2, c3
    if c1 < cost:
        lowest, below, cost, above = 1, c0, c1, c2
    if c3 < cost:
        lowest, below, cost, above = 3, c2, c3, c4
    if below == 32767 or above == 32767:
        return np.float32(0)
    rise_below, rise_above = np.int32(below) - cost, np.int32(above) - cost
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
                c0, c1, c2, c3, c4 = left[4, y, k], left[5, y, k], left[6, y, k], left[7, y, k], left[8, y, k]
                fraction = _cost_minimum(c0, c1, c2, c3, c4)
            found[y, k] = np.int16(np.floor((best + fraction) * np.float32(32) + np.float32(0.5)))


@no_type_check
@njit(forceinline=True)
def _surface_costs(reference, lanes, planes, plane, at, pitch, radius):
    """Costs of the lanes reference - 1, reference, reference + 1, summed over neighbours that won within one lane.

    reference: lanes of 32 pixels. lanes[at], planes[at]: what the first of them finds at the window's upper left.
    """
    low, same, high = spread(np.int16(0), reference), spread(np.int16(0), reference), spread(np.int16(0), reference)
    for dy in range(2 * radius + 1):
        for dx in range(2 * radius + 1):
            i = np.uint64(at + dy * pitch + dx)
            offset = minus(reference, load(lanes, i, reference))
            under, equal, over = (
                is_equal(offset, np.int16(-1)),
                is_equal(offset, np.int16(0)),
                is_equal(offset, np.int16(1)),
            )
            c0, c1 = load(planes, i, reference), load(planes, i + plane, reference)
            c2, c3 = load(planes, i + 2 * plane, reference), load(planes, i + 3 * plane, reference)
            c4 = load(planes, i + 4 * plane, reference)
            low = plus(low, choose(over, c2, choose(equal, c1, choose(under, c0, np.int16(0)))))
            same = plus(same, choose(over, c3, choose(equal, c2, choose(under, c1, np.int16(0)))))
            high = plus(high, choose(over, c4, choose(equal, c3, choose(under, c2, np.int16(0)))))
    return low, same, high


@no_type_check
@compiled
def _sum_surfaces(lanes, planes, radius, reference, sums):
    """Per pixel the lane around which costs are lowest and the sums around it; images in rows of whole vectors."""
    h, w, pitch, size = reference.shape[0], reference.shape[1], lanes.shape[1], np.uint64(reference.size)
    flat_lanes, flat_planes, plane = lanes.reshape(-1), planes.reshape(-1), np.uint64(lanes.size)
    flat_reference, flat_sums, like = reference.reshape(-1), sums.reshape(-1), lane_numbers(PART)
    for y in range(h):
        for x in range(0, w, PART):
            at, out = y * pitch + x, np.uint64(y * w + x)
            best = load(flat_lanes, np.uint64(at + radius * pitch + radius), like)
            low, same, high = _surface_costs(best, flat_lanes, flat_planes, plane, at, pitch, radius)
            # The paths may hold the winner back by a lane where the surface slopes: fit around the lowest of the three.
            moved = choose(is_below(low, same), minus(best, np.int16(1)), best)
            moved = choose(is_below(high, minimum(low, same)), plus(best, np.int16(1)), moved)
            moved = choose(is_below(best, np.int16(0)), OUTSIDE, moved)
            low, same, high = _surface_costs(moved, flat_lanes, flat_planes, plane, at, pitch, radius)
            store(flat_reference, out, moved)
            store(flat_sums, out, low)
            store(flat_sums, out + size, same)
            store(flat_sums, out + size + size, high)


@no_type_check
@compiled
def _fit_surface(reference, sums, found):
    h, w = found.shape
    for y in range(h):
        for x in range(w):
            below = np.int32(sums[0, y, x]) - sums[1, y, x]
            above = np.int32(sums[2, y, x]) - sums[1, y, x]
            # All is computed and one is kept, so that the loop has no branches.
            inside = np.float32(below - above) / np.float32(2 * max(below, above, 1))
            end = np.float32(-0.5) if below < above else np.float32(0.5)
            fraction = end if min(below, above) < 0 else inside
            fitted = np.int16(np.floor((reference[y, x] + fraction) * np.float32(32) + np.float32(0.5)))
            found[y, x] = fitted if reference[y, x] >= 0 else found[y, x]


def fit_surfaces(
    evidence: Evidence, found: UInt16[np.ndarray, "h w"], settings: D4Settings
) -> UInt16[np.ndarray, "h w"]:
    """Sub-pixel disparity from costs averaged over the neighbours of the same surface [1/32 px, 0 = hole].

    A neighbour belongs to the surface when its winner is at most one lane away; costs are averaged at equal disparity.
    Pixels whose five lanes are not all inside the search keep what they have.
    """
    (h, w), radius = found.shape, settings.surface_radius
    width = -(-w // PART) * PART
    inner = slice(radius, radius + h), slice(radius, radius + w)
    planes = np.zeros((5, h + 2 * radius, width + 2 * radius), np.int16)
    planes[:, *inner] = evidence.left[4:9]
    lanes = np.full(planes.shape[1:], OUTSIDE)
    lanes[inner] = np.where((found > 0) & (evidence.left[4:9].max(axis=0) != NO_COST), evidence.left[0], OUTSIDE)
    reference, sums = np.zeros((h, width), np.int16), np.zeros((3, h, width), np.int16)
    _sum_surfaces(lanes, planes, radius, reference, sums)
    fitted = found.copy()
    _fit_surface(reference, sums, fitted)
    return fitted


@no_type_check
@compiled
def _agreeing_neighbours(padded, radius, tolerance, counts):
    """Pixels in the window that agree with its centre, which is one of them; images in rows of whole vectors."""
    h, w, pitch = counts.shape[0], counts.shape[1], padded.shape[1]
    flat, flat_counts, like = padded.reshape(-1), counts.reshape(-1), lane_numbers(PART)
    for y in range(h):
        for x in range(0, w, PART):
            lowest = minus(load(flat, np.uint64((y + radius) * pitch + x + radius), like), tolerance)
            count = spread(np.int16(0), like)
            for dy in range(2 * radius + 1):
                for dx in range(2 * radius + 1):
                    above_lowest = minus(load(flat, np.uint64((y + dy) * pitch + x + dx), like), lowest)
                    agrees = is_among(above_lowest, np.int16(2 * tolerance + 1))
                    count = choose(agrees, plus(count, np.int16(1)), count)
            store(flat_counts, np.uint64(y * w + x), count)


def with_support(disparity: UInt16[np.ndarray, "h w"], settings: D4Settings) -> UInt16[np.ndarray, "h w"]:
    """Drop pixels that too few neighbours agree with [1/32 px, 0 = hole]."""
    (h, w), radius = disparity.shape, settings.neighbour_radius
    width = -(-w // PART) * PART
    padded = np.full((h + 2 * radius, width + 2 * radius), HOLE)
    padded[radius : radius + h, radius : radius + w] = np.where(disparity > 0, disparity.astype(np.int16), HOLE)
    counts = np.zeros((h, width), np.int16)
    _agreeing_neighbours(padded, radius, np.int16(settings.neighbour_px * SUBPIXEL_STEPS), counts)
    return np.where(counts[:, :w] > settings.neighbour_least, disparity, np.uint16(0))


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
