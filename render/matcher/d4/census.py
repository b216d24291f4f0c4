"""Census transform of the D4-like matcher (Zabih and Woodfill, ECCV 1994)."""

from typing import no_type_check

import numpy as np
from jaxtyping import UInt8, UInt16

from render.matcher.compiled import compiled

CENSUS_RADIUS = 4
"""The 9 x 9 window of Intel's Default preset (librealsense, `presets.cpp`: census diameters 9 and 9) [px]."""

CENSUS_WORDS = 5
"""80 comparisons in words of 16 bits, so that bit counts stay in the 16-bit lanes of the costs."""


@no_type_check
@compiled
def _census_words(padded, offsets, words):
    _, h, w = words.shape
    pitch, flat = padded.shape[1], padded.reshape(-1)
    for y in range(h):
        centre = flat[(y + 4) * pitch + 4 : (y + 4) * pitch + 4 + w]
        for word in range(5):
            # Four neighbours at a time, so that the word is read and written a quarter as often.
            for first in range(16 * word, 16 * word + 16, 4):
                row = words[word, y]
                a = flat[y * pitch + offsets[first] : y * pitch + offsets[first] + w]
                b = flat[y * pitch + offsets[first + 1] : y * pitch + offsets[first + 1] + w]
                c = flat[y * pitch + offsets[first + 2] : y * pitch + offsets[first + 2] + w]
                d = flat[y * pitch + offsets[first + 3] : y * pitch + offsets[first + 3] + w]
                for x in range(w):
                    bits = np.uint8(a[x] > centre[x]) << np.uint8(3) | np.uint8(b[x] > centre[x]) << np.uint8(2)
                    bits |= np.uint8(c[x] > centre[x]) << np.uint8(1) | np.uint8(d[x] > centre[x])
                    row[x] = np.uint16(row[x] << np.uint16(4)) | np.uint16(bits)


def census(image: UInt8[np.ndarray, "h w"]) -> UInt16[np.ndarray, "5 h w"]:
    """80 bits a pixel, neighbour > centre over the 9 x 9 window row by row, edge replicated, in five words."""
    padded = np.pad(image, CENSUS_RADIUS, mode="edge")
    words = np.zeros((CENSUS_WORDS, *image.shape), np.uint16)
    rows, columns = np.divmod(np.delete(np.arange(81), 40), 9)
    _census_words(padded, rows * padded.shape[1] + columns, words)
    return words
