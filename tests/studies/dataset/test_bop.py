"""What BOP's readers expect, held against the images by independent means: projected models, masks, boxes, units."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
import trimesh

from scenes.parts import part_bodies
from studies.dataset.config import load_dataset_config
from studies.dataset.draw.draw import draw_scene
from studies.dataset.draw.objects import object_pool
from studies.dataset.make import bop
from studies.dataset.make.view import LabelledView, Silhouette

PROJECTION_PX = 1.5
"""A silhouette's box ends at pixel centres that are hit, the projected corners between them."""


def _scene(dataset: Path, number: int, name: str) -> dict:
    """As bop_toolkit's `load_json(keys_to_int=True)` reads it."""
    content = json.loads((dataset / "train" / f"{number:06d}" / f"{name}.json").read_text())
    return {int(key): value for key, value in content.items()}


def test_depth_is_in_millimetres_and_camera_entries_are_complete(small_dataset: Path):
    """Keys, lengths and row order that `load_scene_camera` reshapes."""
    for entry in _scene(small_dataset, 0, "scene_camera").values():
        assert np.reshape(entry["cam_K"], (3, 3))[2].tolist() == [0, 0, 1]
        R = np.reshape(entry["cam_R_w2c"], (3, 3))
        assert np.abs(R @ R.T - np.eye(3)).max() < 1e-12
        assert len(entry["cam_t_w2c"]) == 3
        assert entry["depth_scale"] == 1.0
    depth = cv2.imread(str(small_dataset / "train/000000/depth/000000.png"), cv2.IMREAD_UNCHANGED)
    assert depth.dtype == np.uint16
    assert 200 < np.median(depth[depth > 0]) < 3000


@pytest.mark.parametrize("scene", [0, 1])
def test_projected_models_fill_the_boxes(small_dataset: Path, scene: int):
    """Model corners [mm] through cam_R_m2c, cam_t_m2c, K: their box is bbox_obj; convex parts, so corners bound all."""
    cameras, poses, infos = (_scene(small_dataset, scene, f"scene_{n}") for n in ("camera", "gt", "gt_info"))
    for view, entries in poses.items():
        K = np.reshape(cameras[view]["cam_K"], (3, 3))
        for entry, info in zip(entries, infos[view], strict=True):
            model = trimesh.load(small_dataset / "models" / f"obj_{entry['obj_id']:06d}.ply", process=False)
            points = model.vertices @ np.reshape(entry["cam_R_m2c"], (3, 3)).T + entry["cam_t_m2c"]
            uv = points[:, :2] / points[:, 2:] * [K[0, 0], K[1, 1]] + [K[0, 2], K[1, 2]]
            x, y, w, h = info["bbox_obj"]
            assert np.abs(uv.min(axis=0) - [x, y]).max() < PROJECTION_PX
            assert np.abs(uv.max(axis=0) - [x + w - 1, y + h - 1]).max() < PROJECTION_PX


@pytest.mark.parametrize("scene", [0, 1])
def test_world_and_model_poses_agree(small_dataset: Path, scene: int):
    """m2c = w2c after the model's pose in the world, which is the same from every view: parts do not move."""
    cameras, poses = (_scene(small_dataset, scene, f"scene_{n}") for n in ("camera", "gt"))
    places = []
    for view, entries in poses.items():
        w2c = _matrix(cameras[view]["cam_R_w2c"], cameras[view]["cam_t_w2c"])
        places.append([np.linalg.inv(w2c) @ _matrix(e["cam_R_m2c"], e["cam_t_m2c"]) for e in entries])
    assert np.abs(np.array(places[0]) - places[1]).max() < 1e-6


def _matrix(R: list[float], t: list[float]) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = np.reshape(R, (3, 3)), t
    return pose


def test_masks_are_counted(small_dataset: Path):
    """px_count_*, bbox_visib and visib_fract follow from the mask files, counted by OpenCV."""
    for scene in (0, 1):
        folder = small_dataset / "train" / f"{scene:06d}"
        for view, infos in _scene(small_dataset, scene, "scene_gt_info").items():
            depth = cv2.imread(str(folder / f"depth/{view:06d}.png"), cv2.IMREAD_UNCHANGED)
            for place, info in enumerate(infos):
                whole, seen = (
                    cv2.imread(str(folder / f"{name}/{view:06d}_{place:06d}.png"), cv2.IMREAD_UNCHANGED)
                    for name in ("mask", "mask_visib")
                )
                assert np.unique(whole).tolist() == [0, 255]
                x, y, w, h = info["bbox_obj"]
                inside = x >= 0 and y >= 0 and x + w <= 424 and y + h <= 240
                beyond = info["px_count_all"] - cv2.countNonZero(whole)
                assert beyond == 0 if inside else beyond > 0
                assert info["px_count_visib"] == cv2.countNonZero(seen)
                assert info["px_count_valid"] == np.count_nonzero(depth[whole > 0])
                assert info["bbox_visib"] == list(cv2.boundingRect(seen))
                assert info["visib_fract"] == pytest.approx(cv2.countNonZero(seen) / info["px_count_all"])


@pytest.mark.parametrize("scene", [0, 1])
def test_coco_is_what_evaluators_read(small_dataset: Path, scene: int):
    """Ids from 1 without gaps, all objects of the dataset as categories, the whole silhouette's box by OpenCV."""
    folder = small_dataset / "train" / f"{scene:06d}"
    coco = json.loads((folder / "scene_gt_coco.json").read_text())
    infos = _scene(small_dataset, scene, "scene_gt_info")
    assert [(entry["id"], entry["name"]) for entry in coco["categories"]] == [(1, "A1"), (2, "C1")]
    assert [entry["id"] for entry in coco["annotations"]] == list(range(1, len(coco["annotations"]) + 1))
    for entry in coco["annotations"]:
        whole, seen = (
            cv2.imread(str(folder / f"{name}/{entry['image_id']:06d}_{entry['gt_id']:06d}.png"), cv2.IMREAD_UNCHANGED)
            for name in ("mask", "mask_visib")
        )
        assert entry["bbox"] == list(cv2.boundingRect(whole))
        assert entry["area"] == cv2.countNonZero(seen)
        assert entry["ignore"] == (infos[entry["image_id"]][entry["gt_id"]]["visib_fract"] < 0.1)


def test_hardly_visible_objects_do_not_count(small_config: Path):
    """9 of 100 pixels seen: ignored, the box still the whole one; 10 of 100 are enough."""
    config = load_dataset_config(str(small_config))
    draw = draw_scene(config, object_pool(config), 0)
    whole = np.zeros((20, 20), bool)
    whole[5:15, 3:13] = True
    for seen_pixels, ignored in ((9, True), (10, False)):
        seen = np.zeros_like(whole)
        seen[5, 3 : 3 + seen_pixels] = True
        shape = Silhouette(whole, (3, 5, 10, 10), 100)
        n = len(draw.objects)
        view = LabelledView({}, np.zeros((1, 20, 20), np.uint16), (shape,) * n, (seen,) * n, 1.0, 16.0)
        entry = bop.coco_annotations(draw, 0, view)[0]
        assert entry["ignore"] is ignored
        assert entry["bbox"] == [3, 5, 10, 10]


def test_models_are_the_parts_in_millimetres(small_dataset: Path):
    """Box and diameter of part A1, a 120 x 80 x 60 mm block with small roundings, and the origin in its middle."""
    info = json.loads((small_dataset / "models/models_info.json").read_text())["1"]
    points = 1000 * np.concatenate([body.mesh.vertices for body in part_bodies("A1")])
    assert [info[f"size_{a}"] for a in "xyz"] == pytest.approx(np.ptp(points, axis=0), abs=1e-3)
    assert [info[f"min_{a}"] + info[f"size_{a}"] / 2 for a in "xyz"] == pytest.approx([0, 0, 0], abs=1e-3)
    assert info["diameter"] == pytest.approx(np.hypot(np.hypot(120, 80), 60), rel=0.03)
