"""fra-robust as a planner: the map of `evidence`, the views of `choice`, the paper's loop."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.model import Model
from franbv.parameters import Parameters
from franbv.planners import Planner, pb, without_ellipsoids
from franbv.reflective_regions import Detection
from franbv.robust.choice import gain_per_second, robust_candidates
from franbv.robust.evidence import EvidenceMap, integrate_robustly
from franbv.robust.hypothesis import Hypothesis, hypothesis, missing_share
from franbv.robust.regions import detect_robustly
from franbv.robust.scans import mixed_blocks
from franbv.robust.settings import RobustSettings
from franbv.sensing import DepthBurst
from franbv.stopping import StopReason
from franbv.voxel_map import VoxelMap

RobustChange = Literal["map", "views"]
"""What fra-robust has in another way than PB-NBV: the map, with what becomes of its cloud, and where to look next or
whether at all."""


def fra_robust(settings: RobustSettings | None = None) -> Planner:
    """Views of what is left to be measured, from where it is likely to succeed. settings: None = the defaults."""
    settings = settings or RobustSettings()

    def detect(burst: DepthBurst, model: Model, parameters: Parameters, min_z: float) -> Detection:
        return detect_robustly(burst, model, parameters, min_z, settings)

    planner = partly_robust(pb(), get_args(RobustChange), settings)
    return replace(planner, name="fra-robust", approximate=without_ellipsoids, detect=detect)


def partly_robust(planner: Planner, changes: Sequence[RobustChange], settings: RobustSettings | None = None) -> Planner:
    """Another planner with these of the changes, all else its own."""
    settings = settings or RobustSettings()

    def integrate(voxel_map: VoxelMap, burst: DepthBurst, parameters: Parameters) -> EvidenceMap:
        return integrate_robustly(voxel_map, burst, parameters, settings)

    known: dict[Model, Hypothesis] = {}

    def left(model: Model, parameters: Parameters) -> Hypothesis:
        if model not in known:
            known.clear()
            known[model] = hypothesis(model, parameters, settings)
        return known[model]

    def candidates(model: Model, parameters: Parameters, azimuth_offset: float) -> list[RigidTransform]:
        return robust_candidates(model, left(model, parameters), parameters, azimuth_offset, settings)

    def score(
        model: Model, intrinsics: Intrinsics, poses: Sequence[RigidTransform], parameters: Parameters
    ) -> Float[np.ndarray, "n"]:
        return gain_per_second(model, left(model, parameters), intrinsics, poses, settings)

    def stop(model: Model, best_utilities: Sequence[float], parameters: Parameters) -> StopReason | None:
        return little_to_gain(best_utilities, left(model, parameters), parameters, settings)

    def unmixed(burst: DepthBurst, parameters: Parameters) -> Float[np.ndarray, "h w"]:
        depth = burst.median_depth(parameters.invalid_share)
        return np.where(mixed_blocks(depth, settings.mixed_step), 0.0, depth)

    def missing(model: Model, parameters: Parameters) -> float:
        return missing_share(model, left(model, parameters), settings)

    if "map" in changes:
        planner = replace(planner, integrate=integrate, points=unmixed)
    if "views" in changes:
        planner = replace(planner, candidates=candidates, score=score, stop=stop)
    return replace(planner, missing=missing) if set(get_args(RobustChange)) <= set(changes) else planner


def little_to_gain(
    best_utilities: Sequence[float], left: Hypothesis, parameters: Parameters, settings: RobustSettings
) -> StopReason | None:
    """The rule that ends a run of which these views were chosen [m^2/s]: each of the last ones, as many as the paper's
    rule looks at, promised less than `RobustSettings.least_gain` of the surface."""
    last = best_utilities[-parameters.stagnation_iterations :]
    least = settings.least_gain * left.surface_area
    if len(last) == parameters.stagnation_iterations and max(last) * settings.sensing_s < least:
        return StopReason.LITTLE_TO_GAIN
    return StopReason.MAX_ITERATIONS if len(best_utilities) >= parameters.max_iterations else None
