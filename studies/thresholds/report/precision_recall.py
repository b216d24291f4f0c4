"""Precision and recall of the reflective regions, by pixel over all views of the bank, under every setting.

Recall is the share of the reflective holes' pixels that are in a region, precision the share of the regions' pixels
that are reflective holes. Settings that differ in one parameter alone are a curve.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Int

TRACED_FIRST = "cluster_min_samples"
"""Parameter that curves are traced along where it has several values (choice: how many pixels make a region is what
trades one for the other)."""


@dataclass(frozen=True)
class OperatingPoint:
    """A setting of the views' grid."""

    view_setting: int
    """Its number in the grid."""
    values: Mapping[str, Any]
    """By parameter."""
    recall: float
    precision: float


@dataclass(frozen=True)
class PrecisionRecall:
    """All that can be said of the settings of a grid."""

    traced: str | None
    """Parameter along which the curves go; None of a single setting."""
    curves: tuple[tuple[OperatingPoint, ...], ...]
    """One for each combination of the other parameters that has a point, in the order of the values of `traced`."""
    holes_px: int
    """Pixels of reflective holes over all views."""
    settings: int
    """Of the grid."""

    @property
    def points(self) -> tuple[OperatingPoint, ...]:
        """Of all curves: the settings that have both numbers."""
        return tuple(point for curve in self.curves for point in curve)


def precision_recall(settings: Sequence[Mapping[str, Any]], pixels: Int[np.ndarray, "k 3"]) -> PrecisionRecall:
    """Of a grid. A setting without a pixel in a region has no precision, and views without holes leave no recall: such
    settings are no points.

    settings: what each sets; pixels: of each, those in regions that are reflective holes, those in regions, and the
    reflective holes'.
    """
    traced = traced_parameter(settings)
    curves: dict[tuple[Any, ...], list[OperatingPoint]] = {}
    for number, (values, (right, in_regions, holes)) in enumerate(zip(settings, pixels.tolist(), strict=True)):
        if in_regions and holes:
            others = tuple(value for name, value in values.items() if name != traced)
            point = OperatingPoint(number, values, right / holes, right / in_regions)
            curves.setdefault(others, []).append(point)
    ordered = (sorted(points, key=lambda p: _place(p.values, traced)) for points in curves.values())
    return PrecisionRecall(traced, tuple(tuple(points) for points in ordered), int(pixels[:, 2].max()), len(settings))


def traced_parameter(settings: Sequence[Mapping[str, Any]]) -> str | None:
    """TRACED_FIRST if it has several values, else the parameter that has most; None if none has several."""
    counts = {name: len({values[name] for values in settings}) for name in settings[0]}
    if counts.get(TRACED_FIRST, 1) > 1:
        return TRACED_FIRST
    most = max(counts, key=lambda name: counts[name], default=None)
    return most if most is not None and counts[most] > 1 else None


def _place(values: Mapping[str, Any], traced: str | None) -> float:
    """Numbers in their order; words keep that in which they are stated."""
    value = None if traced is None else values[traced]
    return float(value) if isinstance(value, int | float) else 0.0
