"""The label maps of a frame as files: in colour for people, as numbers for programs, with the legend of both."""

from typing import Any

import cv2
import numpy as np
from jaxtyping import UInt8

from franbv.frames import Intrinsics
from render.depth.decimation import crop_centre
from render.labels.causes import LEGEND, Cause
from render.labels.labels import Labels

SWATCH, MARGIN, LETTER = 22, 10, 0.5
"""Height of a legend's line and its margin [px], and the size of its letters in OpenCV's unit (choice: legible)."""
LINE_WIDTH = 1000
"""Width of the legend [px] (choice: the longest meaning fits)."""


def colour_map(codes: UInt8[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h w 3"]:
    """A map of `Cause` codes in the legend's colours, red, green, blue."""
    table = np.zeros((256, 3), np.uint8)
    for cause, entry in LEGEND.items():
        table[cause] = entry.colour
    return table[codes]


def decimated_map(labels: Labels, intrinsics: Intrinsics, crop: tuple[int, int] | None) -> UInt8[np.ndarray, "h w"]:
    """The decimated map of a camera without crop, cropped as the planner's depth is. intrinsics: before the crop."""
    if crop is None:
        return labels.picture_decimated
    codes = labels.picture_decimated.astype(np.uint16)[None]
    return crop_centre(codes, intrinsics, crop)[0][0].astype(np.uint8)


def legend(labels: Labels) -> list[dict[str, Any]]:
    """Every code with its name, the cause of which it is a sub-kind, its colour, meaning and number of pixels."""
    counts = np.bincount(labels.picture.ravel(), minlength=256)
    return [
        {"code": int(cause), "name": entry.name, "cause": entry.group, "colour": list(entry.colour),
         "meaning": entry.meaning, "pixels": int(counts[cause])}
        for cause, entry in LEGEND.items()
    ]  # fmt: skip


def legend_picture() -> UInt8[np.ndarray, "h w 3"]:
    """Colour, name and meaning of every label."""
    picture = np.full((2 * MARGIN + SWATCH * len(LEGEND), LINE_WIDTH, 3), 255, np.uint8)
    for k, entry in enumerate(entry for cause, entry in LEGEND.items() if cause != Cause.UNMEASURED):
        y = MARGIN + k * SWATCH
        cv2.rectangle(picture, (MARGIN, y), (MARGIN + SWATCH, y + SWATCH - 5), entry.colour, cv2.FILLED)
        words = f"{entry.name.replace('_', ' ')}: {entry.meaning}"
        place = (2 * MARGIN + SWATCH, y + SWATCH - 9)
        cv2.putText(picture, words, place, cv2.FONT_HERSHEY_SIMPLEX, LETTER, (40, 40, 44), 1, cv2.LINE_AA)
    return picture[: MARGIN + SWATCH * len(LEGEND)]
