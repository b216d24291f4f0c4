"""What the planner makes of one labelled view: reflective regions, and what their recovery regains.

The planner knows nothing but this view, as after the first view of a run: the burst goes into an empty map, the object
and its ellipsoids come from there, and the detector looks at the same burst, as the loop does. So nothing of the true
shape helps the detector, and what a surface without any depth hides stays hidden.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from franbv.model import Model, model_with
from franbv.parameters import Parameters
from franbv.planners import fra
from franbv.reflective_regions import FILTERS, Detection
from franbv.sensing import DepthBurst
from franbv.voxel_map import empty_map
from render.arm.arm import SimulatedArm
from render.world.truth import looks_at_part
from studies.scoring.detection import GROUPED, LOCATED, score_detection
from studies.scoring.missing_surface import Surface, block_pixels, missing_patches, visible_surface
from studies.scoring.recovery import RecoveryScore, State, ViewGains, burst_points, score_recovery, still_missing
from studies.sensitivity.cases import CaseConfig, plain_paths
from studies.sensitivity.columns import DETECTOR_STAGES
from studies.sensitivity.views import LitView
from studies.store.images import MM

SCOUT_SAMPLING: dict[str, Any] = plain_paths(8) | {"lamp_points": 4, "indirect_directions": 32}
"""Of the camera that looks from the poses of a hemisphere (choice: half the time of the other views; whichever poses
look best are measured again)."""
STAGE_NAMES = dict(zip(DETECTOR_STAGES, (*FILTERS, LOCATED, GROUPED), strict=True))
"""Steps of the detector by the names of the columns, and by those of the scores."""


@dataclass(frozen=True, eq=False)
class Planned:
    """One view through the planner's eyes."""

    model: Model
    """Map, object and ellipsoids with this burst in them."""
    detection: Detection


def first_look(burst: DepthBurst, parameters: Parameters, seed: int) -> Planned:
    """Map the burst, fit the ellipsoids, detect."""
    planner = fra()
    assert planner.recovery is not None
    with threadpool_limits(1):
        model = model_with(empty_map(parameters), burst, planner, parameters, np.random.SeedSequence(seed))
        return Planned(model, planner.recovery.detect(burst, model, parameters))


def detection_counts(view: LitView, planned: Planned) -> dict[str, Any]:
    """The detector's counts, by the names of the columns."""
    pose = view.measurement.T_world_cam
    scores = score_detection(view.camera, pose, view.truth, view.labels, planned.detection)
    stages = {column: scores.stages[name] for column, name in STAGE_NAMES.items()}
    holes, false = scores.hidden.reflective_holes, scores.hidden.false_depths
    return {
        "reflective": stages["grouped"].n_true,
        **{f"found_{column}": score.n_found for column, score in stages.items()},
        **{f"right_{column}": score.n_both for column, score in stages.items()},
        "hidden_holes": holes.total - holes.hole,
        "holes_made_false": holes.false_depth,
        "fine_holes": holes.total,
        "hidden_false": false.total - false.false_depth,
        "fine_false": false.total,
        "regions": len(scores.regions),
        "region_mm2": MM**2 * sum(region.found_area for region in scores.regions),
        "region_missing_mm2": MM**2 * sum(region.both_area for region in scores.regions),
        "patch_mm2": MM**2 * sum(patch.area for patch in scores.patches),
        "patch_found_mm2": MM**2 * sum(patch.area * patch.found_share for patch in scores.patches),
        "region_iou": scores.regions[0].iou if scores.regions else None,
        "in_front_mm": MM * scores.regions[0].in_front if scores.regions else None,
    }


def recovery_rows(view: LitView, planned: Planned, config: CaseConfig) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """What the recovery of the largest region regains: the view's columns, and a row per recovery view.

    Nothing where no region was found, or where all that it signals is covered.
    """
    missing = signalled_surface(view, planned.detection)
    if missing is None or missing.area == 0:
        return {}, []
    pose, parameters = view.measurement.T_world_cam, config.parameters
    camera = view.camera.changed(**plain_paths(config.other_paths))
    scout, part, sensor = camera.changed(**SCOUT_SAMPLING), camera.world.source.part_mesh(), config.sensor
    arm = SimulatedArm.around(part, model=sensor.model, roll_deg=sensor.mount_roll_deg)
    planner = fra()
    assert planner.recovery is not None
    region = planned.detection.boxes[0]
    recovery = planner.recovery.poses(region, pose, parameters, arm.reachable, camera.min_z)
    state = State(planned.model, pose, missing)
    with threadpool_limits(1):
        score = score_recovery(
            state, recovery, camera, arm, parameters, config.seed, scout, n_poses=config.hemisphere_poses
        )
    takes = [*_views("diamond", score.diamond), *_views("pb", score.pb), *_views("best", score.best)]
    return _summary(score), takes


def signalled_surface(view: LitView, detection: Detection) -> Surface | None:
    """The part's true surface that the largest region signals: all of every hole that has a pixel in the region.

    Holes are matched by their pixels, since a region's points may lie centimetres before the surface. Surface that the
    view's own points cover already is left out. None without a region.
    """
    if not detection.boxes:
        return None
    u, v = detection.pixels[detection.labels == 0].T
    in_region = np.zeros(view.truth.depth.size, bool)
    in_region[block_pixels(view.camera)[v, u].ravel()] = True
    patches = [patch for patch in missing_patches(view.camera, view.labels) if in_region[patch].any()]
    chosen = np.concatenate(patches) if patches else np.zeros(0, int)
    chosen = chosen[looks_at_part(view.truth, view.camera.world.source).ravel()[chosen]]
    surface = visible_surface(view.truth, view.camera.rig.intrinsics, view.measurement.T_world_cam).only(chosen)
    return still_missing(surface, burst_points(view.measurement.burst))


def _summary(score: RecoveryScore) -> dict[str, Any]:
    mm2 = MM**2 * score.missing_area
    return {
        "recovery_views": len(score.diamond.gains),
        "pb_views": len(score.pb.gains),
        "hemisphere_views": score.n_tried or None,
        "missing_mm2": mm2,
        "regained_mm2": mm2 * float(np.nan_to_num(score.diamond.regained)),  # no pose, nothing regained
        "pb_regained_mm2": mm2 * float(np.nan_to_num(score.pb.regained)),
        "best_regained_mm2": mm2 * score.best.regained if score.n_tried else None,
    }


def _views(kind: str, views: ViewGains) -> list[dict[str, Any]]:
    return [
        {
            "kind": kind,
            "number": number,
            "regained_share": gain.regained,
            "incidence_before_deg": gain.incidence_before_deg,
            "incidence_deg": gain.incidence_deg,
            "turn_deg": gain.turn_deg,
        }
        for number, gain in enumerate(views.gains)
    ]
