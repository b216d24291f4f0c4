"""The D4-like matcher's core: one pass down a frame, row by row, as a line-streaming chip does it.

Per row: census costs, cross-shaped aggregation, five scan-line paths (from the left, the right, above and both upper
diagonals; Hirschmueller, PAMI 2008), winner, left-right check and second peak. Costs are 16-bit and only a few rows
of them exist at any time. What all disparities of a pixel hold is one value, `Lanes`; arrays of costs are flat, one
pixel's lanes after another's. Indices are unsigned, which spares numba's test for negative ones.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numba import njit

from render.matcher.compiled import compiled
from render.matcher.d4.lane_instructions import (
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
    load_dealt,
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
from render.matcher.d4.lane_types import PART

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
HIGH = I16(16000)
"""Beside the outermost lanes: above every path cost and, with a penalty added, still a 16-bit number."""
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
def _census_cost(words, x, right, row, rows, pitch, j, lane, lanes, last):
    """Costs of a left pixel against the right pixels that its lanes look at; lanes above `last` have no partner."""
    bits = popcount(differing(load_dealt(right, row, pitch, j, lane), words[0, x]))
    for word in range(1, 5):
        row += rows
        bits = plus(bits, popcount(differing(load_dealt(right, row, pitch, j, lane), words[word, x])))
    h = times_two_to(bits, I16(8))
    k1, k2, k3 = CENSUS_COSTS
    cubic = minus(spread(k2, lane), multiply_high(h, k3))
    cost = multiply_high(h, minus(spread(k1, lane), multiply_high(h, cubic)))
    return cost if last >= I64(lanes) - 1 else choose(is_at_most(lane, I16(last)), cost, NO_PARTNER)


@inlined
def _step(path, base, cost, small, large, row, pitch, j):
    """One step of a path (Hirschmueller, eq. 12).

    path: the predecessor's costs, with minimum `base`; small, large: P1 and P2, those of the row that begins at `row`,
    from reversed right column j on.
    """
    beside = minimum(from_below(path, HIGH), from_above(path, HIGH))
    least = minus(minimum(path, plus(beside, load_dealt(small, row, pitch, j, cost))), base)
    return plus(cost, minimum(least, load_dealt(large, row, pitch, j, cost)))


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
def _penalty_rows(edges_right, y, penalties, small, large, width):
    """P1 and P2 over the reversed right columns, for four directions, without and with an edge in the left image."""
    for direction in range(U(4)):
        for edge_left in range(U(2)):
            row = (direction * U(2) + edge_left) * width
            p1, p1_edge = penalties[edge_left], penalties[edge_left + ONE]
            p2, p2_edge = penalties[edge_left + U(3)], penalties[edge_left + U(4)]
            for j in range(width):
                edge = edges_right[direction, y, j] != 0
                small[row + j] = p1_edge if edge else p1
                large[row + j] = p2_edge if edge else p2


@njit
def _work_space(n):
    """`n` zeros that begin on a cache line."""
    space = np.zeros(n + U(32), I16)
    first = (64 - space.ctypes.data % 64) % 64 // 2
    return space[first : first + n]


@njit
def _note_row(totals, costs, place, ahead, right_width, least, found, y):
    """Complete what was found at the left pixels of a row: planes 2 to 8 of `Evidence.left`."""
    lanes = len(place)
    for k in range(found.shape[2]):
        best, low, last, at = found[0, y, k], least[k], min(right_width - 1 - ahead + k, lanes - 1), U(k * lanes)
        if 0 < best < last:
            found[2, y, k] = totals[at + place[best - 1]] - low
            found[3, y, k] = totals[at + place[best + 1]] - low
        for step in range(5):
            d = best + step - 2
            if best >= 0:
                found[4 + step, y, k] = costs[at + place[d]] if 0 <= d <= last else NONE


@njit
def _note_right(totals, place, ahead, lows, bests, wanted, found, y, w):
    """Write what was found at reversed right columns: planes as in `Evidence.right`."""
    lanes = U(len(place))
    for j in range(len(lows)):
        low, best = lows[j], bests[j]
        found[0, y, j] = best
        k = ahead + best - j
        if low < NONE and 0 < best < wanted - 1 and 0 < k < w - 1:
            found[1, y, j] = totals[U(k - 1) * lanes + place[best - 1]] - low
            found[2, y, j] = totals[U(k + 1) * lanes + place[best + 1]] - low


@inlined
def _sum_row(words, y, right, right_width, pitch, ahead, arms, lane, lanes, prefix, older, newest, sums):
    """Costs of a row, summed along the horizontal arms, added to the column sums from `older` on into `newest`."""
    h, w = U(words.shape[1]), U(words.shape[2])
    here, width, total = words[:, y], pitch * (lanes // U(PART)), spread(I16(0), lane)
    store(prefix, U(0), total)
    for x in range(w + LONGEST_U):
        if x < w:
            last = I64(right_width - ONE - ahead + x)
            cost = _census_cost(here, x, right, y * width, h * width, pitch, ahead - x, lane, lanes, last)
            total = plus(total, cost)
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
def _forward(y, w, width, pitch, ahead, arms, reciprocals, edges, lane, lanes, sums, costs, small, large, above,
             low_above, upper_right, low_right, totals):  # fmt: skip
    """Costs of a row; its paths from the left, from above and from the upper right, summed into `totals`."""
    side, low, turn = spread(I16(0), lane), I16(0), y % RING
    for k in range(w):
        below = (_ring_row(turn + U(arms[3, y, k]) + ONE) * w + k) * lanes
        beyond = (_ring_row(turn + RING - U(arms[2, y, k])) * w + k) * lanes
        j, at = ahead - k, k * lanes
        cost = _mean_cost(load(sums, below, lane), load(sums, beyond, lane), reciprocals[y, k])
        store(costs, at, cost)
        side = _step(side, low, cost, small, large, U(edges[0, y, k]) * width, pitch, j)
        low = lowest(side)
        row = (U(2) + U(edges[1, y, k])) * width
        down = _step(load(above, at, lane), low_above[k], cost, small, large, row, pitch, j)
        store(above, at, down)
        low_above[k] = lowest(down)
        row, before = (U(6) + U(edges[3, y, k])) * width, load(upper_right, at + lanes, lane)
        left_down = _step(before, low_right[k + ONE], cost, small, large, row, pitch, j)
        store(upper_right, at, left_down)
        low_right[k] = lowest(left_down)
        store(totals, at, plus(plus(side, down), left_down))


@inlined
def _backward(y, w, width, pitch, right_width, ahead, edges, lane, lanes, costs, small, large, upper_left, low_left,
              totals, wanted, right_lowest, right_best, place, spare, lows, found):  # fmt: skip
    """A row's paths from the right and from the upper left; its winners, and its bids for the right image."""
    side, low = spread(I16(0), lane), I16(0)
    bid, bidder = spread(NONE, lane), spread(I16(0), lane)
    for back in range(w):
        k = w - ONE - back
        j, at, row = ahead - k, k * lanes, U(0)
        cost = load(costs, at, lane)
        if back == 0:  # no predecessor, so no penalty matters
            side = _step(side, low, cost, small, large, row, pitch, j)
        else:
            row = U(edges[0, y, k + ONE]) * width
            side = _step(side, low, cost, small, large, row, pitch, j - ONE)
        low = lowest(side)
        row = (U(4) + U(edges[2, y, k])) * width
        right_down = _step(load(upper_left, at, lane), low_left[k], cost, small, large, row, pitch, j)
        store(upper_left, at + lanes, right_down)
        low_left[k + ONE] = lowest(right_down)
        total = plus(load(totals, at, lane), plus(side, right_down))
        store(totals, at, total)
        n = min(wanted, I16(right_width - ahead + k))
        # Lanes from n on take no part: they are not wanted, or their right pixels do not exist.
        offer = choose(is_below(lane, n), total, NONE)
        if n > 0:
            least = lowest(offer)
            best = first_marked(is_equal(offer, least))
            second = _second_peak(total, lane, best, n)
            found[0, y, k], found[1, y, k], lows[k] = best, NONE if second == NONE else I16(second - least), least
        # Bids for the right pixels that the lanes look at; ties go to the smaller disparity. Lane 0 is the last to bid
        # for its pixel; all others move on to the lane through which the next column looks at theirs.
        better = is_at_most(offer, bid)
        bid, bidder = choose(better, offer, bid), choose(better, lane, bidder)
        right_lowest[j], right_best[j] = first_lane(bid), first_lane(bidder)
        bid, bidder = from_above(bid, NONE), from_above(bidder, I16(0))
    store(spare, U(0), bid)
    store(spare, lanes, bidder)
    for d in range(lanes):
        right_lowest[ahead + ONE + d], right_best[ahead + ONE + d] = spare[place[d]], spare[lanes + place[d]]


@lru_cache
def stream_kernel(n_lanes: int) -> Callable[..., None]:
    """The kernel for a number of lanes (a multiple of 32), compiled on first use or loaded from numba's cache."""

    @compiled
    def stream(words_left, words_right, right_width, ahead, arms, reciprocals, edges_left, edges_right, wanted,
               penalties, place, found, found_right):  # fmt: skip
        h, w, pitch = U(words_left.shape[1]), U(words_left.shape[2]), U(words_right.shape[3])
        lane, lanes, right, wanted = lane_numbers(n_lanes), U(n_lanes), words_right.reshape(-1), I16(wanted)
        width = U(words_right.shape[2]) * pitch
        prefix, sums = _work_space(COLUMNS * lanes), _work_space(RING * w * lanes)
        costs, totals, above = _work_space(w * lanes), _work_space(w * lanes), _work_space(w * lanes)
        upper_left, upper_right = _work_space((w + ONE) * lanes), _work_space((w + ONE) * lanes)
        low_above, low_left, low_right = np.zeros(w, I16), np.zeros(w + ONE, I16), np.zeros(w + ONE, I16)
        small, large = np.zeros(U(8) * width, I16), np.zeros(U(8) * width, I16)
        right_lowest, right_best = np.zeros(width, I16), np.zeros(width, I16)
        lows, spare = np.zeros(w, I16), np.zeros(U(2) * lanes, I16)
        for y_in in range(h + LONGEST_V):
            if y_in < h:
                older, newest = y_in % RING * w * lanes, (y_in + ONE) % RING * w * lanes
                _sum_row(words_left, y_in, right, right_width, pitch, ahead, arms, lane, lanes, prefix, older, newest,
                         sums)  # fmt: skip
            if y_in < LONGEST_V:
                continue
            y = y_in - LONGEST_V
            _penalty_rows(edges_right, y, penalties, small, large, width)
            _forward(y, w, width, pitch, ahead, arms, reciprocals, edges_left, lane, lanes, sums, costs, small, large,
                     above, low_above, upper_right, low_right, totals)  # fmt: skip
            right_lowest[:] = NONE
            _backward(y, w, width, pitch, right_width, ahead, edges_left, lane, lanes, costs, small, large, upper_left,
                      low_left, totals, wanted, right_lowest, right_best, place, spare, lows, found)  # fmt: skip
            _note_row(totals, costs, place, I64(ahead), I64(right_width), lows, found, y)
            _note_right(totals, place, I64(ahead), right_lowest[:right_width], right_best, wanted, found_right, y,
                        I64(w))  # fmt: skip

    return stream
