"""The D4-like matcher's core: one pass down a frame, row by row, as a line-streaming chip does it.

Per row: census costs, cross-shaped aggregation, five scan-line paths (from the left, the right, above and both upper
diagonals; Hirschmueller, PAMI 2008), winner, left-right check and second peak. Costs are 16-bit and only a few rows
of them exist at any time. Arrays of costs are flat, disparity fastest; indices are unsigned, because numba's negative
indexing keeps LLVM from vectorising; the number of lanes is a compile-time constant, which unrolls the inner loops.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numba import njit

from render.compiled import compiled
from render.lane_instructions import multiply_high, popcount

U, I16, U16 = np.uint64, np.int16, np.uint16
ONE = U(1)
LONGEST_V = U(4)
"""Longest vertical arm: the rows that a row of costs must wait for [px]."""
LONGEST_U = U(8)
"""Longest horizontal arm: the columns by which sums along a row run ahead [px]."""
COLUMNS = U(32)
"""Columns of row sums that are alive at any time: at least 2 LONGEST_U + 2, and a power of two."""
RING = U(2) * LONGEST_V + U(2)
"""Rows of column sums that are alive at any time."""
GUARD = U(16)
"""Lanes on either side of a path's costs, so that d - 1 and d + 1 need no branch."""
HIGH = I16(16000)
"""In the guards: above every path cost and, with a penalty added, still a 16-bit number."""
NONE = I16(32767)
"""No such value."""

CENSUS_COSTS = (I16(2651), I16(5806), I16(5484))
NO_PARTNER = I16(428)
"""Cost of h differing census bits: 428 (1 - exp(-h / 52)) / (1 - exp(-80 / 52)) as a cubic in 16-bit arithmetic, right
to 1.0. The shape is fitted on real pairs; 428 is the largest value whose sum over a full cross of 17 x 9 pixels fits
into 16 bits. Where the right image ends, the cost is that of 80 bits."""

COST_SCALE = 1023 * (1 - np.exp(-80 / 52)) / 428
"""10-bit cost units, in which the penalties and thresholds are, per unit of the above."""


@njit
def _add_costs(left, right, first, stride, lane, last, prefix, before, at, lanes):
    """Continue the sums of census costs along a row by one pixel; lanes above `last` have no partner."""
    l0, l1, l2, l3, l4 = left
    k1, k2, k3 = CENSUS_COSTS
    for d in range(lanes):
        i = first + d
        bits = U16(popcount(l0 ^ right[i]) + popcount(l1 ^ right[i + stride]))
        bits = U16(bits + popcount(l2 ^ right[i + U(2) * stride]))
        bits = U16(bits + popcount(l3 ^ right[i + U(3) * stride]))
        h = I16(U16(bits + popcount(l4 ^ right[i + U(4) * stride])) << U16(8))
        cost = multiply_high(h, I16(k1 - multiply_high(h, I16(k2 - multiply_high(h, k3)))))
        prefix[at + d] = U16(prefix[before + d] + U16(cost if lane[d] <= last else NO_PARTNER))


@njit
def _stack(prefix, low, high, above, row, at, lanes):
    """One pixel's horizontal arm sum added to the column sum `above` it: the column sum down to this row."""
    for d in range(lanes):
        row[at + d] = U16(above[at + d] + U16(prefix[high + d] - prefix[low + d]))


@njit
def _mean_costs(sums, below, above, reciprocal, costs, at, lanes):
    """Costs averaged over one pixel's support cross, (sum - 2^15) r / 2^16 + r / 2 = sum r / 2^16.

    Written so because the signed product is one instruction and the unsigned one is not recognised.
    """
    half = I16(reciprocal >> I16(1))
    for d in range(lanes):
        centred = I16(U16(sums[below + d] - sums[above + d]) ^ U16(32768))
        costs[at + d] = I16(multiply_high(centred, reciprocal) + half)


@njit
def _penalty_rows(edges_right, y, penalties, small, large, stride):
    """P1 and P2 over the reversed right columns, for four directions, without and with an edge in the left image."""
    for direction in range(U(4)):
        for edge_left in range(U(2)):
            row = (direction * U(2) + edge_left) * stride
            p1, p1_edge = penalties[edge_left], penalties[edge_left + ONE]
            p2, p2_edge = penalties[edge_left + U(3)], penalties[edge_left + U(4)]
            for j in range(stride):
                edge = edges_right[direction, y, j] != 0
                small[row + j] = p1_edge if edge else p1
                large[row + j] = p2_edge if edge else p2


@njit
def _step(path, previous, base, costs, at, small, large, i, into, here, lanes):
    """One step of a path (Hirschmueller, eq. 12) into `into[here + d]`; returns its minimum.

    path[previous + d]: the predecessor's costs, with minimum `base`; small[i + d], large[i + d]: P1 and P2.
    """
    lowest = NONE
    for d in range(lanes):
        beside = I16(min(path[previous + d - ONE], path[previous + d + ONE]) + small[i + d])
        kept = I16(min(path[previous + d], beside) - base)
        cost = I16(costs[at + d] + min(kept, large[i + d]))
        into[here + d] = cost
        lowest = min(lowest, cost)
    return lowest


@njit
def _sum_three(a, at_a, b, at_b, c, at_c, totals, at, lanes):
    for d in range(lanes):
        totals[at + d] = I16(a[at_a + d] + b[at_b + d] + c[at_c + d])


@njit
def _complete(a, at_a, b, at_b, totals, at, lane, n, lanes):
    """Add the last two paths; returns the lowest total of the first `n` lanes."""
    lowest = NONE
    for d in range(lanes):
        total = I16(totals[at + d] + a[at_a + d] + b[at_b + d])
        totals[at + d] = total
        lowest = min(lowest, total if lane[d] < n else NONE)
    return lowest


@njit
def _winner(totals, at, lane, lowest, lanes):
    best = NONE
    for d in range(lanes):
        best = min(best, lane[d] if totals[at + d] == lowest else NONE)
    return best


@njit
def _second_peak(totals, at, lane, best, n, lanes):
    """Lowest local minimum inside the first `n` lanes that is neither the winner nor its neighbour."""
    second = NONE
    below, above, last = I16(best - 1), I16(best + 1), I16(n - 2)
    for d in range(lanes):
        total = totals[at + d]
        valley = (total <= totals[at + d - ONE]) & (total <= totals[at + d + ONE])
        elsewhere = (lane[d] >= I16(1)) & (lane[d] <= last) & ((lane[d] > above) | (lane[d] < below))
        second = min(second, total if valley & elsewhere else NONE)
    return second


@njit
def _offer_to_right(totals, at, lane, wanted, right_lowest, right_best, first, lanes):
    """Let this left pixel bid for the right pixels that its lanes belong to; ties go to the smaller disparity."""
    for d in range(lanes):
        total = totals[at + d] if lane[d] < wanted else NONE
        better = total <= right_lowest[first + d]
        right_best[first + d] = lane[d] if better else right_best[first + d]
        right_lowest[first + d] = total if better else right_lowest[first + d]


@njit
def _guarded(columns, lanes, stride):
    """Path costs of a row: zero where disparities are, HIGH in the guards around them."""
    path = np.full(columns * stride, HIGH)
    for k in range(columns):
        for d in range(lanes):
            path[k * stride + GUARD + d] = 0
    return path


@njit
def _note(totals, slot, costs, at, lowest, best, second, last, found, y, k):
    """Write what was found at a left pixel: planes as in `Evidence.left`."""
    found[0, y, k] = best
    found[1, y, k] = NONE if second == NONE else I16(second - lowest)
    if 0 < best < last:
        found[2, y, k] = totals[slot + U(best) - ONE] - lowest
        found[3, y, k] = totals[slot + U(best) + ONE] - lowest
    for step in range(5):
        d = best + step - 2
        found[4 + step, y, k] = costs[at + U(d)] if 0 <= d <= last else NONE


@njit
def _note_right(totals, stride, ahead, lowest, best, w, wanted, found, y, j):
    """Write what was found at a reversed right column: planes as in `Evidence.right`."""
    found[0, y, j] = best
    k = ahead + U(best) - j
    if lowest < NONE and 0 < best < wanted - 1 and 0 < k < w - ONE:
        at = k * stride + GUARD + U(best)
        found[1, y, j] = totals[at - stride - ONE] - lowest
        found[2, y, j] = totals[at + stride + ONE] - lowest


@njit(inline="always")
def _sum_row(words_left, right, right_width, width, plane, ahead, y, arms, lane, prefix, older, newest, lanes):
    """Costs of a row, summed along the horizontal arms, added to the column sums `older` into `newest`."""
    w = U(words_left.shape[2])
    prefix[:] = 0
    for x in range(w + LONGEST_U):
        if x < w:
            words = words_left[:, y, x]
            left, last = (words[0], words[1], words[2], words[3], words[4]), I16(right_width - ONE - ahead + x)
            before, at = x % COLUMNS * lanes, (x + ONE) % COLUMNS * lanes
            _add_costs(left, right, y * width + ahead - x, plane, lane, last, prefix, before, at, lanes)
        if x >= LONGEST_U:
            k = x - LONGEST_U
            low = (k - U(arms[0, y, k])) % COLUMNS * lanes
            high = (k + U(arms[1, y, k]) + ONE) % COLUMNS * lanes
            _stack(prefix, low, high, older, newest, k * lanes, lanes)


@njit(inline="always")
def _forward(y, h, w, width, ahead, arms, reciprocals, edges, sums, costs, small, large, side, above, low_above,
             upper_right, low_right, totals, stride, lanes):  # fmt: skip
    """Costs of a row; its paths from the left, from above and from the upper right, summed into `totals`."""
    here, low = GUARD, I16(0)
    side[GUARD : GUARD + lanes] = 0
    for k in range(w):
        below = ((y + U(arms[3, y, k]) + ONE) % RING * w + k) * lanes
        beyond = ((y - U(arms[2, y, k])) % RING * w + k) * lanes
        at, j, slot = k * lanes, ahead - k, k * stride + GUARD
        _mean_costs(sums, below, beyond, reciprocals[y, k], costs, at, lanes)
        before, here = here, GUARD + stride if here == GUARD else GUARD
        row = U(edges[0, y, k]) * width + j
        low = _step(side, before, low, costs, at, small, large, row, side, here, lanes)
        row = (U(2) + U(edges[1, y, k])) * width + j
        up = h - ONE - y + k
        into, lowest = up * stride + GUARD, low_above[up + ONE]
        low_above[up] = _step(above, into + stride, lowest, costs, at, small, large, row, above, into, lanes)
        row, lowest = (U(6) + U(edges[3, y, k])) * width + j, low_right[k + ONE]
        low_right[k] = _step(upper_right, slot + stride, lowest, costs, at, small, large, row, upper_right, slot, lanes)
        _sum_three(side, here, above, into, upper_right, slot, totals, slot, lanes)


@njit(inline="always")
def _backward(y, w, width, right_width, ahead, edges, costs, small, large, side, upper_left, low_left, totals, lane,
              wanted, right_lowest, right_best, found, stride, lanes):  # fmt: skip
    """A row's paths from the right and from the upper left; its winners, and its bids for the right image."""
    here, low = GUARD, I16(0)
    side[GUARD : GUARD + lanes] = 0
    for back in range(w):
        k = w - ONE - back
        at, j, slot = k * lanes, ahead - k, k * stride + GUARD
        before, here = here, GUARD + stride if here == GUARD else GUARD
        row = U(0)  # the first column from the right has no predecessor, so no penalty matters
        if back > 0:
            row = U(edges[0, y, k + ONE]) * width + j - ONE
        low = _step(side, before, low, costs, at, small, large, row, side, here, lanes)
        row, into = (U(4) + U(edges[2, y, k])) * width + j, slot + stride
        low_left[k + ONE] = _step(upper_left, slot, low_left[k], costs, at, small, large, row, upper_left, into, lanes)
        last = I16(right_width - ONE - ahead + k)
        n = min(wanted, I16(last + 1))
        lowest = _complete(side, here, upper_left, into, totals, slot, lane, n, lanes)
        if n > 0:
            best = _winner(totals, slot, lane, lowest, lanes)
            second = _second_peak(totals, slot, lane, best, n, lanes)
            _note(totals, slot, costs, at, lowest, best, second, min(last, I16(lanes - ONE)), found, y, k)
        _offer_to_right(totals, slot, lane, wanted, right_lowest, right_best, j, lanes)


@lru_cache
def stream_kernel(n_lanes: int) -> Callable[..., None]:
    """The kernel for a number of lanes (a multiple of 32), compiled on first use or loaded from numba's cache."""
    lanes = U(n_lanes)  # a constant of the kernel
    stride = lanes + U(2) * GUARD

    @compiled
    def stream(words_left, words_right, right_width, ahead, arms, reciprocals, edges_left, edges_right, wanted,
               penalties, found, found_right):  # fmt: skip
        h, w, width = U(words_left.shape[1]), U(words_left.shape[2]), U(words_right.shape[2])
        right, plane = words_right.reshape(-1), h * width
        lane, wanted = np.arange(np.int64(lanes)).astype(I16), I16(wanted)
        prefix, sums = np.zeros(COLUMNS * lanes, U16), np.zeros((RING, w * lanes), U16)
        flat_sums, costs, totals = sums.reshape(-1), np.zeros(w * lanes, I16), _guarded(w, lanes, stride)
        # A row of the path from above moves down by one column a row, so that reading and writing never overlap.
        side, above = _guarded(U(2), lanes, stride), _guarded(w + h, lanes, stride)
        upper_left, upper_right = _guarded(w + ONE, lanes, stride), _guarded(w + ONE, lanes, stride)
        low_above, low_left, low_right = np.zeros(w + h, I16), np.zeros(w + ONE, I16), np.zeros(w + ONE, I16)
        small, large = np.zeros(U(8) * width, I16), np.zeros(U(8) * width, I16)
        right_lowest, right_best = np.zeros(width, I16), np.zeros(width, I16)
        for y_in in range(h + LONGEST_V):
            if y_in < h:
                older, newest = sums[y_in % RING], sums[(y_in + ONE) % RING]
                _sum_row(words_left, right, right_width, width, plane, ahead, y_in, arms, lane, prefix, older, newest,
                         lanes)  # fmt: skip
            if y_in < LONGEST_V:
                continue
            y = y_in - LONGEST_V
            _penalty_rows(edges_right, y, penalties, small, large, width)
            _forward(y, h, w, width, ahead, arms, reciprocals, edges_left, flat_sums, costs, small, large, side, above,
                     low_above, upper_right, low_right, totals, stride, lanes)  # fmt: skip
            right_lowest[:] = NONE
            _backward(y, w, width, right_width, ahead, edges_left, costs, small, large, side, upper_left, low_left,
                      totals, lane, wanted, right_lowest, right_best, found, stride, lanes)  # fmt: skip
            for j in range(right_width):
                _note_right(totals, stride, ahead, right_lowest[j], right_best[j], w, wanted, found_right, y, j)

    return stream
