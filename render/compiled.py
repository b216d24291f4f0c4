"""Compilation of the hot loops with numba: without the GIL, and kept on disk so that later runs start at once."""

from collections.abc import Callable
from typing import Any

from numba import njit


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """`numba.njit(nogil=True)`, cached beside the module or in the user's cache folder.

    Where neither can be written (a read-only image without a home), the function is compiled anew in every process.
    Numba renews a cached function only when its own module changes, so compiled functions call none of other modules.
    """
    try:
        return njit(nogil=True, cache=True)(function)
    except RuntimeError:  # "no locator available": numba found no folder that it may write to
        return njit(nogil=True)(function)
