"""What a next-best-view method is made of: PB-NBV, FRA-NBV and RE as bundles of interchangeable functions.

A planner says how a burst enters the map, what stands in for the object, how views of it are scored and, if it recovers
reflective regions, how they are found, viewed and judged. The loop in `reconstruction` is the same for all of them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.candidates import candidate_poses
from franbv.ellipsoids import Ellipsoids, fit_ellipsoids
from franbv.frames import Intrinsics
from franbv.geometry.oriented_box import OrientedBox
from franbv.model import Approximate, Integrate, Model
from franbv.object_model import ObjectModel
from franbv.parameters import Parameters
from franbv.recovery import RecoveryPoses, diamond_poses, recovery_index
from franbv.reflective_regions import (
    FILTERS,
    Detection,
    Filter,
    Locate,
    detect_reflective_regions,
    located,
)
from franbv.sensing import DepthBurst
from franbv.stopping import StopReason, stop_reason
from franbv.utility import recovery_utility, view_utilities
from franbv.volumetric_information import DEFAULT_GAIN, Gain, compile_rays, view_information
from franbv.voxel_map import VoxelMap

Score = Callable[[Model, Intrinsics, Sequence[RigidTransform], Parameters], Float[np.ndarray, "n"]]
Detect = Callable[[DepthBurst, Model, Parameters], Detection]
DetectBeyond = Callable[[DepthBurst, Model, Parameters, float], Detection]
Poses = Callable[[OrientedBox, RigidTransform, Parameters, Callable[[RigidTransform], bool], float], RecoveryPoses]
ScoreRecovery = Callable[[Model, OrientedBox, Intrinsics, Sequence[RigidTransform], Parameters], Float[np.ndarray, "n"]]
Judge = Callable[[Model, Model, OrientedBox, Parameters], tuple[float, float]]


Stop = Callable[[Model, Sequence[float], Parameters], StopReason | None]
Candidates = Callable[[Model, Parameters, float], list[RigidTransform]]
Missing = Callable[[Model, Parameters], float]
Points = Callable[[DepthBurst, Parameters], Float[np.ndarray, "h w"]]


def ring_candidates(model: Model, parameters: Parameters, azimuth_offset: float) -> list[RigidTransform]:
    """The paper's: rings around the object's box (section III-C)."""
    return candidate_poses(model.object.box, parameters, azimuth_offset)


def all_depth(burst: DepthBurst, parameters: Parameters) -> Float[np.ndarray, "h w"]:
    """The burst's median depth [m], 0 = frequently invalid."""
    return burst.median_depth(parameters.invalid_share)


def stop_by_stagnation(model: Model, best_utilities: Sequence[float], parameters: Parameters) -> StopReason | None:
    """The paper's rules, which look at the utilities alone (section VI)."""
    return stop_reason(best_utilities, parameters)


@dataclass(frozen=True, eq=False)
class Recovery:
    """How reflective regions are found and recovered (paper, section V), as four functions that can be replaced.

    The loop recovers the largest region of a burst alone, scores the poses that remain anew after each acquisition, and
    ends when Gamma, eq. (15), exceeds `Parameters.recovered_share` or no pose is left. A recovery's own bursts are not
    searched for regions.
    """

    detect: Detect
    """(burst, model with that burst in it, parameters) -> regions, largest first."""
    poses: Poses
    """(region, pose that saw it, parameters, reachable, Min-Z [m]) -> recovery poses."""
    score: ScoreRecovery
    """(model, region, intrinsics, poses, parameters) -> U_r of each pose [px^2]."""
    judge: Judge
    """(model at activation, model now, region, parameters) -> Gamma, and Gamma over what is attainable."""


@dataclass(frozen=True, eq=False)
class Planner:
    """A next-best-view method: how bursts enter the map, what stands in for the object, how views are scored.

    Reachability and the largest number of views are the loop's and alike for all planners, so that methods differ in
    what stands here only. The unit of a utility is the planner's own: [px^2] of eq. (2), [nat] of rays. It is
    compared with those of the same run alone. `name` is what studies and results call the method.
    """

    name: str
    integrate: Integrate
    """(map, burst, parameters) -> map with the burst in it."""
    approximate: Approximate
    """(object, parameters, seed) -> ellipsoids."""
    score: Score
    """(model, intrinsics, poses, parameters) -> utility of each pose; larger is better."""
    recovery: Recovery | None = None
    """None: missing depth is taken as unexplored, as in PB-NBV."""
    candidates: Candidates = ring_candidates
    """(model, parameters, azimuth [rad]) -> poses among which the next best view is chosen."""
    stop: Stop = stop_by_stagnation
    """(model, utilities of the views chosen so far, parameters) -> the rule that ends the run, or None."""
    detect: DetectBeyond | None = None
    """(burst, model with that burst in it, parameters, Min-Z [m]) -> regions that are named and shown, of a planner
    that recovers none by itself; a `recovery` has its own."""
    points: Points = all_depth
    """(burst, parameters) -> depth that becomes points of the cloud [m], 0 = none."""
    missing: Missing | None = None
    """(model, parameters) -> share of the surface that it believes the map still lacks [0, 1]; None: it has no idea."""


def pb() -> Planner:
    """PB-NBV: projected ellipsoid areas (paper, section III)."""
    return Planner("pb", integrate_burst, approximate_by_ellipsoids, score_by_projection)


def fra(filters: Mapping[str, Filter] = FILTERS, locate: Locate = located, poses: Poses = diamond_poses) -> Planner:
    """FRA-NBV: PB-NBV with reflective regions identified and recovered (paper, section V).

    filters: the tests that a pixel must pass, by name; leave one out for an ablation.
    locate: the last test, which also places the remaining pixels in the world.
    poses: from where a region is seen again.
    """

    def detect(burst: DepthBurst, model: Model, parameters: Parameters) -> Detection:
        return detect_reflective_regions(burst, model.ellipsoids, parameters, filters, locate)

    recovery = Recovery(detect, poses, score_by_region, judge_by_new_voxels)
    return Planner("fra", integrate_burst, approximate_by_ellipsoids, score_by_projection, recovery)


def ray_entropy(gain: Gain = DEFAULT_GAIN, within_object: bool = False) -> Planner:
    """Ray-cast entropy: the view whose rays promise most information on the map (paper, section VI).

    gain: what a voxel is worth to a ray.
    within_object: count rays only within the object's box, which the other planners know too, grown by a voxel. In the
    whole map a ray's worth is decided near the camera: by H(P) / P, which is largest in space that is known to be free.
    """

    def score(
        model: Model, intrinsics: Intrinsics, poses: Sequence[RigidTransform], parameters: Parameters
    ) -> Float[np.ndarray, "n"]:
        region = model.object.box.grown(parameters.voxel_size) if within_object else None
        return view_information(model.voxel_map, intrinsics, poses, gain, region)

    compile_rays()  # now, and not while the first decision is being timed
    return Planner("re", integrate_burst, without_ellipsoids, score)


def random_views() -> Planner:
    """Any reachable candidate: what every other planner must beat."""
    return Planner("random", integrate_burst, without_ellipsoids, all_alike)


def integrate_burst(voxel_map: VoxelMap, burst: DepthBurst, parameters: Parameters) -> VoxelMap:
    """One insertion per pose, the burst's median depth; or one per frame, see `Parameters.frames_into_map`."""
    frames = burst.depths if parameters.frames_into_map == "each" else [burst.median_depth(parameters.invalid_share)]
    for depth in frames:
        voxel_map = voxel_map.updated(depth, burst.intrinsics, burst.T_world_cam, parameters)
    return voxel_map


def approximate_by_ellipsoids(
    estimate: ObjectModel, parameters: Parameters, seed: np.random.SeedSequence
) -> Ellipsoids:
    """E_o and E_f of the object's occupied and frontier voxels."""
    return fit_ellipsoids(estimate.occupied, estimate.frontier, parameters, seed)


def without_ellipsoids(estimate: ObjectModel, parameters: Parameters, seed: np.random.SeedSequence) -> Ellipsoids:
    """None: for planners that look at the map itself."""
    return Ellipsoids(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros(0, bool))


def all_alike(
    model: Model, intrinsics: Intrinsics, poses: Sequence[RigidTransform], parameters: Parameters
) -> Float[np.ndarray, "n"]:
    """The same utility for every pose; the loop then draws one."""
    return np.zeros(len(poses))


def score_by_projection(
    model: Model, intrinsics: Intrinsics, poses: Sequence[RigidTransform], parameters: Parameters
) -> Float[np.ndarray, "n"]:
    """U(x), eq. (2)."""
    return view_utilities(model.ellipsoids, intrinsics, poses, parameters)


def score_by_region(
    model: Model, region: OrientedBox, intrinsics: Intrinsics, poses: Sequence[RigidTransform], parameters: Parameters
) -> Float[np.ndarray, "n"]:
    """U_r(x), eq. (14)."""
    return np.array([recovery_utility(model.ellipsoids, region, intrinsics, T, parameters) for T in poses])


def judge_by_new_voxels(before: Model, now: Model, region: OrientedBox, parameters: Parameters) -> tuple[float, float]:
    """Gamma, eq. (15), and Gamma over what is attainable."""
    return recovery_index(before.voxel_map.occupied, now.voxel_map.occupied, region, now.voxel_map, parameters)
