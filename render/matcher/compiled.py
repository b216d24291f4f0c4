"""Compilation of the hot loops with numba: without the GIL, and kept on disk so that later runs start at once."""

from collections.abc import Callable
from typing import Any

from numba import njit


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """`numba.njit` without the GIL, cached beside the module or in the user's cache folder.

    Divisors are not tested for zero, which would keep loops from becoming vector instructions. Where no folder can be
    written (a read-only image without a home), the function is compiled anew in every process.
    Numba renews a cached function only when its own module changes, so compiled functions call none of other modules
    but the instructions of `render.matcher.d4.lane_instructions`, whose meaning stays.
    """
    try:
        return njit(nogil=True, cache=True, error_model="numpy")(function)
    except RuntimeError:  # "no locator available": numba found no folder that it may write to
        return njit(nogil=True, error_model="numpy")(function)
