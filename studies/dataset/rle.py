"""Masks as COCO run lengths: counts of alternating zeros and ones, column by column, zeros first.

Source: the COCO data format's uncompressed RLE, as bop_toolkit writes it into `scene_gt_coco.json`.
"""

from typing import Any

import numpy as np
from jaxtyping import Bool


def encoded(mask: Bool[np.ndarray, "h w"]) -> dict[str, Any]:
    """The mask's `segmentation`."""
    flat = mask.ravel(order="F")
    ends = np.flatnonzero(np.diff(flat, prepend=flat[:1])) if flat.size else np.zeros(0, int)
    counts = np.diff(np.concatenate([[0], ends, [flat.size]]))
    return {"counts": [0, *counts.tolist()] if flat.size and flat[0] else counts.tolist(), "size": list(mask.shape)}


def decoded(segmentation: dict[str, Any]) -> Bool[np.ndarray, "h w"]:
    """The mask again; ValueError if the counts do not fill the image."""
    counts, (h, w) = np.array(segmentation["counts"], int), segmentation["size"]
    if counts.sum() != h * w or np.any(counts < 0):
        raise ValueError(f"run lengths add up to {counts.sum()}, the image has {h * w} pixels")
    values = np.arange(len(counts)) % 2 == 1
    return np.repeat(values, counts).reshape(h, w, order="F")
