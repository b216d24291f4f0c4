"""librealsense's hole filling: each hole gets the value of a neighbour.

It goes through the image in reading order and in place, so filled pixels fill the next ones and holes vanish to the
right. The neighbours are those above, above left, left, below left and below; the first column and, but for mode 0, the
first and the last row stay as they are.

Two traps, both of librealsense's making. "Farthest" takes the largest value: of disparity, where its recommended chain
runs the filter, that is the nearest. And "nearest" starts from the pixel above: below a hole it fills nothing.

Source: librealsense, `src/proc/hole-filling-filter.h` and `.cpp`.
"""

from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Shaped
from pydantic import BaseModel, ConfigDict, Field

from render.depth.filters.disparity import DepthOrDisparity


class HoleFillingSettings(BaseModel):
    """The option of `rs2::hole_filling_filter`, in librealsense's range and with its default.

    Unknown keys and numbers out of range raise pydantic's ValidationError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    mode: int = Field(default=1, ge=0, le=2)
    """0 takes the left neighbour, 1 the largest value around ("farthest"), 2 the smallest ("nearest"; `holes_fill`)."""


def holes_filled(frames: DepthOrDisparity, settings: HoleFillingSettings | None = None) -> DepthOrDisparity:
    """The frames with their holes filled, each for itself."""
    fill = (_from_left, _with_largest, _with_smallest)[(settings or HoleFillingSettings()).mode]
    filled = np.array(frames, order="C")
    for frame in filled:
        fill(frame)
    return filled


@no_type_check
@numba.njit(nogil=True, cache=True)
def _from_left(frame: Shaped[np.ndarray, "h w"]) -> None:
    height, width = frame.shape
    for v in range(height):
        for u in range(1, width):
            if frame[v, u] == 0:
                frame[v, u] = frame[v, u - 1]


@no_type_check
@numba.njit(nogil=True, cache=True)
def _with_largest(frame: Shaped[np.ndarray, "h w"]) -> None:
    height, width = frame.shape
    for v in range(1, height - 1):
        for u in range(1, width):
            if frame[v, u] == 0:
                above = max(frame[v - 1, u], frame[v - 1, u - 1])
                below = max(frame[v + 1, u - 1], frame[v + 1, u])
                frame[v, u] = max(above, frame[v, u - 1], below)


@no_type_check
@numba.njit(nogil=True, cache=True)
def _with_smallest(frame: Shaped[np.ndarray, "h w"]) -> None:
    height, width = frame.shape
    for v in range(1, height - 1):
        for u in range(1, width):
            if frame[v, u] == 0:
                smallest = frame[v - 1, u]
                for other in (frame[v - 1, u - 1], frame[v, u - 1], frame[v + 1, u - 1], frame[v + 1, u]):
                    if other != 0 and other < smallest:
                        smallest = other
                frame[v, u] = smallest
