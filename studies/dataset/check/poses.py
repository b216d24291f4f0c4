"""What the poses and intrinsics of a scene must satisfy: they are the drawn ones, in BOP's rows and millimetres."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from studies.dataset.draw.draw import SceneDraw
from studies.store.images import MM

LENGTHS_MM = (50.0, 5000.0)
"""Distances of objects from the camera that can be in millimetres [mm]."""
POSE_ERROR = 1e-6
"""Of a rotation's entries [-], and of lengths [mm], by rounding."""


def is_pose(matrix: np.ndarray) -> bool:
    """A rotation and a translation within a room [m]."""
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all() or matrix[3].tolist() != [0, 0, 0, 1]:
        return False
    R = matrix[:3, :3]
    return bool(np.abs(R @ R.T - np.eye(3)).max() < 1e-9 and np.linalg.det(R) > 0 and np.abs(matrix[:3, 3]).max() < 5)


def pose_faults(
    draw: SceneDraw, number: int, camera: dict[str, Any], poses: list[dict[str, Any]], k: Intrinsics
) -> Iterator[tuple[str, str]]:
    """BOP's matrices are those that were drawn, in millimetres. k: of the drawn profile."""
    pose = RigidTransform.from_matrix(np.array(draw.views[number].T_world_cam)).inv()
    if camera["cam_K"] != k.matrix.ravel().tolist():
        yield "scene_camera.json", f"cam_K is not that of the profile {draw.profile}"
    if camera["depth_scale"] != 1.0:
        yield "scene_camera.json", f"depth_scale is {camera['depth_scale']}, depth is in millimetres"
    if not _same(pose, camera["cam_R_w2c"], camera["cam_t_w2c"]):
        yield "scene_camera.json", "cam_R_w2c, cam_t_w2c are not the pose that was drawn, in mm"
    if [entry["obj_id"] for entry in poses] != [thing.object_id for thing in draw.objects]:
        yield "scene_gt.json", "the objects are not those that were drawn"
        return
    for thing, entry in zip(draw.objects, poses, strict=True):
        model = pose * RigidTransform.from_matrix(np.array(thing.T_world_model))
        if not _same(model, entry["cam_R_m2c"], entry["cam_t_m2c"]):
            yield "scene_gt.json", f"the pose of object {thing.object_id} is not the one that was drawn, in mm"
        elif not LENGTHS_MM[0] <= np.linalg.norm(entry["cam_t_m2c"]) <= LENGTHS_MM[1]:
            yield "scene_gt.json", f"object {thing.object_id} is {np.linalg.norm(entry['cam_t_m2c']):.3g} mm away"


def _same(pose: RigidTransform, rotation: list[float], translation_mm: list[float]) -> bool:
    turned = np.abs(pose.rotation.as_matrix().ravel() - rotation).max()
    return bool(turned < POSE_ERROR and np.abs(MM * pose.translation - translation_mm).max() < POSE_ERROR)
