"""Quantities that vary slowly over a surface, from few points: a grid that is refined where it has to be.

The idea of irradiance caching (Ward, Rubinstein and Clear 1988), over the image instead of the scene: values are asked
for at every n-th pixel and interpolated within each surface; where no point of the grid lies on a pixel's surface, or
where the points around it differ much, a finer grid is asked, down to the pixel itself.
"""

from collections.abc import Callable, Sequence
from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Bool, Float32

from render.world.surface import SAME_SURFACE_COSINE, SAME_SURFACE_OFFSET, SurfaceMap

WIDE_PX = 4
"""Grids of more than this distance serve a pixel only if all points about it lie on its own surface; on finer ones some
may do, which extrapolates by as much at the most (choice: three pixels)."""
ALL, SOME = 0.999, 0.1
"""Least share of a pixel's bilinear weights that points on its own surface have, on either kind of grid."""


def interpolated(
    surface: SurfaceMap,
    wanted: Bool[np.ndarray, "h w"],
    grids: Sequence[tuple[int, float]],
    values_at: Callable[[SurfaceMap, int], Float32[np.ndarray, "c p"]],
    beside: Float32[np.ndarray, "c h w"],
) -> Float32[np.ndarray, "c h w"]:
    """Values at the wanted pixels, 0 at others.

    grids: strides, falling, and how steep values may be: the next grid is asked where no point around a pixel lies on
    its surface, or where they differ by more than this share of the largest of them and of what is there `beside` the
    values. The last stride ought to be 1, which leaves out no pixel. values_at: of points of the map, in one
    row, on the grid of a stride.
    """
    channels = len(beside)
    out = np.zeros_like(beside)
    left = wanted.copy()
    for stride, steepest in grids:
        if not left.any():
            break
        coarse = surface.every(stride)
        needed = np.zeros(coarse.body.shape, bool)
        _mark(left, surface.body, coarse.body, stride, needed)
        numbers = np.flatnonzero(needed)
        if not len(numbers):
            continue
        values = np.zeros((channels, *coarse.body.shape), np.float32)
        values.reshape(channels, -1)[:, numbers] = values_at(coarse.points(numbers), stride)
        limits = np.float32(steepest), np.float32(ALL if stride > WIDE_PX else SOME)
        _fill(
            *(surface.body, surface.position, surface.normal),
            *(coarse.body, coarse.position, coarse.normal),
            *(values, beside, stride, limits, left, out),
        )
    return out


@no_type_check
@numba.njit(nogil=True, cache=True)
def _first_of_two(pixel, stride, count):
    """The nearest coarse point before a pixel (one in `stride`, `count` of them), and how far the pixel is past it."""
    place = (pixel - stride // 2) / stride
    first = min(max(int(np.floor(place)), 0), max(count - 2, 0))
    return first, np.float32(min(max(place - first, 0.0), 1.0))


@no_type_check
@numba.njit(nogil=True, cache=True)
def _mark(left, fine_body, body, stride, needed):
    """Set the coarse points that lie beside a pixel of the same body that is left."""
    rows, columns = body.shape
    height, width = left.shape
    for v in range(height):
        y0, fy = _first_of_two(v, stride, rows)
        for u in range(width):
            if left[v, u]:
                x0, fx = _first_of_two(u, stride, columns)
                for j in range(y0, min(y0 + (2 if fy > 0 else 1), rows)):
                    for i in range(x0, min(x0 + (2 if fx > 0 else 1), columns)):
                        if body[j, i] == fine_body[v, u]:
                            needed[j, i] = True


@no_type_check
@numba.njit(nogil=True, cache=True, fastmath=True)
def _fill(fine_body, fine_position, fine_normal, body, position, normal, values, beside, stride, limits, left, out):
    """Give the pixels that are left the mean of the points on their surface, and strike them off."""
    steepest, least_share = limits
    channels, rows, columns = values.shape
    height, width = left.shape
    least_cosine = np.float32(SAME_SURFACE_COSINE)
    one, nothing = np.float32(1), np.float32(0)
    weights = np.zeros(4, np.float32)
    for v in range(height):
        y0, fy = _first_of_two(v, stride, rows)
        for u in range(width):
            if not left[v, u]:
                continue
            x0, fx = _first_of_two(u, stride, columns)
            total = nothing
            for k in range(4):
                j, i = min(y0 + k // 2, rows - 1), min(x0 + k % 2, columns - 1)
                weights[k] = nothing
                if body[j, i] == fine_body[v, u]:
                    cosine, offset = nothing, nothing
                    for axis in range(3):
                        cosine += normal[j, i, axis] * fine_normal[v, u, axis]
                        offset += (position[j, i, axis] - fine_position[v, u, axis]) * fine_normal[v, u, axis]
                    if cosine > least_cosine and abs(offset) < SAME_SURFACE_OFFSET:
                        weights[k] = (fy if k // 2 else one - fy) * (fx if k % 2 else one - fx)
                        total += weights[k]
            if total < least_share:
                continue
            flat = True
            for c in range(channels):
                low, high, mean = np.float32(np.inf), nothing, nothing
                for k in range(4):
                    if weights[k] > nothing:
                        value = values[c, min(y0 + k // 2, rows - 1), min(x0 + k % 2, columns - 1)]
                        low, high, mean = min(low, value), max(high, value), mean + weights[k] * value
                flat &= high - low <= steepest * (high + beside[c, v, u])
                out[c, v, u] = mean / total
            left[v, u] = not flat
