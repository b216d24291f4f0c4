"""How well the detector finds what is truly missing, filter by filter, and what decimation hides from it.

Truth is the labels at the planner's resolution: decimated pixels without depth whose cause is reflection.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool
from scipy.spatial.transform import RigidTransform

from franbv.reflective_regions import Detection
from render.d435i import SimulatedD435i
from render.labels.causes import Cause, is_of
from render.labels.labels import Labels
from render.labels.outcome import blocks
from render.world.truth import Truth
from studies.scoring.missing_surface import reflective_holes
from studies.scoring.pixels import PixelScore, pixel_score
from studies.scoring.regions import PatchScore, RegionScore, score_regions

LOCATED = "located"
"""Stage after the filter that gives pixels a place in the world."""
GROUPED = "in a region"
"""Stage after clustering."""


@dataclass(frozen=True)
class Fates:
    """What decimation makes of some full-resolution pixels: counts by what their block has become."""

    hole: int
    """Blocks without depth."""
    false_depth: int
    """Blocks with false depth."""
    right_depth: int
    """Blocks with right depth."""

    @property
    def total(self) -> int:
        """All of the pixels."""
        return self.hole + self.false_depth + self.right_depth


@dataclass(frozen=True)
class HiddenByDecimation:
    """What the detector never gets to see."""

    reflective_holes: Fates
    """Of the full-resolution pixels without depth because of reflection."""
    false_depths: Fates
    """Of those whose depth is false because of reflection."""


@dataclass(frozen=True, eq=False)
class DetectionScores:
    """Of one burst."""

    stages: dict[str, PixelScore]
    """After each filter and all before it, in order, by name; then LOCATED and GROUPED."""
    regions: tuple[RegionScore, ...]
    patches: tuple[PatchScore, ...]
    hidden: HiddenByDecimation

    @property
    def losses(self) -> dict[str, tuple[int, int]]:
        """By stage: true pixels that it lost, and others that it rightly removed."""
        stages = list(self.stages.items())
        return {
            name: (before.n_both - now.n_both, (before.n_found - before.n_both) - (now.n_found - now.n_both))
            for (_, before), (name, now) in pairwise(stages)
        }


def score_detection(
    camera: SimulatedD435i, T_world_cam: RigidTransform, truth: Truth, labels: Labels, detection: Detection
) -> DetectionScores:
    """Score what was detected in a burst; truth and labels are those of the same pose and burst."""
    true = reflective_holes(labels)
    regions, patches = score_regions(camera, T_world_cam, truth, labels, detection)
    return DetectionScores(
        {name: pixel_score(mask, true) for name, mask in stage_masks(detection).items()},
        regions,
        patches,
        hidden_by_decimation(camera, labels),
    )


def stage_masks(detection: Detection) -> dict[str, Bool[np.ndarray, "h w"]]:
    """Pixels that are left after each step of the detector, in its order."""
    left, masks = np.ones(detection.retained.shape, bool), {}
    for name, mask in detection.masks.items():
        left = left & mask
        masks[name] = left
    return masks | {LOCATED: detection.retained, GROUPED: in_a_region(detection)}


def in_a_region(detection: Detection) -> Bool[np.ndarray, "h w"]:
    """Pixels whose point belongs to a box."""
    mask = np.zeros(detection.retained.shape, bool)
    u, v = detection.pixels[detection.labels >= 0].T
    mask[v, u] = True
    return mask


def hidden_by_decimation(camera: SimulatedD435i, labels: Labels) -> HiddenByDecimation:
    """Follow the full-resolution pixels into their blocks."""
    hole = (labels.cause_decimated != Cause.MEASURED)[..., None]
    wrong = labels.false_decimated[..., None]

    def fates(pixels: Bool[np.ndarray, "h w"]) -> Fates:
        inside = blocks(pixels, camera)
        return Fates(*(int((inside & fate).sum()) for fate in (hole, wrong, ~hole & ~wrong)))

    return HiddenByDecimation(fates(is_of(labels.cause, "reflection")), fates(labels.false_by_reflection))
