"""A stereo matcher that fails like the D4 chip of the RealSense D400 cameras.

Census costs, cross-shaped aggregation, semi-global optimisation over the five paths that a line-streaming chip can
follow, left-right check, second peak and neighbour count; see `D4Settings` for every number and its source.
"""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float32, Shaped, UInt8

from render.matcher.d4.census import CENSUS_RADIUS, census
from render.matcher.d4.decision import Evidence, decide
from render.matcher.d4.lane_types import PART, places
from render.matcher.d4.settings import D4Settings
from render.matcher.d4.stream import COST_SCALE, stream_kernel
from render.matcher.d4.support import path_edges, support_arms, support_reciprocals
from render.matcher.interface import N_DISPARITIES, PATH_MARGIN, SUBPIXEL_STEPS, StereoMatcher, Window

BELOW_MARGIN = 18
"""Rows below a window [px]: census 4, aggregation 4, neighbour count 6, mean along the surface 4."""


@dataclass(frozen=True)
class D4Matcher(StereoMatcher):
    """The D4-like matcher; frames of a burst are matched in parallel, one a core.

    9x9 census, costs aggregated over a cross, semi-global optimisation over five paths (Hirschmueller, PAMI 2008), then
    left-right check, second peak, sub-pixel fit, neighbour count and mean along the surface. It is fitted to what real
    cameras lose and find; it is no copy of the chip. Results do not depend on the number of threads.
    """

    settings: D4Settings = field(default_factory=D4Settings)
    shift: int = 0
    """Added to every search's start, the chip's `disparityShift` [px]."""

    def match_burst(
        self,
        lefts: UInt8[np.ndarray, "n h w"],
        rights: UInt8[np.ndarray, "n h w"],
        window: Window | None = None,
        min_disparity: int = 0,
        n_disparities: int = N_DISPARITIES,
    ) -> Float32[np.ndarray, "n h w"]:
        """Disparities [px], 0 = invalid; see `StereoMatcher.match_burst`."""
        window, start = window or Window.whole(lefts.shape), min_disparity + self.shift
        with ThreadPoolExecutor(min(len(lefts), os.cpu_count() or 1)) as pool:
            frames = pool.map(lambda left, right: self._match(left, right, window, start, n_disparities), lefts, rights)
            return np.stack(list(frames))

    def _match(
        self, left: UInt8[np.ndarray, "h w"], right: UInt8[np.ndarray, "h w"], window: Window, start: int, n: int
    ) -> Float32[np.ndarray, "h w"]:
        h, w = left.shape
        top, bottom = max(window.top - PATH_MARGIN, 0), min(window.top + window.height + BELOW_MARGIN, h)
        # The left-right check asks every left column that may bid for a right pixel of the window.
        first, last = max(window.left - PATH_MARGIN, 0), min(window.left + window.width + n, w)
        first_right = max(first - start - _lanes(n) - CENSUS_RADIUS, 0)
        evidence = gather(left[top:bottom, first:last], right[top:bottom, first_right:last], start, n, self.settings)
        found = decide(evidence, n, self.settings)
        disparity = np.zeros((h, w), np.float32)
        rows, columns = window.slices
        inside = found[rows.start - top : rows.stop - top, columns.start - first : columns.stop - first]
        disparity[window.slices] = np.where(inside > 0, inside / np.float32(SUBPIXEL_STEPS) + np.float32(start), 0)
        return disparity


def gather(
    left: UInt8[np.ndarray, "h w"], right: UInt8[np.ndarray, "h w_right"], start: int, n: int, settings: D4Settings
) -> Evidence:
    """Run the streaming core. Both images end at the same column; the right one may begin farther left."""
    (h, w), w_right, lanes = left.shape, right.shape[1], _lanes(n)
    stride = w_right + start + lanes
    arms = support_arms(left, settings)
    found, found_right = np.full((9, h, w), -1, np.int16), np.full((3, h, stride), -1, np.int16)
    ahead = w - 1 + start
    stream_kernel(lanes)(
        census(left),
        _dealt(census(right), stride, lanes),
        np.uint64(w_right),
        np.uint64(ahead),
        arms,
        support_reciprocals(arms, COST_SCALE),
        path_edges(left, settings),
        _dealt(path_edges(right, settings), stride, lanes).reshape(4, h, -1),
        n,
        np.array(settings.p1 + settings.p2, np.int16),
        np.array(places(lanes), np.uint64),
        found,
        found_right,
    )
    return Evidence(found, found_right, ahead)


def _dealt(planes: Shaped[np.ndarray, "k h w"], width: int, lanes: int) -> Shaped[np.ndarray, "k h parts pitch"]:
    """Rows reversed, continued with zeros to `width` and dealt out to the parts of a vector of so many lanes."""
    parts, (k, h, _) = lanes // PART, planes.shape
    dealt = np.zeros((k, h, parts, -(-width // parts)), planes.dtype)
    for part in range(parts):
        row = planes[:, :, ::-1][:, :, part::parts]
        dealt[:, :, part, : row.shape[2]] = row
    return dealt


def _lanes(n: int) -> int:
    """Full vectors for `n` disparities. What lies beyond these is optimised but cannot win."""
    return -(-n // PART) * PART
