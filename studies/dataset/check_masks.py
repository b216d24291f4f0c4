"""What the masks of an object must satisfy: they are what the body map shows, and are counted and encoded rightly."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, UInt16

from studies.dataset import rle
from studies.dataset.layers import MASKS, Layer
from studies.dataset.reader import read_layer
from studies.dataset.view import bounding_box

Annotations = dict[tuple[int, int], dict[str, Any]]
"""COCO annotations by view and place of the object in it."""


def mask_faults(
    folder: Path,
    number: int,
    place: int,
    seen: Bool[np.ndarray, "h w"],
    depth: UInt16[np.ndarray, "h w"],
    info: dict[str, Any],
    annotations: Annotations,
) -> Iterator[tuple[str, str]]:
    """Masks agree with the body map, and counts, boxes and run lengths with the masks."""
    names = [f"{name}/{number:06d}_{place:06d}.png" for name in MASKS]
    whole, visible = (read_layer(folder / name, Layer(name, np.uint8, 1, "")) for name in names)
    if whole.shape != seen.shape or np.any(visible != np.where(seen, 255, 0)):
        yield names[1], "is not what the body map shows of the object"
        return
    if not np.isin(whole, [0, 255]).all() or np.any(seen & (whole == 0)):
        yield names[0], "does not hold the visible part"
    stated = (info["px_count_visib"], info["bbox_visib"], info["px_count_valid"])
    if stated != (int(seen.sum()), list(bounding_box(seen)), int(np.count_nonzero((whole > 0) & (depth > 0)))):
        yield "scene_gt_info.json", f"object {place}: counts or box are not those of the masks"
    inside = int(np.count_nonzero(whole))
    fraction = seen.sum() / info["px_count_all"] if info["px_count_all"] else 0.0
    if info["px_count_all"] < inside or abs(info["visib_fract"] - fraction) > 1e-9:
        yield "scene_gt_info.json", f"object {place}: visib_fract is not px_count_visib / px_count_all"
    entry = annotations.get((number, place))
    if (entry is not None) != bool(seen.any()):
        yield "scene_gt_coco.json", f"object {place}: annotated though unseen, or the other way round"
    elif entry is not None:
        again = rle.decoded(entry["segmentation"]), rle.decoded(entry["segmentation_full"])
        if np.any(again[0] != seen) or np.any(again[1] != (whole > 0)) or entry["area"] != seen.sum():
            yield "scene_gt_coco.json", f"object {place}: the run lengths are not those of the masks"
