"""One scene of a dataset, made: drawn, built, rendered from all of its poses, labelled, written whole."""

import resource
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.stage_clock import StageClock
from render.d435i import SimulatedD435i
from render.labels.twin import twin_camera
from render.light.radiance import Sampling
from render.world import backend
from render.world.mitsuba_scene import load_scene
from studies.base.output_errors import FutileError, output_errors
from studies.dataset.config import DatasetConfig
from studies.dataset.draw.built_scene import BuiltScene, build_scene, sensor_settings
from studies.dataset.draw.draw import SceneDraw, draw_scene
from studies.dataset.draw.objects import PoolObject, object_pool
from studies.dataset.format.folders import (
    MANIFEST,
    SCENE,
    SPLIT,
    STATISTICS,
    WORK,
    compact_json,
    listed_files,
    scene_name,
    written_whole,
)  # fmt: skip
from studies.dataset.format.layers import FRAMES, MASKS
from studies.dataset.format.scene_files import scene_files
from studies.dataset.format.statistics import counts
from studies.dataset.make import bop
from studies.dataset.make.manifest import input_digests
from studies.dataset.make.view import Cameras, LabelledView, LoneObject, labelled_view
from studies.work.maker import Maker, maker, unlikeness, versions

SCENE_FORMAT = 1
"""Version of what a scene folder holds."""
COMPRESSION = 1
"""Of PNG files (choice: level 9 makes them a fifth smaller and takes ten times as long)."""


@dataclass(frozen=True)
class SceneTask:
    """One scene to make."""

    root: Path
    """Folder of the dataset."""
    config: DatasetConfig
    digest: str
    """Of the dataset's configuration."""
    scene: int
    made_by: Maker | None = None
    """What the others are made by; None = nobody knows yet."""
    inputs: dict[str, str] | None = None
    """Hashes of the CAD and BSDF files by name; None = whatever is there."""

    @property
    def title(self) -> str:
        """For people."""
        return f"scene {scene_name(self.scene)}"


def make_scene(task: SceneTask) -> None:
    """Make the scene and write its folder, unless it is there; leave the times beside it."""
    target = task.root / SPLIT / scene_name(task.scene)
    if target.is_dir():
        return
    if task.made_by and (what := unlikeness(task.made_by, maker())):
        raise FutileError(f"{task.root} has {what} of this worker; use the same everywhere, or another folder")
    clock = StageClock()
    with clock.timing("drawing and placing"):
        pool = object_pool(task.config)
        check_inputs(task, pool)
        draw = draw_scene(task.config, pool, task.scene)
    with clock.timing("loading the scene"):
        built = build_scene(draw, pool, task.config.materials.of_user)
        cameras = scene_cameras(task.config, draw, built, pool)
    with written_whole(task.root, target) as folder:
        write_scene(folder, task, draw, cameras, clock)
        with clock.timing("hashing"):
            files = listed_files(folder)
            if files.keys() != scene_files(task.config, len(draw.views), len(draw.objects)):
                raise RuntimeError(f"{folder}: another process has taken files away")
            (folder / MANIFEST).write_bytes(compact_json(scene_manifest(task, draw, files)))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    stages = {name: [spent.wall_s, spent.process_s] for name, spent in clock.read().items()}
    times = {"views": len(draw.views), "peak_rss": peak, "stages": stages}
    with output_errors(task.root):
        (task.root / WORK / f"{scene_name(task.scene)}.json").write_bytes(compact_json(times))


def check_inputs(task: SceneTask, pool: Sequence[PoolObject]) -> None:
    """FutileError where a file that scenes are made of is not the one that the dataset was begun with."""
    there = input_digests(task.config, pool) if task.inputs is not None else {}
    for name, digest in (task.inputs or {}).items():
        if there.get(name) != digest:
            raise FutileError(
                f"{name}: is not the file that {task.root} was begun with; use that one, or another folder"
            )


def scene_cameras(config: DatasetConfig, draw: SceneDraw, built: BuiltScene, pool: Sequence[PoolObject]) -> Cameras:
    """The camera before the scene, its twin, and every object alone."""
    rendering = config.rendering
    sampling = Sampling(
        glossy_paths=rendering.glossy_paths, refined_share=0.0, indirect_directions=rendering.indirect_directions
    )
    real = SimulatedD435i(built.scene, sensor_settings(config, draw), draw.noise_seed, sampling)
    drawn = {thing.object_id for thing in draw.objects}
    alone = {thing.number: load_scene(thing.scene) for thing in pool if thing.number in drawn}
    lone = tuple(
        LoneObject(alone[thing.object_id], RigidTransform.from_matrix(np.array(thing.T_world_model)))
        for thing in draw.objects
    )
    return Cameras(built, real, twin_camera(real), lone)


def write_scene(folder: Path, task: SceneTask, draw: SceneDraw, cameras: Cameras, clock: StageClock) -> None:
    """All views and what is said about them."""
    camera, info, poses, exposures, statistics, annotations = {}, {}, {}, [], [], []
    k = cameras.real.rig.intrinsics
    for number, drawn in enumerate(draw.views):
        pose = RigidTransform.from_matrix(np.array(drawn.T_world_cam))
        view = labelled_view(cameras, pose, task.config.n_frames, clock.timing)
        with clock.timing("encoding and writing"):
            write_images(folder, number, view, task.config.keep_frames)
            camera[number], poses[number] = bop.camera_entry(k, pose), bop.pose_entries(draw, pose)
            info[number] = bop.info_entries(view)
            annotations.append(bop.coco_annotations(draw, number, view))
            exposures.append({"exposure_us": view.exposure_us, "gain": view.gain})
            on_object = np.any(view.visible, axis=0) if view.visible else np.zeros((k.height, k.width), bool)
            statistics.append(counts(view.images, on_object))
    names = {thing.number: thing.name for thing in object_pool(task.config)}
    files = {
        "scene_camera.json": camera,
        "scene_gt.json": poses,
        "scene_gt_info.json": info,
        "scene_gt_coco.json": bop.coco_file(names, (k.width, k.height), annotations),
        SCENE: scene_record(draw, cameras, exposures),
        STATISTICS: {str(number): rows for number, rows in enumerate(statistics)},
    }
    for name, content in files.items():
        (folder / name).write_bytes(compact_json(content))


def scene_record(draw: SceneDraw, cameras: Cameras, exposures: list[dict[str, float]]) -> dict[str, Any]:
    """Everything that was drawn, and the bodies that the body map counts."""
    built, reduced = cameras.built, cameras.real.intrinsics
    return {
        "draw": draw.model_dump(mode="json"),
        "bodies": [
            {"name": body.name, "material": body.material.name, "object": owner}
            for body, owner in zip(built.scene.bodies, built.owner, strict=True)
        ],
        "exposures": exposures,
        "baseline_m": cameras.real.rig.baseline,
        "K_decimated": reduced.matrix.ravel().tolist(),
        "size_decimated": [reduced.width, reduced.height],
    }


def write_images(folder: Path, number: int, view: LabelledView, keep_frames: bool) -> None:
    """The images of one view; flushed to disk with the whole scene later."""
    for name, image in view.images.items():
        _write(folder / name / f"{number:06d}.png", image)
    for place, (whole, seen) in enumerate(zip(view.silhouettes, view.visible, strict=True)):
        for name, mask in zip(MASKS, (whole.mask, seen), strict=True):
            _write(folder / name / f"{number:06d}_{place:06d}.png", np.where(mask, np.uint8(255), np.uint8(0)))
    if keep_frames:
        for place, frame in enumerate(view.frames):
            _write(folder / FRAMES.folder / f"{number:06d}_{place:06d}.png", frame)


def _write(path: Path, image: np.ndarray) -> None:
    """Colour channels in the order of the array's last axis, as other PNG readers see them."""
    path.parent.mkdir(exist_ok=True)
    ordered = image[..., ::-1] if image.ndim == 3 else image
    done, data = cv2.imencode(".png", ordered, [cv2.IMWRITE_PNG_COMPRESSION, COMPRESSION])
    if not done:
        raise RuntimeError(f"{path}: cannot be encoded")
    path.write_bytes(data.tobytes())


def scene_manifest(task: SceneTask, draw: SceneDraw, files: dict[str, list]) -> dict[str, Any]:
    """What the folder holds and how it came about."""
    return {
        "format": SCENE_FORMAT,
        "dataset": task.digest,
        "scene": task.scene,
        "views": len(draw.views),
        "seed": task.config.seed,
        "noise_seed": draw.noise_seed,
        "renderer": backend.mitsuba_variant(),
        "versions": versions(),
        "files": files,
    }
