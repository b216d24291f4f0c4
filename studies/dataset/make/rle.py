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
