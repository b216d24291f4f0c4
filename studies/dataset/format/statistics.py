"""What of a view is counted: pixels by material, angle of incidence and label, to be added up over many views."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from render.labels.causes import HOLES, LEGEND, Cause

BIN_DEG = 10
"""Width of a bin of incidence [deg] (choice: nine bins up to grazing)."""
COUNTED_FIELDS = ("material", "incidence_bin", "on_object", "label", "pixels")
"""What a row of counts holds. label: a `Cause`; nothing there has material 0 and bin 9."""


def counts(images: Mapping[str, np.ndarray], on_object: np.ndarray) -> list[list[int]]:
    """Rows of FIELDS for one view. on_object: pixels that see an object, (h, w)."""
    label = np.where(images["false_depth"] > 0, images["false_depth"], images["cause"]).astype(np.int64)
    incidence = np.minimum(images["incidence"] // (100 * BIN_DEG), 9).astype(np.int64)
    key = ((images["material"].astype(np.int64) * 10 + incidence) * 2 + on_object) * 256 + label
    found, pixels = np.unique(key, return_counts=True)
    columns = (found // 5120, found // 512 % 10, found // 256 % 2, found % 256, pixels)
    return np.stack(columns, axis=1).tolist()


@dataclass(frozen=True, eq=False)
class Counts:
    """Counts of many views added up."""

    rows: np.ndarray
    """(n, 5) int64 by FIELDS, each combination once."""

    @classmethod
    def total(cls, views: Iterable[list[list[int]]]) -> "Counts":
        """The sum over views."""
        parts = [np.array(view, np.int64).reshape(-1, 5) for view in views]
        rows = np.concatenate(parts) if parts else np.zeros((0, 5), np.int64)
        keys, place = np.unique(rows[:, :4], axis=0, return_inverse=True)
        pixels = np.bincount(place.ravel(), rows[:, 4], len(keys)).astype(np.int64)
        return cls(np.column_stack([keys, pixels]))

    def pixels(
        self,
        *,
        material: int | None = None,
        angle: int | None = None,
        labels: Iterable[int] | None = None,
        everywhere: bool = False,
    ) -> int:
        """Pixels of this material, bin of incidence and any of these labels, None = all; of objects, or everywhere."""
        keep = np.full(len(self.rows), True) if everywhere else self.rows[:, 2] == 1
        for column, wanted in ((0, material), (1, angle)):
            if wanted is not None:
                keep &= self.rows[:, column] == wanted
        if labels is not None:
            keep &= np.isin(self.rows[:, 3], [int(label) for label in labels])
        return int(self.rows[keep, 4].sum())

    def materials(self) -> list[int]:
        """Those that objects are made of, by falling number of pixels."""
        present = np.unique(self.rows[(self.rows[:, 2] == 1) & (self.rows[:, 0] > 0), 0]).tolist()
        return sorted(present, key=lambda number: -self.pixels(material=number))


FALSE_DEPTH = (Cause.FALSE_DEPTH_REFLECTION, Cause.FALSE_DEPTH_OTHER)
LABEL_NAMES = {int(cause): LEGEND[cause].name for cause in (Cause.MEASURED, *HOLES, *FALSE_DEPTH)}
"""What the codes of label maps mean."""
