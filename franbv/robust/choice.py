"""Where to look next: what is left to be measured, times the chance that it succeeds from there, per second.

The chance is that of a beta-binomial over ranges of incidence and turns of the camera, counted in this run alone: a
range starts as likely to succeed as to fail, and looks that failed at a place lower it there. So neither geometry nor
material nor reflectance are known beforehand; a mirror that fails on end is tried level, and face on.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.candidates import candidate_poses
from franbv.frames import Intrinsics, look_at, rolled
from franbv.model import Model
from franbv.parameters import Parameters
from franbv.robust.evidence import EvidenceMap, incidence_range, with_scans
from franbv.robust.hypothesis import Hypothesis, pixel_density, visible
from franbv.robust.scans import quarter_turns
from franbv.robust.settings import RobustSettings

FACES_LEFT = 6
"""Directions of what is left to be measured that poses are made for (choice: a box has as many)."""
SAME_FACE = 0.9
"""Cosine between normals of one face (choice: 26 deg)."""
STAND_OFFS = (0.0, 0.08)
"""Of poses face on, beyond the planner's stand-off from the face [m] (choice: near, and far enough for a part)."""
MOST_OFFERED = 32
"""Of poses beside the paper's own, the best that an arm is asked about (choice: as many as the paper has; a planner of
motions takes a millisecond and more for each)."""
HIGHEST_LOOK = 0.12
"""Sine of the elevation that poses face on keep at least [-] (choice: the camera's body clears the table)."""


def robust_candidates(
    model: Model, left: Hypothesis, parameters: Parameters, azimuth_offset: float, settings: RobustSettings
) -> list[RigidTransform]:
    """The paper's candidates, and the best of others: the same in every turn of the camera, moved up to the object, and
    poses face on to what is left to be measured."""
    upright = parameters.model_copy(update={"roll_deg": 0.0})
    rings = candidate_poses(model.object.box, upright, azimuth_offset)
    ring = RigidTransform.concatenate(rings)
    upright_poses = RigidTransform.concatenate([ring, nearer(ring, model, parameters), *face_on(left, parameters)])
    turned = [rolled(upright_poses, parameters.roll_deg + turn) for turn in settings.turns_deg]
    poses = [pose for batch in turned for pose in batch]
    own, others = poses[: len(rings)], poses[len(rings) :]
    grid = with_scans(model.voxel_map)
    if not grid.scans:
        return poses
    gains = gain_per_second(model, left, grid.scans[-1].intrinsics, others, settings)
    return own + [others[k] for k in np.argsort(-gains, kind="stable")[:MOST_OFFERED]]


def nearer(poses: RigidTransform, model: Model, parameters: Parameters) -> RigidTransform:
    """Each pose moved along its axis until the foremost corner of the object's box is at the stand-off from it: the
    paper's stand-off is from the ball around the box, which leaves a pixel on a flat part twice as much surface."""
    axes, eyes = poses.rotation.as_matrix()[:, :, 2], poses.translation
    corners = model.object.box.corners()
    foremost = np.array([((corners - eye) @ axis).min() for eye, axis in zip(eyes, axes, strict=True)])
    return RigidTransform.from_components(eyes + (foremost - parameters.stand_off)[:, None] * axes, poses.rotation)


def face_on(left: Hypothesis, parameters: Parameters) -> list[RigidTransform]:
    """Upright poses that look along the commonest normals of what is left, at its middle."""
    weight = left.areas * left.left / (1.0 + left.looks.sum(axis=(1, 2)))
    alike = (left.normals @ left.normals.T > SAME_FACE).astype(np.float32)
    poses, free = [], np.ones(len(weight), bool)
    for _ in range(FACES_LEFT):
        if not free.any():
            break
        near = alike[np.argmax(np.where(free, (weight * free).astype(np.float32) @ alike, -1.0))] > 0
        face = near & free
        free &= ~near
        target = np.average(left.places[face], axis=0, weights=weight[face])
        normal = np.average(left.normals[face], axis=0, weights=weight[face])
        normal[2] = max(normal[2], HIGHEST_LOOK)
        normal /= np.linalg.norm(normal)
        poses += [look_at(target + (parameters.stand_off + more) * normal, target) for more in STAND_OFFS]
    return poses


def gain_per_second(
    model: Model,
    left: Hypothesis,
    intrinsics: Intrinsics,
    poses: Sequence[RigidTransform],
    settings: RobustSettings,
) -> Float[np.ndarray, "n"]:
    """Area that each view is expected to confirm, per second of motion and sensing [m^2/s]."""
    views = RigidTransform.concatenate(list(poses))
    gains = expected_gains(model, left, intrinsics, views, settings)
    return gains.sum(axis=1) / _seconds(with_scans(model.voxel_map), views, settings)


def expected_gains(
    model: Model, left: Hypothesis, intrinsics: Intrinsics, views: RigidTransform, settings: RobustSettings
) -> Float[np.ndarray, "p n"]:
    """Area of each element of what is left that each of several views is expected to cover [m^2]."""
    grid = with_scans(model.voxel_map)
    tries = np.cumsum(left.looks, axis=2)  # what failed face on fails from the side as well
    seen, cosine, distance, _ = visible(grid, views, intrinsics, left.places, left.normals, settings)
    turns, ranges = quarter_turns(views)[:, None], incidence_range(cosine)
    tried = tries[np.arange(len(left.places)), turns, ranges]
    chance = left.chances[turns, ranges] * settings.element_trials / (settings.element_trials + tried)
    covered = 1.0 - np.exp(-np.pi * settings.resolution**2 * pixel_density(intrinsics, cosine, distance))
    return left.areas * left.left * chance * covered * seen


def _seconds(grid: EvidenceMap, poses: RigidTransform, settings: RobustSettings) -> Float[np.ndarray, "n"]:
    if not grid.scans:
        return np.full(len(poses), settings.sensing_s)
    last = grid.scans[-1].T_world_cam
    way = np.linalg.norm(poses.translation - last.translation, axis=1)
    turn = (last.rotation.inv() * poses.rotation).magnitude()
    return settings.sensing_s + np.maximum(way / settings.speed, turn / settings.turning_speed)
