"""Which winners the D4-like matcher keeps, and their sub-pixel disparity.

Left-right check and second peak decide pixel by pixel; then a pixel needs enough neighbours that agree with it.
Disparities here are whole numbers of 1/32 px, as in the chip.
"""

from dataclasses import dataclass
from typing import no_type_check

import cv2
import numpy as np
from jaxtyping import Int16, UInt16

from render.matcher.compiled import compiled
from render.matcher.d4.lane_instructions import (
    choose,
    is_among,
    lane_numbers,
    load,
    minus,
    plus,
    spread,
    store,
)
from render.matcher.d4.lane_types import PART
from render.matcher.d4.settings import PATHS, D4Settings
from render.matcher.interface import SUBPIXEL_STEPS

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
    padded = _padded(disparity, radius, radius)
    counts = np.zeros((h, padded.shape[1] - 2 * radius), np.int16)
    _agreeing_neighbours(padded, radius, np.int16(settings.neighbour_px * SUBPIXEL_STEPS), counts)
    return np.where(counts[:, :w] > settings.neighbour_least, disparity, np.uint16(0))


@no_type_check
@compiled
def _sum_pairs(padded, reach_u, reach_v, tolerance, sums, counts):
    """Per pixel the disparities above its own, summed over the pairs of opposite neighbours that both agree with it."""
    h, w, pitch = counts.shape[0], counts.shape[1], padded.shape[1]
    flat, flat_sums, flat_counts, like = padded.reshape(-1), sums.reshape(-1), counts.reshape(-1), lane_numbers(PART)
    width = np.int16(2 * tolerance + 1)
    for y in range(h):
        for x in range(0, w, PART):
            at = (y + reach_v) * pitch + x + reach_u
            lowest = minus(load(flat, np.uint64(at), like), tolerance)
            total, pairs = spread(np.int16(0), like), spread(np.int16(0), like)
            for dy in range(reach_v + 1):
                for dx in range(-reach_u if dy > 0 else 1, reach_u + 1):
                    one = minus(load(flat, np.uint64(at + dy * pitch + dx), like), lowest)
                    other = minus(load(flat, np.uint64(at - dy * pitch - dx), like), lowest)
                    # Each is 0 to 2 tolerance if it agrees; less `tolerance` it is what it lies above the pixel.
                    beyond = choose(is_among(one, width), other, width)
                    both = is_among(beyond, width)
                    total = choose(both, plus(total, minus(plus(one, other), np.int16(2 * tolerance))), total)
                    pairs = choose(both, plus(pairs, np.int16(1)), pairs)
            store(flat_sums, np.uint64(y * w + x), total)
            store(flat_counts, np.uint64(y * w + x), pairs)


@no_type_check
@compiled
def _add_means(sums, pairs, found):
    h, w = found.shape
    for y in range(h):
        for x in range(w):
            above = np.float32(sums[y, x]) / np.float32(2 * pairs[y, x] + 1)
            found[y, x] += np.int16(np.floor(above + np.float32(0.5))) if found[y, x] > 0 else np.int16(0)


def mean_of_surface(disparity: UInt16[np.ndarray, "h w"], settings: D4Settings) -> UInt16[np.ndarray, "h w"]:
    """Mean disparity of a pixel and its neighbours on the same surface [1/32 px, 0 = hole].

    Neighbours count in pairs, one opposite the other, if both are valid and near the pixel's disparity: so a slope
    keeps its disparities up to its end, and what lies beyond a step has no part.
    """
    u, v = settings.mean_reach_u, settings.mean_reach_v
    padded = _padded(disparity, u, v)
    sums, pairs = (np.zeros((len(disparity), padded.shape[1] - 2 * u), np.int16) for _ in range(2))
    _sum_pairs(padded, u, v, np.int16(settings.mean_px * SUBPIXEL_STEPS), sums, pairs)
    means = disparity.astype(np.int16)
    _add_means(sums, pairs, means)
    return means.astype(np.uint16)


def _padded(disparity: UInt16[np.ndarray, "h w"], u: int, v: int) -> Int16[np.ndarray, "h_p w_p"]:
    """Rows of whole vectors with `u` and `v` pixels around them, `HOLE` where there is no disparity."""
    h, w = disparity.shape
    padded = np.full((h + 2 * v, -(-w // PART) * PART + 2 * u), HOLE)
    padded[v : v + h, u : u + w] = np.where(disparity > 0, disparity.astype(np.int16), HOLE)
    return padded


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
    """Selected winners after neighbour count and mean along surfaces, above the search's start [1/32 px], 0 = hole."""
    found = select(evidence, wanted, settings)
    if settings.median_first:
        found = np.asarray(cv2.medianBlur(found, 3))
    found = mean_of_surface(with_support(found, settings), settings)
    return without_speckles(found, settings) if settings.speckle_size else found
