"""Where the D4-like matcher may average and where a step is likely: support crosses and intensity edges.

Support crosses: Zhang, Lu and Lafruit, IEEE TCSVT 2009. Edges along a path: Hirschmueller, PAMI 2008, section 2.3.
"""

from typing import no_type_check

import cv2
import numpy as np
from jaxtyping import Int16, UInt8

from render.matcher.compiled import compiled
from render.matcher.d4.settings import D4Settings

PER_DN = 4
"""Thresholds are in 10-bit units, images in 8 bits."""


@no_type_check
@compiled
def _grow_arm(image, threshold, longest, shrink, dx, dy, lengths):
    h, w = image.shape
    growing, reached = np.zeros(w, np.uint8), np.zeros(w, np.uint8)
    for y in range(h):
        growing[:] = 1
        reached[:] = 0
        for k in range(1, longest + shrink + 1):
            first, last = max(0, -k * dx), min(w, w - k * dx)
            if y + k * dy < 0 or y + k * dy >= h or first >= last:
                break
            anchors, alive, length = image[y, first:last], growing[first:last], reached[first:last]
            others = image[y + k * dy, first + k * dx : last + k * dx]
            slack = threshold if k > 1 else np.int16(255)  # the first pixel always belongs to the arm
            for x in range(last - first):
                difference = np.int16(others[x] - anchors[x])
                alive[x] &= np.uint8((difference <= slack) & (difference >= -slack))
                length[x] += alive[x]
        for x in range(w):
            room = x if dx < 0 else (w - 1 - x if dx > 0 else (y if dy < 0 else h - 1 - y))
            # An arm that ends at the image border met no edge, so it need not keep away from one.
            kept = reached[x] if reached[x] >= room else max(reached[x] - shrink, 1)
            lengths[y, x] = min(kept, longest)


def support_arms(image: UInt8[np.ndarray, "h w"], settings: D4Settings) -> UInt8[np.ndarray, "4 h w"]:
    """Lengths of every pixel's support cross to the left, right, up and down [px], at least 1 inside the image."""
    if settings.arm_blur_px > 0:
        image = np.asarray(cv2.GaussianBlur(image, (0, 0), settings.arm_blur_px))
    smooth, arms = image.astype(np.int16), np.zeros((4, *image.shape), np.uint8)
    threshold, u, v = np.int16(settings.arm_threshold // PER_DN), settings.arm_reach_u, settings.arm_reach_v
    _grow_arm(smooth, threshold, u, settings.arm_shrink_u, -1, 0, arms[0])
    _grow_arm(smooth, threshold, u, settings.arm_shrink_u, 1, 0, arms[1])
    _grow_arm(smooth, threshold, v, settings.arm_shrink_v, 0, -1, arms[2])
    _grow_arm(smooth, threshold, v, settings.arm_shrink_v, 0, 1, arms[3])
    return arms


@no_type_check
@compiled
def _reciprocals(arms, scale, result):
    _, h, w = arms.shape
    stacked = np.zeros((h + 1, w), np.int32)
    for y in range(h):
        for x in range(w):
            stacked[y + 1, x] = stacked[y, x] + arms[0, y, x] + arms[1, y, x] + 1
    for y in range(h):
        for x in range(w):
            size = stacked[y + arms[3, y, x] + 1, x] - stacked[y - arms[2, y, x], x]
            result[y, x] = 2 * np.int32(scale / size + 0.5)


def support_reciprocals(arms: UInt8[np.ndarray, "4 h w"], scale: float) -> Int16[np.ndarray, "h w"]:
    """2^16 scale / (pixels in the support cross), even and below 2^15: what turns a cost sum into a scaled mean.

    A cross has at least 4 pixels (3 x 3 inside the image, 2 x 2 in its corners), so `scale` may be just below 2.
    """
    result = np.zeros(arms.shape[1:], np.int16)
    _reciprocals(arms, 2.0**15 * scale, result)
    return result


@no_type_check
@compiled
def _edge_maps(image, threshold, edges):
    h, w = image.shape
    for y in range(h):
        for x in range(1, w):
            edges[0, y, x] = abs(image[y, x] - image[y, x - 1]) > threshold
    for y in range(1, h):
        for x in range(w):
            edges[1, y, x] = abs(image[y, x] - image[y - 1, x]) > threshold
        for x in range(1, w):
            edges[2, y, x] = abs(image[y, x] - image[y - 1, x - 1]) > threshold
        for x in range(w - 1):
            edges[3, y, x] = abs(image[y, x] - image[y - 1, x + 1]) > threshold


def path_edges(image: UInt8[np.ndarray, "h w"], settings: D4Settings) -> UInt8[np.ndarray, "4 h w"]:
    """1 where the step from the left, upper, upper left, upper right neighbour exceeds the edge threshold."""
    edges = np.zeros((4, *image.shape), np.uint8)
    _edge_maps(image.astype(np.int16), np.int16(settings.edge_threshold // PER_DN), edges)
    return edges
