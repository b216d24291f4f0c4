"""BOP's files: scene_camera, scene_gt, scene_gt_info and COCO annotations of a scene, models in millimetres.

Source: docs/bop_datasets_format.md of bop_toolkit (T. Hodan et al.). Matrices row by row, lengths in mm, the camera as
in OpenCV. What is seen of an object is decided by exact rays, not by the measured depth as bop_toolkit has to.
"""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import ConvexHull
from scipy.spatial.distance import cdist
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from materials.input_error import InputError
from scenes.scene import Mesh
from scenes.topology import face_normals
from studies.dataset.draw.draw import SceneDraw
from studies.dataset.make import rle
from studies.dataset.make.view import LabelledView, Silhouette, bounding_box
from studies.store.images import MM

MOST_CORNERS, BLOCK = 50_000, 1000
"""Corners of a model's convex hull whose distances are measured, and rows of them at a time (choice: ten seconds)."""
LEAST_VISIBLE = 0.1
"""Share of an object that must be seen for its COCO annotation to count (bop_toolkit, scripts/calc_gt_coco.py)."""


def camera_file(intrinsics: Intrinsics) -> dict[str, float]:
    """`camera.json`: of all images [px]; depth in millimetres."""
    k = intrinsics
    size = {"width": k.width, "height": k.height}
    return size | {"fx": k.fx, "fy": k.fy, "cx": k.cx, "cy": k.cy, "depth_scale": 1.0}


def camera_entry(intrinsics: Intrinsics, pose: RigidTransform) -> dict[str, Any]:
    """Of one view in `scene_camera.json`."""
    to_camera = pose.inv()
    return {
        "cam_K": intrinsics.matrix.ravel().tolist(),
        "cam_R_w2c": to_camera.rotation.as_matrix().ravel().tolist(),
        "cam_t_w2c": (MM * to_camera.translation).tolist(),
        "depth_scale": 1.0,
    }


def pose_entries(draw: SceneDraw, pose: RigidTransform) -> list[dict[str, Any]]:
    """Of one view in `scene_gt.json`."""
    entries = []
    for thing in draw.objects:
        model = pose.inv() * RigidTransform.from_matrix(np.array(thing.T_world_model))
        entries.append(
            {
                "obj_id": thing.object_id,
                "cam_R_m2c": model.rotation.as_matrix().ravel().tolist(),
                "cam_t_m2c": (MM * model.translation).tolist(),
            }
        )
    return entries


def info_entries(view: LabelledView) -> list[dict[str, Any]]:
    """Of one view in `scene_gt_info.json`."""
    depth = view.images["depth"]
    return [
        {
            "bbox_obj": list(whole.box),
            "bbox_visib": list(bounding_box(seen)),
            "px_count_all": whole.pixels,
            "px_count_valid": int(np.count_nonzero(whole.mask & (depth > 0))),
            "px_count_visib": int(np.count_nonzero(seen)),
            "visib_fract": visible_share(whole, seen),
        }
        for whole, seen in zip(view.silhouettes, view.visible, strict=True)
    ]


def visible_share(whole: Silhouette, seen: Bool[np.ndarray, "h w"]) -> float:
    """Share of an object's whole silhouette, beyond the image too, that is seen [0, 1]."""
    return float(np.count_nonzero(seen) / whole.pixels) if whole.pixels else 0.0


def coco_annotations(draw: SceneDraw, number: int, view: LabelledView) -> list[dict[str, Any]]:
    """What is seen of each object in one view; objects out of sight are left out.

    As bop_toolkit's calc_gt_coco.py has it by default: area and segmentation of what is seen, but the amodal box, that
    of the whole silhouette inside the image.
    """
    return [
        {
            "image_id": number,
            "category_id": thing.object_id,
            "gt_id": place,
            "iscrowd": 0,
            "ignore": visible_share(whole, seen) < LEAST_VISIBLE,
            "area": int(np.count_nonzero(seen)),
            "bbox": list(bounding_box(whole.mask)),
            "width": seen.shape[1],
            "height": seen.shape[0],
            "segmentation": rle.encoded(seen),
            "segmentation_full": rle.encoded(whole.mask),
        }
        for place, (thing, whole, seen) in enumerate(zip(draw.objects, view.silhouettes, view.visible, strict=True))
        if seen.any()
    ]


def coco_file(names: dict[int, str], image_size: tuple[int, int], annotations: list[list[dict[str, Any]]]) -> dict:
    """`scene_gt_coco.json`. names: of all objects by obj_id. image_size: width, height. annotations: by view.

    Annotations count from 1, because pycocotools takes an id of 0 for `no match`.
    """
    together = (entry for entries in annotations for entry in entries)
    flat = [{"id": number, **entry} for number, entry in enumerate(together, start=1)]
    return {
        "info": {"description": "visible parts of the objects; segmentation_full holds their whole silhouettes"},
        "licenses": [],
        "categories": [
            {"id": number, "name": name, "supercategory": "object"} for number, name in sorted(names.items())
        ],
        "images": [
            {"id": k, "file_name": f"gray/{k:06d}.png", "width": image_size[0], "height": image_size[1]}
            for k in range(len(annotations))
        ],
        "annotations": flat,
    }


def model_info(mesh: Mesh) -> dict[str, float]:
    """Of one object in `models_info.json` [mm]."""
    points = MM * mesh.vertices
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    corners = points[ConvexHull(points).vertices]
    if len(corners) > MOST_CORNERS:
        raise InputError(
            f"a model has {len(corners)} corners on its convex hull; simplify it to {MOST_CORNERS} or fewer"
        )
    diameter = max(float(cdist(corners[k : k + BLOCK], corners).max()) for k in range(0, len(corners), BLOCK))
    lowest = {f"min_{axis}": value for axis, value in zip("xyz", low.tolist(), strict=True)}
    return {"diameter": diameter, **lowest} | {f"size_{axis}": s for axis, s in zip("xyz", size.tolist(), strict=True)}


def model_ply(mesh: Mesh) -> bytes:
    """The model as ASCII PLY [mm], with the normals and types that bop_toolkit reads."""
    normals = vertex_normals(mesh)
    header = [
        "ply",
        "format ascii 1.0",
        "comment millimetres",
        f"element vertex {len(mesh.vertices)}",
        *(f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")),
        f"element face {len(mesh.faces)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    rows = np.concatenate([MM * mesh.vertices, normals], axis=1)
    lines = [" ".join(f"{value:.5f}" for value in row) for row in rows.tolist()]
    faces = [f"3 {a} {b} {c}" for a, b, c in mesh.faces.tolist()]
    return ("\n".join([*header, *lines, *faces]) + "\n").encode()


def vertex_normals(mesh: Mesh) -> Float[np.ndarray, "n 3"]:
    """Area-weighted means of the adjacent faces' normals; 0 for a vertex of no face."""
    summed = np.zeros_like(mesh.vertices)
    for corner in range(3):
        np.add.at(summed, mesh.faces[:, corner], face_normals(mesh.vertices, mesh.faces))
    return summed / np.maximum(np.linalg.norm(summed, axis=1, keepdims=True), 1e-12)
