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
    if settings.median_first:
        found = with_support(np.asarray(cv2.medianBlur(found, 3)), settings)
    else:
        found = np.asarray(cv2.medianBlur(with_support(found, settings), 3))
    return without_speckles(found, settings) if settings.speckle_size else found
