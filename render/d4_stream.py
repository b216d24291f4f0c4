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
from render.lane_instructions import (
    choose,
    differing,
    first_lane,
    first_marked,
    from_above,
    from_below,
    is_among,
    is_at_most,
    is_below,
    is_equal,
    lane_numbers,
    load,
    lowest,
    minimum,
    minus,
    multiply_high,
    plus,
    popcount,
    spread,
    store,
    times_two_to,
)

U, I64, I16 = np.uint64, np.int64, np.int16
ONE = U(1)
LONGEST_V = U(4)
"""Longest vertical arm: the rows that a row of costs must wait for [px]."""
LONGEST_U = U(8)
"""Longest horizontal arm: the columns by which sums along a row run ahead [px]."""
COLUMNS = U(32)
"""Columns of row sums that are alive at any time: at least 2 LONGEST_U + 2, and a power of two."""
RING = U(2) * LONGEST_V + U(2)
"""Rows of column sums that are alive at any time."""
GUARD = U(32)
"""Lanes between the path costs of neighbouring pixels, so that d - 1 and d + 1 need no branch; 64 bytes, to keep
vectors aligned."""
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


inlined = njit(forceinline=True)
"""For functions of vectors: calls would pass them through memory."""


@inlined
def _census_cost(words, x, right, i, plane, lane, lanes, last):
    """Costs of a left pixel against the right pixels that its lanes look at; lanes above `last` have no partner."""
    bits = popcount(differing(load(right, i, lane), words[0, x]))
    for word in range(1, 5):
        i += plane
        bits = plus(bits, popcount(differing(load(right, i, lane), words[word, x])))
    h = times_two_to(bits, I16(8))
    k1, k2, k3 = CENSUS_COSTS
    cubic = minus(spread(k2, lane), multiply_high(h, k3))
    cost = multiply_high(h, minus(spread(k1, lane), multiply_high(h, cubic)))
    return cost if last >= I64(lanes) - 1 else choose(is_at_most(lane, I16(last)), cost, NO_PARTNER)


@inlined
def _step(kept, below, above, base, cost, small, large):
    """One step of a path (Hirschmueller, eq. 12).

    kept, below, above: the predecessor's costs in the same lane and its neighbours, their minimum `base`; small, large:
    P1 and P2.
    """
    least = minus(minimum(kept, plus(minimum(below, above), small)), base)
    return plus(cost, minimum(least, large))


@inlined
def _step_in_memory(path, at, base, cost, small, large, row):
    """`_step` from the predecessor whose costs begin at path[at], with P1 and P2 from small[row] and large[row] on."""
    kept, below, above = load(path, at, cost), load(path, at - ONE, cost), load(path, at + ONE, cost)
    return _step(kept, below, above, base, cost, load(small, row, cost), load(large, row, cost))


@inlined
def _step_in_registers(path, base, cost, small, large, row):
    """`_step` from the pixel just visited."""
    small, large = load(small, row, cost), load(large, row, cost)
    return _step(path, from_below(path, HIGH), from_above(path, HIGH), base, cost, small, large)


@inlined
def _second_peak(total, lane, best, n):
    """Lowest local minimum inside the first `n` lanes that is neither the winner nor its neighbour."""
    valley = is_at_most(total, minimum(from_below(total, HIGH), from_above(total, HIGH)))
    peaks = choose(valley, total, NONE)
    peaks = choose(is_among(minus(lane, I16(1)), I16(max(n - 2, 0))), peaks, NONE)
    return lowest(choose(is_among(minus(lane, I16(best - 1)), I16(3)), NONE, peaks))


@inlined
def _mean_cost(below, above, reciprocal):
    """Costs averaged over one pixel's support cross, (sum - 2^15) r / 2^16 + r / 2 = sum r / 2^16.

    Written so because the signed product is one instruction and the unsigned one is not recognised.
    """
    centred = differing(minus(below, above), I16(-32768))
    return plus(multiply_high(centred, reciprocal), I16(reciprocal >> I16(1)))


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
def _work_space(n, value):
    """`n` numbers that begin on a cache line."""
    space = np.full(n + 32, value)
    first = (64 - space.ctypes.data % 64) % 64 // 2
    return space[first : first + n]


@njit
def _guarded(columns, lanes, stride):
    """Path costs of a row: zero where disparities are, HIGH in the guards around them."""
    path = _work_space(columns * stride + GUARD, HIGH)
    for k in range(columns):
        for d in range(lanes):
            path[k * stride + GUARD + d] = 0
    return path


@njit
def _note_row(totals, stride, costs, lanes, ahead, right_width, least, found, y):
    """Complete what was found at the left pixels of a row: planes 2 to 8 of `Evidence.left`."""
    for k in range(U(found.shape[2])):
        best, low, last = found[0, y, k], least[k], min(right_width - 1 - ahead + k, lanes - 1)
        if best < 0:
            continue
        slot, at = k * stride + GUARD + U(best), k * lanes + U(best)
        if 0 < best < last:
            found[2, y, k] = totals[slot - ONE] - low
            found[3, y, k] = totals[slot + ONE] - low
        for step in range(5):
            found[4 + step, y, k] = costs[at + U(step) - U(2)] if 0 <= best + step - 2 <= last else NONE


@njit
def _note_right(totals, stride, ahead, low, best, w, wanted, found, y, j):
    """Write what was found at a reversed right column: planes as in `Evidence.right`."""
    found[0, y, j] = best
    k = ahead + U(best) - j
    if low < NONE and 0 < best < wanted - 1 and 0 < k < w - ONE:
        at = k * stride + GUARD + U(best)
        found[1, y, j] = totals[at - stride - ONE] - low
        found[2, y, j] = totals[at + stride + ONE] - low


@inlined
def _sum_row(words, y, right, right_width, width, ahead, arms, lane, lanes, prefix, older, newest, sums):
    """Costs of a row, summed along the horizontal arms, added to the column sums from `older` on into `newest`."""
    h, w = U(words.shape[1]), U(words.shape[2])
    row, plane, total = words[:, y], h * width, spread(I16(0), lane)
    store(prefix, U(0), total)
    for x in range(w + LONGEST_U):
        if x < w:
            last = I64(right_width - ONE - ahead + x)
            total = plus(total, _census_cost(row, x, right, y * width + ahead - x, plane, lane, lanes, last))
        store(prefix, (x + ONE) % COLUMNS * lanes, total)
        if x >= LONGEST_U:
            k = x - LONGEST_U
            low = load(prefix, (k - U(arms[0, y, k])) % COLUMNS * lanes, lane)
            high = load(prefix, (k + U(arms[1, y, k]) + ONE) % COLUMNS * lanes, lane)
            store(sums, newest + k * lanes, plus(load(sums, older + k * lanes, lane), minus(high, low)))


@inlined
def _ring_row(row):
    """`row` modulo the ring's length, for rows below twice that."""
    return row - RING if row >= RING else row


@inlined
def _forward(y, w, width, ahead, arms, reciprocals, edges, lane, lanes, sums, costs, small, large, above, low_above,
             upper_right, low_right, totals, stride):  # fmt: skip
    """Costs of a row; its paths from the left, from above and from the upper right, summed into `totals`."""
    side, low, turn = spread(I16(0), lane), I16(0), y % RING
    for k in range(w):
        below = (_ring_row(turn + U(arms[3, y, k]) + ONE) * w + k) * lanes
        beyond = (_ring_row(turn + RING - U(arms[2, y, k])) * w + k) * lanes
        j, slot = ahead - k, k * stride + GUARD
        cost = _mean_cost(load(sums, below, lane), load(sums, beyond, lane), reciprocals[y, k])
        store(costs, k * lanes, cost)
        side = _step_in_registers(side, low, cost, small, large, U(edges[0, y, k]) * width + j)
        low = lowest(side)
        row = (U(2) + U(edges[1, y, k])) * width + j
        down = _step_in_memory(above, slot, low_above[k], cost, small, large, row)
        store(above, slot, down)
        low_above[k] = lowest(down)
        row = (U(6) + U(edges[3, y, k])) * width + j
        left_down = _step_in_memory(upper_right, slot + stride, low_right[k + ONE], cost, small, large, row)
        store(upper_right, slot, left_down)
        low_right[k] = lowest(left_down)
        store(totals, slot, plus(plus(side, down), left_down))


@inlined
def _backward(y, w, width, right_width, ahead, edges, lane, lanes, costs, small, large, upper_left, low_left, totals,
              wanted, right_lowest, right_best, lows, found, stride):  # fmt: skip
    """A row's paths from the right and from the upper left; its winners, and its bids for the right image."""
    side, low = spread(I16(0), lane), I16(0)
    bid, bidder = spread(NONE, lane), spread(I16(0), lane)
    for back in range(w):
        k = w - ONE - back
        j, slot = ahead - k, k * stride + GUARD
        cost = load(costs, k * lanes, lane)
        row = U(0)  # the first column from the right has no predecessor, so no penalty matters
        if back > 0:
            row = U(edges[0, y, k + ONE]) * width + j - ONE
        side = _step_in_registers(side, low, cost, small, large, row)
        low = lowest(side)
        row, into = (U(4) + U(edges[2, y, k])) * width + j, slot + stride
        right_down = _step_in_memory(upper_left, slot, low_left[k], cost, small, large, row)
        store(upper_left, into, right_down)
        low_left[k + ONE] = lowest(right_down)
        total = plus(load(totals, slot, lane), plus(side, right_down))
        store(totals, slot, total)
        last = I16(right_width - ONE - ahead + k)
        n = min(wanted, I16(last + 1))
        if n > 0:
            least = lowest(choose(is_below(lane, n), total, NONE))
            best = first_marked(is_equal(total, least))
            second = _second_peak(total, lane, best, n)
            found[0, y, k], found[1, y, k], lows[k] = best, NONE if second == NONE else I16(second - least), least
        # Bids for the right pixels that the lanes look at; ties go to the smaller disparity. Lane 0 is the last to bid
        # for its pixel; all others move on to the lane through which the next column looks at theirs.
        offer = choose(is_below(lane, wanted), total, NONE)
        better = is_at_most(offer, bid)
        bid, bidder = choose(better, offer, bid), choose(better, lane, bidder)
        right_lowest[j], right_best[j] = first_lane(bid), first_lane(bidder)
        bid, bidder = from_above(bid, NONE), from_above(bidder, I16(0))
    store(right_lowest, ahead + ONE, bid)
    store(right_best, ahead + ONE, bidder)


@lru_cache
def stream_kernel(n_lanes: int) -> Callable[..., None]:
    """The kernel for a number of lanes (a multiple of 32), compiled on first use or loaded from numba's cache."""

    @compiled
    def stream(words_left, words_right, right_width, ahead, arms, reciprocals, edges_left, edges_right, wanted,
               penalties, found, found_right):  # fmt: skip
        h, w, width = U(words_left.shape[1]), U(words_left.shape[2]), U(words_right.shape[2])
        lane, lanes, right, wanted = lane_numbers(n_lanes), U(n_lanes), words_right.reshape(-1), I16(wanted)
        stride = lanes + GUARD
        prefix, sums = _work_space(COLUMNS * lanes, I16(0)), _work_space(RING * w * lanes, I16(0))
        costs, totals = _work_space(w * lanes, I16(0)), _guarded(w, lanes, stride)
        above, upper_left = _guarded(w, lanes, stride), _guarded(w + ONE, lanes, stride)
        upper_right = _guarded(w + ONE, lanes, stride)
        low_above, low_left, low_right = np.zeros(w, I16), np.zeros(w + ONE, I16), np.zeros(w + ONE, I16)
        small, large = np.zeros(U(8) * width, I16), np.zeros(U(8) * width, I16)
        right_lowest, right_best = np.zeros(width, I16), np.zeros(width, I16)
        lows = np.zeros(w, I16)
        for y_in in range(h + LONGEST_V):
            if y_in < h:
                older, newest = y_in % RING * w * lanes, (y_in + ONE) % RING * w * lanes
                _sum_row(words_left, y_in, right, right_width, width, ahead, arms, lane, lanes, prefix, older, newest,
                         sums)  # fmt: skip
            if y_in < LONGEST_V:
                continue
            y = y_in - LONGEST_V
            _penalty_rows(edges_right, y, penalties, small, large, width)
            _forward(y, w, width, ahead, arms, reciprocals, edges_left, lane, lanes, sums, costs, small, large, above,
                     low_above, upper_right, low_right, totals, stride)  # fmt: skip
            right_lowest[:] = NONE
            _backward(y, w, width, right_width, ahead, edges_left, lane, lanes, costs, small, large, upper_left,
                      low_left, totals, wanted, right_lowest, right_best, lows, found, stride)  # fmt: skip
            _note_row(totals, stride, costs, I64(lanes), I64(ahead), I64(right_width), lows, found, y)
            for j in range(right_width):
                _note_right(totals, stride, ahead, right_lowest[j], right_best[j], w, wanted, found_right, y, j)

    return stream
