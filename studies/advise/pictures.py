"""Pictures before and after: infrared, what became of the part's surface, and why."""

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import UInt8

from render.labels.causes import LEGEND, Cause
from studies.advise.explained import OUTCOME_COLOURS, ExplainedView
from studies.store.images import data_uri, photo_uri

FRAME_PX = 12
"""Shown around the part [px]."""
SHOWN_PX = 360
"""Longer side of a picture, which small parts are enlarged to [px] (choice: three fit beside each other)."""
AFTERWARDS_COLOUR = (90, 90, 200)
"""Of what merge, filters or second look lost [red, green, blue]."""
DIMMED = 0.35
"""How bright what is not the part is shown [-]."""


def picture_rows(before: Sequence[ExplainedView], after: Sequence[ExplainedView]) -> list[dict[str, str]]:
    """Of each pose: infrared, outcome and cause, before and after, as data URIs."""
    rows = []
    for one, other in zip(before, after, strict=True):
        rows.append(
            {f"{name}_before": uri for name, uri in _pictures(one).items()}
            | {f"{name}_after": uri for name, uri in _pictures(other).items()}
        )
    return rows


def _pictures(view: ExplainedView) -> dict[str, str]:
    box = _box(view)
    infrared = _enlarged(view.infrared[box], smooth=True)
    return {
        "infrared": photo_uri(infrared),
        "outcome": data_uri(_enlarged(outcome_picture(view)[box])),
        "cause": data_uri(_enlarged(losses_picture(view)[box])),
    }


def outcome_picture(view: ExplainedView) -> UInt8[np.ndarray, "h w 3"]:
    """Right, false and missing depth in their colours on the part, the dimmed image around it."""
    image = _dimmed(view)
    on_part = view.area > 0
    for outcome, colour in OUTCOME_COLOURS.items():
        image[on_part & (view.outcome == outcome)] = colour
    return image


def losses_picture(view: ExplainedView) -> UInt8[np.ndarray, "h w 3"]:
    """Causes in the legend's colours where right depth is missing."""
    image = _dimmed(view)
    image[(view.area > 0) & (view.cause == Cause.MEASURED)] = (214, 222, 219)
    for cause in np.unique(view.cause[view.cause != Cause.MEASURED]).tolist():
        image[view.cause == cause] = AFTERWARDS_COLOUR if cause == Cause.UNMEASURED else LEGEND[Cause(cause)].colour
    return image


def _dimmed(view: ExplainedView) -> UInt8[np.ndarray, "h w 3"]:
    return np.repeat((DIMMED * view.infrared).astype(np.uint8)[..., None], 3, axis=-1)


def _box(view: ExplainedView) -> tuple[slice, slice]:
    """Rows and columns around the part."""
    rows, columns = (np.flatnonzero((view.area > 0).any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return slice(None), slice(None)
    (top, bottom), (left, right) = (rows[0], rows[-1]), (columns[0], columns[-1])
    return (
        slice(max(top - FRAME_PX, 0), bottom + FRAME_PX + 1),
        slice(max(left - FRAME_PX, 0), right + FRAME_PX + 1),
    )


def _enlarged(image: np.ndarray, smooth: bool = False) -> np.ndarray:
    factor = max(1, SHOWN_PX // max(image.shape[:2]))
    way = cv2.INTER_LINEAR if smooth else cv2.INTER_NEAREST
    return cv2.resize(image, None, fx=factor, fy=factor, interpolation=way)
