"""Census transform of the D4-like matcher (Zabih and Woodfill, ECCV 1994)."""

from typing import no_type_check

import numpy as np
from jaxtyping import UInt8, UInt16

from render.compiled import compiled

CENSUS_RADIUS = 4
"""The 9 x 9 window of Intel's Default preset (librealsense, `presets.cpp`: census diameters 9 and 9) [px]."""

CENSUS_WORDS = 5
"""80 comparisons in words of 16 bits, so that bit counts stay in the 16-bit lanes of the costs."""


@no_type_check
@compiled
def _census_words(padded, words):
    _, h, w = words.shape
    for y in range(h):
        bit = 0
        for dy in range(9):
            for dx in range(9):
                if dy == 4 and dx == 4:
                    continue
                centre = padded[y + 4, 4 : 4 + w]
                neighbour = padded[y + dy, dx : dx + w]
                word = words[bit // 16, y]
                for x in range(w):
                    word[x] = np.uint16(word[x] << np.uint16(1)) | np.uint16(neighbour[x] > centre[x])
                bit += 1


def census(image: UInt8[np.ndarray, "h w"]) -> UInt16[np.ndarray, "5 h w"]:
    """80 bits a pixel, neighbour > centre over the 9 x 9 window row by row, edge replicated, in five words."""
    padded = np.pad(image, CENSUS_RADIUS, mode="edge")
    words = np.zeros((CENSUS_WORDS, *image.shape), np.uint16)
    _census_words(padded, words)
    return words
