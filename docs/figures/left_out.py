"""Matcher: how much of its score on a real pair is fit. `python -m docs.figures.left_out LEFT RIGHT DEPTH`.

One pair cannot say how a matcher does on others. Its image blocks can say a little: the fitted thresholds are chosen
anew on all blocks but one, and the block that was left out is scored. Blocks of one image share camera, light and
surfaces, so the result is the least that over-fitting costs, not the most.
"""

import sys
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Int

from render.matcher.d4.matcher import D4Matcher
from render.matcher.d4.settings import D4Settings
from studies.scoring.hole_classes import filled, scored_pixels
from studies.scoring.match import halved
from studies.store.stereo_files import read_pair, read_reference

BLOCKS = (3, 4)
"""Rows and columns of blocks; choice: each then holds some 200 holes of the reference."""
GRID = {
    "arm_threshold": (30, 36, 40, 44, 51),
    "second_peak": (195.0, 234.0, 273.0),
    "left_right_px": (0.75, 0.875, 1.0),
}
"""Values that the thresholds are chosen from, Default's and those around them."""


def block_counts(
    found: Bool[np.ndarray, "h w"], reference: Bool[np.ndarray, "h w"], counted: Bool[np.ndarray, "h w"]
) -> Int[np.ndarray, "b 2"]:
    """Per block the pixels that are holes in both, and in either."""
    both, either = found & reference & counted, (found | reference) & counted
    parts = [
        np.array_split(band, BLOCKS[1], axis=2) for band in np.array_split(np.stack([both, either]), BLOCKS[0], axis=1)
    ]
    return np.array([part.sum(axis=(1, 2)) for band in parts for part in band])


def iou(counts: Int[np.ndarray, "b 2"]) -> float:
    """Of all blocks together."""
    both, either = counts.sum(axis=0)
    return float(both / either)


def holes(settings: D4Settings, left: np.ndarray, right: np.ndarray, factor: int) -> Bool[np.ndarray, "h w"]:
    """Of the matcher, at the reference's resolution."""
    disparity = D4Matcher(settings).match(left, right)
    return (halved(disparity) if factor == 2 else disparity) == 0


def main() -> None:
    """Print the score of the default, of the best of the grid, and of each block by the best of the other blocks."""
    if len(sys.argv) != 4:
        sys.exit("usage: python -m docs.figures.left_out LEFT RIGHT DEPTH")
    left, right, _ = read_pair(Path(sys.argv[1]), Path(sys.argv[2]))
    reference = read_reference(Path(sys.argv[3]), left.shape)
    default = D4Matcher().match(left, right)
    counted = scored_pixels(filled(halved(default) if reference.factor == 2 else default), reference.factor)
    tried = [replace(D4Settings(), **dict(zip(GRID, values, strict=True))) for values in product(*GRID.values())]
    counts = np.array(
        [block_counts(holes(s, left, right, reference.factor), reference.holes, counted) for s in tried]
    )  # (settings, blocks, 2)
    scores = [iou(table) for table in counts]
    kept, chosen = [], []
    for block in range(counts.shape[1]):
        others = np.delete(counts, block, axis=1)
        chosen.append(int(np.argmax([iou(table) for table in others])))
        kept.append(counts[chosen[-1], block])
    print(f"{len(tried)} settings, {counts.shape[1]} blocks; hole IoU of all blocks together:")
    print(f"  the default                                  {scores[tried.index(D4Settings())]:.3f}")
    print(f"  the best, chosen on what it is scored on     {max(scores):.3f}: {named(tried[int(np.argmax(scores))])}")
    print(f"  each block by the best of the other blocks   {iou(np.array(kept)):.3f}")
    for index in sorted(set(chosen), key=chosen.count, reverse=True):
        print(
            f"    chosen for {chosen.count(index):2d} blocks: {named(tried[index])}, on all blocks {scores[index]:.3f}"
        )


def named(settings: D4Settings) -> str:
    """The chosen values."""
    return ", ".join(f"{name} {getattr(settings, name):g}" for name in GRID)


if __name__ == "__main__":
    main()
