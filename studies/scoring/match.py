"""How like a camera's own depth a matcher's depth is: where holes are, how disparities differ, how fractions spread.

A reference at half resolution is decimated: its pixel is a hole where all four pixels of the pair are holes, and its
depth is taken as their lower median, as librealsense does.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
from jaxtyping import Bool, Float, UInt8

from studies.scoring.hole_classes import filled, hole_classes, scored_pixels
from studies.store.stereo_files import ReferenceDepth

BLOB_SIZES_PX = (1, 50, 200)
"""Lower ends of the blob sizes [px of the pair]. Below 50 px a camera does not repeat its own holes, so there their
number means more than their overlap."""
FRACTION_BINS = 8
"""Bins over one pixel in which pixel-locking shows."""


@dataclass(frozen=True)
class HoleScore:
    """Holes found against holes of the reference, in pixels of the reference."""

    reference: int
    found: int
    common: int

    @classmethod
    def of(cls, found: Bool[np.ndarray, "h w"], reference: Bool[np.ndarray, "h w"], where: np.ndarray) -> "HoleScore":
        """Count inside the mask `where`."""
        common = np.sum(found & reference & where)
        return cls(int(np.sum(reference & where)), int(np.sum(found & where)), int(common))

    @property
    def precision(self) -> float:
        """Share of the found holes that the reference has, NaN without any."""
        return self.common / self.found if self.found else float("nan")

    @property
    def recall(self) -> float:
        """Share of the reference's holes that were found, NaN without any."""
        return self.common / self.reference if self.reference else float("nan")

    @property
    def iou(self) -> float:
        """Intersection over union, NaN where neither has a hole."""
        union = self.reference + self.found - self.common
        return self.common / union if union else float("nan")

    def summary(self) -> dict[str, float]:
        """For machines."""
        return {**asdict(self), "precision": self.precision, "recall": self.recall, "iou": self.iou}


@dataclass(frozen=True)
class BlobScore:
    """Connected holes of one size."""

    at_least_px: int
    """Smallest size [px of the pair]."""
    reference: int
    """Blobs of the reference."""
    found: int
    """Blobs that were found."""
    recall: float
    """Share of their pixels in the reference that were found, NaN without any."""
    precision: float
    """Share of their found pixels that are holes of the reference, NaN without any."""


@dataclass(frozen=True)
class DisparityError:
    """Disparities against the reference where both are valid, after their median difference is taken out."""

    pixels: int
    offset_px: float
    """Median difference: calibration, not matching [px]."""
    p50_px: float
    """Median of the absolute error [px]."""
    p90_px: float
    """90th percentile [px]."""
    below_half: float
    """Share below half a pixel."""


@dataclass(frozen=True)
class MatchScore:
    """All of it."""

    holes: HoleScore
    classes: Mapping[str, HoleScore]
    blobs: tuple[BlobScore, ...]
    disparity: DisparityError | None
    """None for a reference without metric depth."""

    def summary(self) -> dict[str, Any]:
        """For machines."""
        return {
            "holes": self.holes.summary(),
            "classes": {name: score.summary() for name, score in self.classes.items()},
            "blobs": [asdict(blob) for blob in self.blobs],
            "disparity": asdict(self.disparity) if self.disparity else None,
        }


def score(
    disparity: Float[np.ndarray, "h w"],
    reference: ReferenceDepth,
    left: UInt8[np.ndarray, "h w"],
    focal_baseline: float,
) -> MatchScore:
    """Score disparities [px], 0 = hole, against a camera's own depth; focal_baseline: f B [px m]."""
    reduced = halved(disparity) if reference.factor == 2 else disparity
    truth = _disparity(reference, reduced, focal_baseline)
    where = scored_pixels(filled(truth), reference.factor)
    found, holes = reduced == 0, reference.holes
    classes = {
        name: HoleScore.of(found, holes, where & mask)
        for name, mask in hole_classes(truth, left, reference.factor).items()
    }
    blobs = _blobs(found & where, holes & where, reference.factor**2)
    error = _error(reduced, truth, where) if reference.metric else None
    return MatchScore(HoleScore.of(found, holes, where), classes, blobs, error)


def fraction_shares(disparity: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "8"]:
    """Share of the valid disparities whose fraction lies in each eighth of a pixel, over 1/8: flat is 1."""
    fractions = disparity[disparity > 0] % 1
    if fractions.size == 0:
        return np.full(FRACTION_BINS, np.nan)
    return np.histogram(fractions, FRACTION_BINS, (0, 1))[0] * (FRACTION_BINS / fractions.size)


def halved(disparity: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h_half w_half"]:
    """Lower median of the valid values of 2 x 2 blocks, 0 where there is none (an odd last row or column is left)."""
    h, w = (n // 2 for n in disparity.shape)
    blocks = disparity[: 2 * h, : 2 * w].reshape(h, 2, w, 2).swapaxes(1, 2).reshape(h, w, 4)
    ordered = np.sort(np.where(blocks > 0, blocks, np.inf), axis=-1)
    middle = np.maximum(np.sum(blocks > 0, axis=-1) - 1, 0) // 2
    value = np.take_along_axis(ordered, middle[..., None], axis=-1)[..., 0]
    return np.where(np.isfinite(value), value, 0.0)


def _disparity(reference: ReferenceDepth, measured: np.ndarray, focal_baseline: float) -> Float[np.ndarray, "h w"]:
    """The reference's disparity [px of the pair], 0 = hole; without a scale, that of the line through the measured."""
    depth = reference.depth
    if not reference.metric:
        both = (measured > 0) & ~reference.holes
        if np.sum(both) > 1 and np.ptp(depth[both]) > 0:
            slope, origin = _line(depth[both], focal_baseline / measured[both])
            depth = np.where(reference.holes, 0.0, np.maximum(origin + slope * depth, 1e-3))
    with np.errstate(divide="ignore"):
        return np.where(depth > 0, focal_baseline / depth, 0.0)


def _line(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Slope and origin by least squares, refitted without the tenth that fits worst (false depth)."""
    slope, origin = np.polyfit(x, y, 1)
    error = np.abs(origin + slope * x - y)
    keep = error <= np.quantile(error, 0.9)
    slope, origin = np.polyfit(x[keep], y[keep], 1) if np.ptp(x[keep]) > 0 else (slope, origin)
    return float(slope), float(origin)


def _error(found: np.ndarray, truth: np.ndarray, where: np.ndarray) -> DisparityError:
    both = (found > 0) & (truth > 0) & where
    if not both.any():
        return DisparityError(0, *[float("nan")] * 4)
    difference = (found - truth)[both]
    offset = float(np.median(difference))
    error = np.abs(difference - offset)
    p50, p90 = (float(p) for p in np.quantile(error, (0.5, 0.9)))
    return DisparityError(int(both.sum()), offset, p50, p90, float(np.mean(error < 0.5)))


def _blobs(found: np.ndarray, reference: np.ndarray, pair_pixels: int) -> tuple[BlobScore, ...]:
    sizes = [_blob_sizes(mask, pair_pixels) for mask in (found, reference)]
    limits = (*BLOB_SIZES_PX, np.inf)
    scores = []
    for low, high in pairwise(limits):
        counts, inside = [], []
        for size_map, areas in sizes:
            counts.append(int(np.sum((areas >= low) & (areas < high))))
            inside.append((size_map >= low) & (size_map < high))
        recall = _share(found, inside[1])
        precision = _share(reference, inside[0])
        scores.append(BlobScore(int(low), counts[1], counts[0], recall, precision))
    return tuple(scores)


def _blob_sizes(mask: np.ndarray, pair_pixels: int) -> tuple[np.ndarray, np.ndarray]:
    """Size of the blob that each pixel belongs to (0 outside), and of every blob [px of the pair]."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    areas = np.array(stats[:, cv2.CC_STAT_AREA], float) * pair_pixels
    areas[0] = 0
    return areas[np.asarray(labels, np.intp)], areas[1:]


def _share(mask: np.ndarray, among: np.ndarray) -> float:
    return float(np.mean(mask[among])) if among.any() else float("nan")
