"""What recovery poses regain of the surface that is truly missing, and what other poses would have.

Four answers for one region, all from the same state: each diamond pose by itself and all together; as many plain PB
views, each planned after the one before; and the best pose of a hemisphere, which is what was possible. A piece of
missing surface is regained when a measured point lies within the paper's tolerance of it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree
from scipy.spatial.transform import RigidTransform

from franbv.candidates import candidate_poses
from franbv.evaluation.reference import TOLERANCE
from franbv.frames import back_project, look_at, rolled
from franbv.model import Model, model_with
from franbv.parameters import Parameters
from franbv.planners import Planner, pb
from franbv.recovery import RecoveryPoses
from franbv.sensing import Arm, DepthBurst, DepthCamera
from render.world.visibility import upper_directions
from studies.scoring.missing_surface import Surface
from studies.scoring.pixels import share

HEMISPHERE_POSES = 200
"""Poses tried to learn what is possible (choice: 100 directions, 14 deg apart, at two distances)."""
CONFIRMED_POSES = 3
"""The best of them that are measured again by the real camera (choice: the scout's noise may swap neighbours)."""


@dataclass(frozen=True, eq=False)
class State:
    """Where a reconstruction stands when a recovery is to begin."""

    model: Model
    """With the burst that saw the hole in it."""
    T_world_cam: RigidTransform
    """Pose of that burst."""
    missing: Surface
    """The true surface to regain; see `still_missing`."""


@dataclass(frozen=True)
class ViewGain:
    """What one view regains, and how differently it looks at the missing surface. Means are by area."""

    T_world_cam: RigidTransform
    regained: float
    """Share of the missing area that this view alone gives [0, 1]."""
    incidence_before_deg: float
    """Mean angle of incidence in the view that saw the hole."""
    incidence_deg: float
    """The same in this view."""
    turn_deg: float
    """Mean angle between the two views' rays at the missing surface."""

    @property
    def incidence_change_deg(self) -> float:
        """By how much more steeply this view looks at the surface."""
        return self.incidence_deg - self.incidence_before_deg


@dataclass(frozen=True)
class ViewGains:
    """Several views of the same missing surface."""

    gains: tuple[ViewGain, ...]
    regained: float
    """Share of the missing area that they give together [0, 1]; NaN without views."""


@dataclass(frozen=True)
class RecoveryScore:
    """Of one detected region."""

    missing_area: float
    """[m^2]"""
    diamond: ViewGains
    pb: ViewGains
    best: ViewGains
    """The pose of the hemisphere that regains most."""
    n_tried: int
    """Poses of the hemisphere that the arm reaches and that look at the surface's front."""


def still_missing(surface: Surface, cloud: Float[np.ndarray, "n 3"]) -> Surface:
    """The part of a surface that has no point of the cloud [m] within TOLERANCE."""
    return surface.only(~_near_cloud(surface, cloud))


def score_recovery(
    state: State,
    recovery: RecoveryPoses,
    camera: DepthCamera,
    arm: Arm,
    parameters: Parameters,
    seed: int,
    scout: DepthCamera | None = None,
    n_poses: int = HEMISPHERE_POSES,
) -> RecoveryScore:
    """Score the recovery of one region. Takes `parameters.n_frames` frames a view.

    seed: of the PB views' candidates and clusters.
    scout: a cheaper camera before the same scene that picks the best of the hemisphere's poses; `camera` measures the
    first CONFIRMED_POSES of them again. None: the camera itself.
    """
    n_frames = parameters.n_frames
    diamond = [camera.capture(pose, n_frames) for pose in recovery.poses]
    plain = pb_views(state.model, camera, arm, parameters, len(recovery.poses), seed)
    poses = hemisphere_poses(state, recovery, parameters, n_poses)
    poses = [pose for pose in poses if arm.reachable(pose) and _faces(pose, state.missing)]
    first_look = scout or camera
    looks = [regained_share(state.missing, [first_look.capture(pose, 1)]) for pose in poses]
    promising = [poses[k] for k in np.argsort(looks, kind="stable")[::-1][:CONFIRMED_POSES]]
    confirmed = [camera.capture(pose, n_frames) for pose in promising]
    best = max(confirmed, key=lambda burst: regained_share(state.missing, [burst]), default=None)
    return RecoveryScore(
        state.missing.area,
        view_gains(state, diamond),
        view_gains(state, plain),
        view_gains(state, [best] if best is not None else []),
        len(poses),
    )


def view_gains(state: State, bursts: Sequence[DepthBurst]) -> ViewGains:
    """What each burst regains by itself, and all together."""
    before = _incidence_deg(state.missing, state.T_world_cam)
    each = tuple(
        ViewGain(
            burst.T_world_cam,
            regained_share(state.missing, [burst]),
            before,
            _incidence_deg(state.missing, burst.T_world_cam),
            _turn_deg(state.missing, state.T_world_cam, burst.T_world_cam),
        )
        for burst in bursts
    )
    return ViewGains(each, regained_share(state.missing, bursts) if bursts else float("nan"))


def regained_share(missing: Surface, bursts: Sequence[DepthBurst]) -> float:
    """Share of the missing area within TOLERANCE of a point of the bursts; NaN if nothing is missing."""
    cloud = np.concatenate([burst_points(burst) for burst in bursts])
    return share(float(missing.areas[_near_cloud(missing, cloud)].sum()), missing.area)


def burst_points(burst: DepthBurst) -> Float[np.ndarray, "n 3"]:
    """World points [m] of the burst's median depth."""
    return burst.T_world_cam.apply(back_project(burst.median_depth(), burst.intrinsics))


def pb_views(
    model: Model,
    camera: DepthCamera,
    arm: Arm,
    parameters: Parameters,
    count: int,
    seed: int,
    planner: Callable[[], Planner] = pb,
) -> list[DepthBurst]:
    """The next `count` bursts that a planner without recovery takes from this state; fewer if the arm is stuck."""
    plain, bursts = planner(), []
    azimuths, clusters = np.random.SeedSequence(seed).spawn(2)
    rng = np.random.default_rng(azimuths)
    for cluster_seed in clusters.spawn(count):
        candidates = candidate_poses(model.object.box, parameters, rng.uniform(0.0, 2 * np.pi))
        reachable = [pose for pose in candidates if arm.reachable(pose)]
        if not reachable:
            break
        utilities = plain.score(model, camera.intrinsics, reachable, parameters)
        bursts.append(camera.capture(reachable[int(np.argmax(utilities))], parameters.n_frames))
        model = model_with(model.voxel_map, bursts[-1], plain, parameters, cluster_seed)
    return bursts


def hemisphere_poses(state: State, recovery: RecoveryPoses, parameters: Parameters, count: int) -> list[RigidTransform]:
    """`count` poses that look at the middle of the missing surface from evenly spread directions above the table.

    Half of them stand as far off as the diamond's poses (at the least as far as its nearest), half as far as PB's
    candidates, so that neither is beaten by its distance alone.
    """
    target = state.missing.centre
    near = float(np.hypot(parameters.recovery_distance, parameters.lateral_offset))
    if recovery.poses:
        near = float(np.min([np.linalg.norm(pose.translation - recovery.target) for pose in recovery.poses]))
    far = parameters.stand_off + state.model.object.box.half_diagonal
    half = count // 2
    shells = ((near, upper_directions(half)), (far, upper_directions(count - half)))
    eyes = (target + radius * out for radius, directions in shells for out in directions)
    return [rolled(look_at(eye, target), parameters.roll_deg) for eye in eyes]


def _near_cloud(surface: Surface, cloud: Float[np.ndarray, "n 3"]) -> np.ndarray:
    """Which elements (n,) have a point of the cloud within TOLERANCE."""
    if len(cloud) == 0 or len(surface.points) == 0:
        return np.zeros(len(surface.points), bool)
    reach = np.nextafter(TOLERANCE, 1.0)
    return KDTree(cloud).query(surface.points, distance_upper_bound=reach)[0] <= TOLERANCE


def _rays_to(surface: Surface, pose: RigidTransform) -> Float[np.ndarray, "n 3"]:
    """Unit vectors from the surface towards the camera."""
    out = pose.translation - surface.points
    return out / np.linalg.norm(out, axis=1, keepdims=True)


def _faces(pose: RigidTransform, surface: Surface) -> bool:
    """Whether the camera is in front of any element."""
    return bool(np.any(np.sum(_rays_to(surface, pose) * surface.normals, axis=1) > 0))


def _incidence_deg(surface: Surface, pose: RigidTransform) -> float:
    """Mean angle between normal and view ray."""
    cosine = np.sum(_rays_to(surface, pose) * surface.normals, axis=1)
    return float(np.average(np.degrees(np.arccos(np.clip(cosine, -1, 1))), weights=surface.areas))


def _turn_deg(surface: Surface, first: RigidTransform, second: RigidTransform) -> float:
    """Mean angle between the rays to two cameras."""
    cosine = np.sum(_rays_to(surface, first) * _rays_to(surface, second), axis=1)
    return float(np.average(np.degrees(np.arccos(np.clip(cosine, -1, 1))), weights=surface.areas))
