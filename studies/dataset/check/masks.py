"""What the masks of a view must satisfy: they are what body map and models show, and BOP's counts follow from them."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics, project
from studies.dataset.format.layers import MASKS, Layer
from studies.dataset.format.reader import read_layer
from studies.dataset.make.view import NO_BOX, Silhouette, bounding_box

Box = tuple[int, int, int, int]
TIP_PX = 3
"""A tip thinner than a pixel, this long, can slip between the rays that make a silhouette [px] (choice)."""


def read_silhouettes(
    folder: Path, number: int, visible: Sequence[Bool[np.ndarray, "h w"]], info: list[dict[str, Any]]
) -> tuple[list[Silhouette], list[tuple[str, str]]]:
    """Silhouettes of a view's objects as files and `scene_gt_info.json` state them, and what is wrong with them.

    visible: pixels that see each object, by the body map.
    """
    found, faults = [], []
    for place, seen in enumerate(visible):
        names = [f"{name}/{number:06d}_{place:06d}.png" for name in MASKS]
        whole, shown = (read_layer(folder / name, Layer(name, np.uint8, 1, "")) for name in names)
        if whole.shape != seen.shape or np.any(shown != np.where(seen, 255, 0)):
            faults.append((names[1], "is not what the body map shows of the object"))
        if whole.shape != seen.shape or not np.isin(whole, [0, 255]).all() or np.any(seen & (whole == 0)):
            faults.append((names[0], "does not hold the visible part"))
            whole = np.where(seen, 255, 0)
        x, y, w, h = (int(side) for side in info[place]["bbox_obj"])
        found.append(Silhouette(whole > 0, (x, y, w, h), int(info[place]["px_count_all"])))
    return found, faults


def silhouette_fault(
    stated: Silhouette, in_sight: bool, vertices: Float[np.ndarray, "n 3"], pose: RigidTransform, k: Intrinsics
) -> str | None:
    """What cannot be of the box and the number of pixels of an object with these corners in the world [m].

    in_sight: whether anything of it is seen; otherwise it has no box. Inside the image both follow from the mask.
    Beyond it, on a canvas of three images' width and height, the box ends where the outermost corners are seen, short
    of those off the canvas, and holds no more pixels than fit in.
    """
    inside = int(np.count_nonzero(stated.mask))
    if not in_sight:
        right = stated.box == NO_BOX and inside <= stated.pixels <= 9 * k.width * k.height
        return None if right else "bbox_obj of an object out of sight is not -1, or px_count_all cannot be"
    x, y, w, h = stated.box
    left, top, right, bottom = max(x, 0), max(y, 0), min(x + w, k.width), min(y + h, k.height)
    if (left, top, right, bottom) == (x, y, x + w, y + h) or w <= 0:
        if (stated.box, stated.pixels) != (bounding_box(stated.mask), inside):
            return "bbox_obj or px_count_all is not that of the mask"
    elif not 0 <= stated.pixels - inside <= w * h - max(right - left, 0) * max(bottom - top, 0):
        return "px_count_all is more than the mask and what of bbox_obj lies beyond the image"
    points = pose.inv().apply(vertices)
    if np.any(points[:, 2] <= 1e-3):  # what is beside or behind the camera has no outline
        return None
    size = np.array([k.width, k.height])
    uv = project(points, k)
    outline = np.clip(np.stack([uv.min(axis=0), uv.max(axis=0)]), -size, 2 * size - 1)
    apart = np.array([[x, y], [x + w - 1, y + h - 1]]) - outline
    if np.any((uv < -size) | (uv > 2 * size - 1)):  # what is off the canvas may be wider than what is on it
        apart = np.stack([np.minimum(apart[0], 0), np.maximum(apart[1], 0)])
    if w > 0 and np.abs(apart).max() > TIP_PX:
        return "bbox_obj is not where the model is seen"
    return None
