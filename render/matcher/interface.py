"""The stereo matcher's interface: pairs of infrared images in, disparities of the left image out."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float32, UInt8

from franbv.frames import N_DISPARITIES

SUBPIXEL_STEPS = 32
"""Disparity steps per pixel; the chip's own thresholds are counted in 1/32 px (librealsense, `STDepthControlGroup`)."""


PATH_MARGIN = 48
"""Pixels around a window that are matched with it, so that paths settle before they reach it [px]; choice: a path
forgets where it began after the few steps in which costs outweigh P2, and 48 are several dots."""


@dataclass(frozen=True)
class Window:
    """The pixels of the left image whose disparity is wanted."""

    left: int
    """First column [px]."""
    top: int
    """First row [px]."""
    width: int
    """Columns [px]."""
    height: int
    """Rows [px]."""

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns, to index an image with."""
        return slice(self.top, self.top + self.height), slice(self.left, self.left + self.width)

    @classmethod
    def around(cls, pixels: Bool[np.ndarray, "h w"]) -> "Window":
        """The smallest that holds these pixels, of which there is at least one."""
        rows, columns = np.flatnonzero(pixels.any(axis=1)), np.flatnonzero(pixels.any(axis=0))
        left, top = int(columns[0]), int(rows[0])
        return cls(left, top, int(columns[-1]) - left + 1, int(rows[-1]) - top + 1)

    @classmethod
    def whole(cls, shape: tuple[int, ...]) -> "Window":
        """All pixels of images of this (..., h, w) shape."""
        return cls(0, 0, shape[-1], shape[-2])


@runtime_checkable
class StereoMatcher(Protocol):
    """Anything that finds the disparities of rectified, row-aligned infrared pairs.

    A point at Z-depth Z has disparity d = f B / Z [px]. Every pair is matched by itself: nothing is carried over
    between the frames of a burst. A pixel without a match is 0; no confidence is given.
    """

    def match_burst(
        self,
        lefts: UInt8[np.ndarray, "n h w"],
        rights: UInt8[np.ndarray, "n h w"],
        window: Window | None = None,
        min_disparity: int = 0,
        n_disparities: int = N_DISPARITIES,
    ) -> Float32[np.ndarray, "n h w"]:
        """Disparities of a burst of pairs [px], 0 = invalid, multiples of 1/32 px.

        lefts, rights: 8-bit infrared images; left pixel (v, u) is right pixel (v, u - d).
        window: left pixels that are wanted, None = all. The result has full size and is 0 outside the window.
        min_disparity, n_disparities: integer disparities searched, min_disparity .. min_disparity + n_disparities - 1.
        """
        ...

    def match(
        self,
        left: UInt8[np.ndarray, "h w"],
        right: UInt8[np.ndarray, "h w"],
        window: Window | None = None,
        min_disparity: int = 0,
        n_disparities: int = N_DISPARITIES,
    ) -> Float32[np.ndarray, "h w"]:
        """Disparity of one pair [px], as `match_burst`."""
        return self.match_burst(left[None], right[None], window, min_disparity, n_disparities)[0]
