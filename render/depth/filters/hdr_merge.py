"""librealsense's HDR merge: one depth image of two that were taken in turns with different exposures.

The first frame's depth counts wherever it is valid, the second fills its holes. With infrared images of the same size,
a depth is valid only where its own infrared image is neither dark nor saturated, and only these are taken: a pixel
that is badly exposed in both is a hole, whatever depth was there.

Source: librealsense, `src/proc/hdr-merge.h` and `.cpp`.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, UInt8, UInt16

Infrared = UInt8[np.ndarray, "h_i w_i"] | UInt16[np.ndarray, "h_i w_i"]
"""One infrared image: Y8, or Y16 with 10 bits."""
TOO_DARK = {np.dtype(np.uint8): 5, np.dtype(np.uint16): 20}
"""Grey values up to this one tell nothing [DN] (`IR_UNDER_SATURATED_VALUE_Y8`, `_Y16`)."""
TOO_BRIGHT = {np.dtype(np.uint8): 250, np.dtype(np.uint16): 1003}
"""Grey values from this one on tell nothing [DN] (`IR_OVER_SATURATED_VALUE_Y8`, `_Y16`)."""
SEQUENCE = 2
"""Number of exposures that take turns; librealsense merges no other sequences."""
OUTDATED = 4
"""So many frames after its first one a merged frame is not given out any more (`SEQUENTIAL_FRAMES_THRESHOLD`)."""


@dataclass(frozen=True, eq=False)
class HdrFrame:
    """What one exposure of the sequence gives."""

    depth: UInt16[np.ndarray, "h w"]
    """[units], 0 = invalid."""
    infrared: Infrared | None = None
    """The same frame of the infrared stream, of the left imager where there are two; None without."""


def hdr_merged(first: HdrFrame, second: HdrFrame) -> UInt16[np.ndarray, "h w"]:
    """One depth image of two of equal size.

    Infrared counts if both frames have it, in one format and in the size of the depth.
    """
    grey, later_grey = first.infrared, second.infrared
    if grey is None or later_grey is None or grey.dtype != later_grey.dtype:
        return np.where(first.depth != 0, first.depth, second.depth)
    if not grey.shape == later_grey.shape == first.depth.shape:
        return np.where(first.depth != 0, first.depth, second.depth)
    later = np.where(_well_exposed(later_grey), second.depth, np.uint16(0))
    return np.where(_well_exposed(grey) & (first.depth != 0), first.depth, later)


def _well_exposed(grey: Infrared) -> Bool[np.ndarray, "h_i w_i"]:
    return (grey > TOO_DARK[grey.dtype]) & (grey < TOO_BRIGHT[grey.dtype])


class HdrMerge:
    """The filter as a stream goes through it: each frame is answered by the last merged depth.

    A merged depth is given out again while the next pair is being taken, so of a sequence of n frames there are n / 2
    different images. Pairs are frames n and n + 1 with sequence numbers 0 and 1; other frames merge with nothing.
    """

    def __init__(self) -> None:
        """Nothing is merged yet."""
        self._pair: list[tuple[int, HdrFrame]] = []
        self._merged: tuple[int, UInt16[np.ndarray, "h w"]] | None = None

    def process(self, frame: HdrFrame, number: int, sequence_id: int) -> UInt16[np.ndarray, "h w"]:
        """What the filter gives out: a merged depth, or this frame's own while there is none.

        number: the frame counter of its metadata. sequence_id: which of the two exposures it had, 0 or 1.
        """
        if len(self._pair) == sequence_id:
            self._pair.append((number, frame))
        if self._merged is not None:
            since, depth = self._merged
            if not 0 <= number - since < OUTDATED or depth.shape != frame.depth.shape:
                self._merged = None
        if len(self._pair) == SEQUENCE:
            (number_0, first), (number_1, second) = self._pair
            self._pair = []
            if number_0 + 1 == number_1 and first.depth.shape == second.depth.shape:
                self._merged = number_0, hdr_merged(first, second)
        return frame.depth if self._merged is None else self._merged[1]
