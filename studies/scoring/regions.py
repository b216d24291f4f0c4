"""Detected regions in space against the true surface that is missing: 3-D overlap by area.

A box stands for the true surface inside it, as far as the view sees it; what it should hold is one connected patch of
surface that reflection hides. Each box is held against the patch that it overlaps best.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial.transform import RigidTransform

from franbv.reflective_regions import Detection
from render.d435i import SimulatedD435i
from render.labels.labels import Labels
from render.world.truth import Truth
from studies.scoring.missing_surface import Surface, block_pixels, missing_patches, visible_surface
from studies.scoring.pixels import share


@dataclass(frozen=True)
class RegionScore:
    """One detected region."""

    patch: int | None
    """Index of the missing patch that its box overlaps best; None if it meets none."""
    found_area: float
    """True surface in the box [m^2]."""
    patch_area: float
    """That of the patch [m^2]; 0 without one."""
    both_area: float
    """Part of the patch in the box [m^2]."""
    in_front: float
    """Median distance along the view rays by which the region's points lie before the true surface [m]."""

    @property
    def precision(self) -> float:
        """Share of the surface in the box that is the missing patch; 0 for a box that holds no surface."""
        return self.both_area / self.found_area if self.found_area > 0 else 0.0

    @property
    def recall(self) -> float:
        """Share of the patch that is in the box; 0 without a patch."""
        return self.both_area / self.patch_area if self.patch_area > 0 else 0.0

    @property
    def iou(self) -> float:
        """Area in both over area in either; 0 without overlap."""
        either = self.found_area + self.patch_area - self.both_area
        return self.both_area / either if either > 0 else 0.0


@dataclass(frozen=True)
class PatchScore:
    """One connected patch of missing surface."""

    area: float
    """[m^2]"""
    best_iou: float
    """With the box that overlaps it best; 0 if none does."""
    found_share: float
    """Share of its area that lies in any box."""


def score_regions(
    camera: SimulatedD435i, T_world_cam: RigidTransform, truth: Truth, labels: Labels, detection: Detection
) -> tuple[tuple[RegionScore, ...], tuple[PatchScore, ...]]:
    """Scores of all detected regions, largest box first, and of all missing patches, most pixels first."""
    surface = visible_surface(truth, camera.rig.intrinsics, T_world_cam)
    seen = np.unique(block_pixels(camera))
    patches = missing_patches(camera, labels)
    inside = [_inside(box.contains(surface.points[seen]), seen, len(surface.points)) for box in detection.boxes]
    offsets = _in_front(camera, truth, T_world_cam, detection)
    regions = tuple(
        _region_score(surface, box, patches, _median(offsets[detection.labels == k])) for k, box in enumerate(inside)
    )
    return regions, tuple(_patch_score(surface, patch, inside) for patch in patches)


def _inside(chosen: Bool[np.ndarray, "k"], pixels: Int[np.ndarray, "k"], count: int) -> Bool[np.ndarray, "n"]:
    """The chosen ones of some pixels as a mask of all."""
    mask = np.zeros(count, bool)
    mask[pixels[chosen]] = True
    return mask


def _region_score(
    surface: Surface, box: Bool[np.ndarray, "n"], patches: Sequence[Int[np.ndarray, "_"]], in_front: float
) -> RegionScore:
    found = float(surface.areas[box].sum())
    scores = [
        RegionScore(k, found, float(surface.areas[p].sum()), float(surface.areas[p][box[p]].sum()), in_front)
        for k, p in enumerate(patches)
    ]
    best = max(scores, key=lambda score: score.iou, default=None)
    return best if best is not None and best.both_area > 0 else RegionScore(None, found, 0.0, 0.0, in_front)


def _patch_score(surface: Surface, patch: Int[np.ndarray, "p"], boxes: Sequence[Bool[np.ndarray, "n"]]) -> PatchScore:
    area = float(surface.areas[patch].sum())
    ious = [_region_score(surface, box, [patch], 0.0).iou for box in boxes]
    covered = np.any([box[patch] for box in boxes], axis=0) if boxes else np.zeros(len(patch), bool)
    return PatchScore(area, max(ious, default=0.0), share(float(surface.areas[patch][covered].sum()), area))


def _in_front(
    camera: SimulatedD435i, truth: Truth, T_world_cam: RigidTransform, detection: Detection
) -> Float[np.ndarray, "n"]:
    """Distance of each point before its block's mean true depth, along its ray [m]; NaN where nothing is."""
    depths = truth.depth.ravel()[block_pixels(camera)].astype(float)
    there = np.count_nonzero(depths, axis=-1)
    mean = np.where(there > 0, depths.sum(axis=-1) / np.maximum(there, 1), np.nan)
    points = T_world_cam.inv().apply(detection.points)
    u, v = detection.pixels.T
    return (mean[v, u] - points[:, 2]) * np.linalg.norm(points / np.maximum(points[:, 2:], 1e-9), axis=1)


def _median(values: Float[np.ndarray, "n"]) -> float:
    """Of the finite ones; NaN if there is none."""
    finite = values[np.isfinite(values)]
    return float(np.median(finite)) if len(finite) else float("nan")
