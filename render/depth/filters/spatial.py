"""librealsense's spatial filter: an edge-preserving smoothing along rows and columns, to and fro.

Each pass is an exponential moving average that starts anew at holes and at steps. Depth and disparity have different
rules, all of them librealsense's:

- depth is rounded to whole units after every pass, disparity is not;
- a step is a difference to the *smoothed* neighbour in depth, of more than `delta` along rows and of at least `delta`
  along columns; in disparity it is one to the *original* neighbour, of at least `delta`;
- depth is averaged with holes on the way down the columns: within `delta` units of 0, which is nearer than any camera
  sees, a hole below a depth gets one and a depth below a hole comes nearer;
- the first pass over a row of depth leaves out its last pixel, and the second takes a depth of 1 unit for a hole.

Hole filling copies values into the holes beside them, along rows alone: from the left, then from the right, less than
`RADII` pixels each. In depth it happens on the way, anew in every iteration, and leaves the last column as it is. In
disparity it happens once, at the end, and leaves the first column as it is; there a hole at the end of a row gets the
first value of the next row, since librealsense goes through memory. Behind the last row it reads what lies beyond its
image, a number by chance; here it is a hole, the one difference between this filter and librealsense's.

Sources: librealsense, `src/proc/spatial-filter.h` and `.cpp`; E. Gastal and M. Oliveira, Domain Transform for
Edge-Aware Image and Video Processing, SIGGRAPH 2011.
"""

from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Float32, UInt16
from pydantic import BaseModel, ConfigDict, Field

from render.depth.filters.disparity import DepthOrDisparity

RADII = (0, 2, 4, 8, 16, 255)
"""Where hole filling ends, by `holes_fill` [px]; it fills one pixel less. 0 is off, 255 is "Unlimited"."""


class SpatialSettings(BaseModel):
    """The options of `rs2::spatial_filter`, in librealsense's ranges and with its defaults.

    Unknown keys and numbers out of range raise pydantic's ValidationError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    alpha: float = Field(default=0.5, ge=0.25, le=1.0)
    """Weight of a pixel against its smoothed neighbour (`filter_smooth_alpha`); 1 smoothes nothing."""
    delta: int = Field(default=20, ge=1, le=50)
    """A difference of neighbours that is a step [units of depth, or 1/32 px of disparity] (`filter_smooth_delta`)."""
    magnitude: int = Field(default=2, ge=1, le=5)
    """Number of iterations (`filter_magnitude`)."""
    holes_fill: int = Field(default=0, ge=0, le=len(RADII) - 1)
    """Which of `RADII` ends hole filling (`holes_fill`)."""


def spatially_filtered(frames: DepthOrDisparity, settings: SpatialSettings | None = None) -> DepthOrDisparity:
    """The frames smoothed, each for itself. Images have at least two rows and two columns."""
    settings = settings or SpatialSettings()
    smooth = _smooth_depth if frames.dtype == np.uint16 else _smooth_disparity
    filtered = np.array(frames, order="C")
    for frame in filtered:
        smooth(frame, settings)
    return filtered


def _smooth_depth(z16: UInt16[np.ndarray, "h w"], settings: SpatialSettings) -> None:
    alpha, radius = np.float32(settings.alpha), RADII[settings.holes_fill]
    for _ in range(settings.magnitude):
        _depth_rows(z16, alpha, settings.delta, radius)
        _depth_columns(z16, alpha, settings.delta)


def _smooth_disparity(disparity: Float32[np.ndarray, "h w"], settings: SpatialSettings) -> None:
    alpha, delta, radius = np.float32(settings.alpha), np.float32(settings.delta), RADII[settings.holes_fill]
    for _ in range(settings.magnitude):
        # Rows as columns of the transposed image: passes over all columns at once are the faster ones.
        rows = np.ascontiguousarray(disparity.T)
        _disparity_columns(rows, alpha, delta, False)
        _disparity_columns(rows, alpha, delta, True)
        disparity[:] = rows.T
        _disparity_columns(disparity, alpha, delta, False)
        _disparity_columns(disparity, alpha, delta, True)
    if radius:
        _fill_rows(disparity, radius)


@no_type_check
@numba.njit(nogil=True, cache=True)
def _mixed(here: np.int32, neighbour: np.int32, alpha: np.float32) -> np.int32:
    """Their average, rounded half up."""
    mean = np.float32(here) * alpha + np.float32(neighbour) * (np.float32(1.0) - alpha)
    return np.int32(mean + np.float32(0.5))


@no_type_check
@numba.njit(nogil=True, cache=True)
def _depth_rows(z16: UInt16[np.ndarray, "h w"], alpha: np.float32, delta: int, radius: int) -> None:
    """To the right and back, holes filled on the way."""
    height, width = z16.shape
    for v in range(height):
        _along_row(z16[v], 0, width - 1, 1, 0, alpha, delta, radius)
        _along_row(z16[v], width - 1, -1, -1, 1, alpha, delta, radius)  # a depth of 1 counts as a hole on the way back


@no_type_check
@numba.njit(nogil=True, cache=True)
def _along_row(
    row: UInt16[np.ndarray, "w"],
    first: int,
    end: int,
    step: int,
    hole: int,
    alpha: np.float32,
    delta: int,
    radius: int,
) -> None:
    """From the first pixel up to before `end`; depths up to `hole` [units] are holes."""
    last, filled = np.int32(row[first]), 0
    for u in range(first + step, end, step):
        here = np.int32(row[u])
        if last > 0 and here > hole:
            filled = 0
            if abs(here - last) <= delta:
                here = _mixed(here, last, alpha)
        elif last > 0:
            filled += 1
            if filled < radius:
                here = last
        row[u] = here
        last = here


@no_type_check
@numba.njit(nogil=True, cache=True)
def _depth_columns(z16: UInt16[np.ndarray, "h w"], alpha: np.float32, delta: int) -> None:
    """Down and up again, row by row; holes count as depth 0 on the way down."""
    height, width = z16.shape
    for v in range(1, height):
        for u in range(width):
            last, here = np.int32(z16[v - 1, u]), np.int32(z16[v, u])
            if abs(here - last) < delta:
                z16[v, u] = _mixed(here, last, alpha)
    for v in range(height - 2, -1, -1):
        for u in range(width):
            last, here = np.int32(z16[v + 1, u]), np.int32(z16[v, u])
            if last > 0 and here > 0 and abs(here - last) < delta:
                z16[v, u] = _mixed(here, last, alpha)


@no_type_check
@numba.njit(nogil=True, cache=True)
def _disparity_columns(
    disparity: Float32[np.ndarray, "h w"], alpha: np.float32, delta: np.float32, upwards: bool
) -> None:
    """One pass along the columns, all of them at once."""
    rest = np.float32(1.0) - alpha
    height, width = disparity.shape
    original = disparity[height - 1 if upwards else 0].copy()
    for k in range(1, height):
        v = height - 1 - k if upwards else k
        row, smoothed = disparity[v], disparity[v + 1 if upwards else v - 1]
        for u in range(width):
            last, here = original[u], row[u]
            original[u] = here
            mixed = here * alpha + smoothed[u] * rest
            # No branches, so that several columns go through one instruction.
            row[u] = mixed if (here > 0) & (last > 0) & (abs(last - here) < delta) else here


@no_type_check
@numba.njit(nogil=True, cache=True)
def _fill_rows(disparity: Float32[np.ndarray, "h w"], radius: int) -> None:
    """To the right and back; the next row's first pixel stands to the right of a row's last one, as in memory."""
    height, width = disparity.shape
    for v in range(height):
        filled = 0
        for u in range(1, width):
            if disparity[v, u] != 0:
                filled = 0
                continue
            filled += 1
            if filled < radius:
                disparity[v, u] = disparity[v, u - 1]
        filled = 0
        last = disparity[v + 1, 0] if v < height - 1 else np.float32(0.0)
        for u in range(width - 1, 0, -1):
            if disparity[v, u] != 0:
                filled = 0
            else:
                filled += 1
                if filled < radius:
                    disparity[v, u] = last
            last = disparity[v, u]
