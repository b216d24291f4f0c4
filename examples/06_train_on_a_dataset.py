"""A dataset as a PyTorch data loader reads it, without PyTorch: `__len__`, `__getitem__`, batches of arrays.

`torch.utils.data.DataLoader(HolesOnMetal("DIR"), batch_size=8)` takes the same class as it is.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import studies.dataset
from studies.cli.main import main

CONFIG = """
title: Four small views of part C1
views: 4
objects: {parts: {C1: 1}, arrangement: {single: 1}}
materials: {kind: {metal: 1}, metals: {aluminium: 1}, finishes: {milled: 1, polished: 1}, non_metals: {rubber: 1}}
surroundings: {tables: {wood_table: 1}, lamps: {workshop: 1}, clutter: [0, 1], clutter_materials: {rubber: 1}}
camera: {profiles: {424x240: 1}}
poses: {per_scene: 2}
"""


class HolesOnMetal:
    """Infrared pair and depth in, cause of every hole and true depth out; channels first."""

    def __init__(self, folder: Path) -> None:
        self.views = studies.dataset.open(folder)

    def __len__(self) -> int:
        return len(self.views)

    def __getitem__(self, index: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        view = self.views[index]
        infrared = np.stack([view.gray, view.gray_right]).astype(np.float32) / 255
        inputs = np.concatenate([infrared, view.depth[None]])  # (3, h, w)
        return inputs, view.cause.astype(np.int64), view.depth_true


if __name__ == "__main__":  # the worker processes import this file
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(tempfile.mkdtemp()) / "dataset"
    if not folder.exists():
        folder.with_suffix(".yaml").write_text(CONFIG)
        main(["dataset", "make", str(folder.with_suffix(".yaml")), str(folder), "--workers", "1"])
    samples = HolesOnMetal(folder)
    for start in range(0, len(samples), 2):
        batch = [samples[index] for index in range(start, min(start + 2, len(samples)))]
        inputs, causes, truth = (np.stack(arrays) for arrays in zip(*batch, strict=True))
        missing = causes > 0
        error = np.abs(inputs[:, 2] - truth)[~missing]
        most = samples.views.causes[int(np.bincount(causes[missing]).argmax())]
        print(
            f"{inputs.shape}: {missing.mean():.1%} without depth, mostly {most}; else off by {np.median(error):.4f} m"
        )
