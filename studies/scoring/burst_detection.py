"""How well any detector tells holes, false depth and their surface in single bursts, counted over many views.

Truth is the labels at the planner's resolution. Views are summed before shares are taken, so that a view counts by what
is to be found in it.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, fields

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.reflective_regions import Detection
from franbv.robust.regions import RobustDetection
from franbv.sensing import DepthBurst, median_depth
from render.d435i import SimulatedD435i
from render.labels.causes import is_of
from render.labels.labels import label_frame
from render.labels.outcome import INVALID_SHARE, blocks, perfect_blocks
from render.world.truth import looks_at_part
from studies.scoring.missing_surface import reflective_holes
from studies.scoring.pixels import share


@dataclass(frozen=True, eq=False)
class ViewTruth:
    """What a perfect detector would say of a burst."""

    reflective: Bool[np.ndarray, "h w"]
    """Has no depth because of reflection."""
    over_exposed: Bool[np.ndarray, "h w"]
    """Has no depth because of a highlight that would drown a matte surface, too: depth alone cannot tell the two
    apart."""
    false_by_reflection: Bool[np.ndarray, "h w"]
    """Has a depth that is wrong because of reflection."""
    false_depth: Bool[np.ndarray, "h w"]
    """Has a wrong depth, whatever the reason."""
    part: Bool[np.ndarray, "h w"]
    """More than half of the block shows the part."""
    depth: Float[np.ndarray, "h w"]
    """True Z-depth of the block, the median of its pixels [m]; NaN = nothing there."""
    error: Float[np.ndarray, "h w"]
    """By which the measured depth is off the truth that the labels hold it against (`perfect_blocks`) [m]; 0 where
    nothing was measured."""


def measured_view(camera: SimulatedD435i, T_world_cam: RigidTransform, n_frames: int) -> tuple[DepthBurst, ViewTruth]:
    """A burst from a pose, and its truth."""
    truth = camera.truth(T_world_cam)
    measurement = camera.measure(T_world_cam, n_frames)
    labels = label_frame(camera, T_world_cam, measurement, truth=truth)
    behind = blocks(truth.depth, camera).astype(float)
    there = np.any(behind > 0, axis=-1)
    depth = np.full(there.shape, np.nan)
    depth[there] = np.nanmedian(np.where(behind[there] > 0, behind[there], np.nan), axis=-1)
    measured = measurement.burst.median_depth(INVALID_SHARE)
    expected = median_depth(perfect_blocks(camera, measurement.z16, truth.depth), INVALID_SHARE)
    return measurement.burst, ViewTruth(
        reflective=reflective_holes(labels),
        over_exposed=is_of(labels.cause_decimated, "over_exposed"),
        false_by_reflection=labels.false_by_reflection_decimated,
        false_depth=labels.false_decimated,
        part=blocks(looks_at_part(truth, camera.scene), camera).mean(axis=-1) > 0.5,
        depth=depth,
        error=np.where(measured > 0, np.abs(measured - expected), 0.0),
    )


FAR_OFF_M = 0.015
"""Error above which false depth counts as far off [m] (choice: two voxels of the paper's map, beyond which it stands as
surface of its own)."""


@dataclass(frozen=True)
class BurstScores:
    """Pixels of one view or of many: what was named, what is true, and both."""

    holes_named: int = 0
    holes_true: int = 0
    holes_both: int = 0
    holes_over_exposed: int = 0
    """Named, and over-exposed."""
    false_named: int = 0
    false_true: int = 0
    """By reflection, on the part."""
    false_found: int = 0
    """Of those, named."""
    false_both: int = 0
    """Named and false by reflection, on the part or beside it."""
    false_any: int = 0
    """Named and false for any reason."""
    far_true: int = 0
    """Of `false_true`, off by more than FAR_OFF_M."""
    far_found: int = 0
    regions: int = 0
    views_with_regions: int = 0
    views: int = 0
    point_errors: tuple[float, ...] = field(default=(), repr=False)
    """Distance along the ray between each named pixel's point and the true surface [m], where it shows the part."""

    @property
    def holes_precision(self) -> float:
        """Share of the named holes that reflection made."""
        return share(self.holes_both, self.holes_named)

    @property
    def highlight_precision(self) -> float:
        """Share of the named holes that reflection or over-exposure made."""
        return share(self.holes_both + self.holes_over_exposed, self.holes_named)

    @property
    def holes_recall(self) -> float:
        """Share of the reflective holes that were named."""
        return share(self.holes_both, self.holes_true)

    @property
    def false_precision(self) -> float:
        """Share of the named false depth that reflection made."""
        return share(self.false_both, self.false_named)

    @property
    def any_false_precision(self) -> float:
        """Share of the named false depth that is wrong for any reason."""
        return share(self.false_any, self.false_named)

    @property
    def false_recall(self) -> float:
        """Share of the part's false depth by reflection that was named."""
        return share(self.false_found, self.false_true)

    @property
    def far_recall(self) -> float:
        """The same of what is far off."""
        return share(self.far_found, self.far_true)

    @property
    def point_error(self) -> float:
        """Median [m]; NaN without points."""
        return float(np.median(self.point_errors)) if self.point_errors else float("nan")


def score_burst(detection: Detection, burst: DepthBurst, truth: ViewTruth) -> BurstScores:
    """Of one view. A detector that knows no false depth names none."""
    if isinstance(detection, RobustDetection):
        holes, false = detection.holes, detection.false_depth
        pixels, places = np.argwhere(holes | false)[:, ::-1], detection.places[holes | false]
    else:
        holes, false = detection.retained, np.zeros_like(detection.retained)
        pixels, places = detection.pixels, detection.points
    to_find = truth.false_by_reflection & truth.part
    far = to_find & (truth.error > FAR_OFF_M)
    counts = {
        "holes_named": holes,
        "holes_true": truth.reflective,
        "holes_both": holes & truth.reflective,
        "holes_over_exposed": holes & truth.over_exposed,
        "false_named": false,
        "false_true": to_find,
        "false_found": false & to_find,
        "false_both": false & truth.false_by_reflection,
        "false_any": false & truth.false_depth,
        "far_true": far,
        "far_found": false & far,
    }
    errors = _along_rays(pixels, places, burst.intrinsics, burst.T_world_cam, truth)
    return BurstScores(
        **{name: int(np.count_nonzero(mask)) for name, mask in counts.items()},
        regions=len(detection.boxes),
        views_with_regions=int(len(detection.boxes) > 0),
        views=1,
        point_errors=tuple(errors.tolist()),
    )


def summed_scores(scores: Iterable[BurstScores]) -> BurstScores:
    """Of several views, summed."""
    total = BurstScores()
    for one in scores:
        total = BurstScores(**{f.name: getattr(total, f.name) + getattr(one, f.name) for f in fields(BurstScores)})
    return total


def _along_rays(
    pixels: np.ndarray,
    places: Float[np.ndarray, "n 3"],
    intrinsics: Intrinsics,
    T_world_cam: RigidTransform,
    truth: ViewTruth,
) -> Float[np.ndarray, "m"]:
    u, v = pixels.T
    points = T_world_cam.inv().apply(places)
    stretch = np.linalg.norm(intrinsics.pixel_directions()[v, u], axis=1)
    errors = np.abs(points[:, 2] - truth.depth[v, u]) * stretch
    return errors[truth.part[v, u] & np.isfinite(errors)]
