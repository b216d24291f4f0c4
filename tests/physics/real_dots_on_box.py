"""Dots of a real D435 on the matte side of a box; see `real_dots/README.md`."""

from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Bool, UInt8

FOCAL_PX = 427.12
"""Of the real pair, 848x480 [px]."""
SIDES = ("left", "right")
_FOLDER = Path(__file__).with_name("real_dots")
_BOX_SIDE = [(15, 80), (210, 21), (215, 51), (50, 113)]
"""Corners of the smooth part of the box's side in either cut-out (column, row)."""


def real_dots(side: str) -> tuple[UInt8[np.ndarray, "125 230"], Bool[np.ndarray, "125 230"]]:
    """The cut-out of the "left" or "right" image, and the box's side in it."""
    image = cv2.imread(str(_FOLDER / f"{side}.png"), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise FileNotFoundError(_FOLDER / f"{side}.png")
    region = np.zeros(image.shape, np.uint8)
    cv2.fillPoly(region, [np.array(_BOX_SIDE, np.int32)], 1)
    return image, region > 0
