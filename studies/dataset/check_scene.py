"""What the files of one scene must satisfy: manifest, poses, intrinsics, counts, masks, and every view's images."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from render.decimation import block_centre_intrinsics
from render.rig import d435i_rig
from studies.cases import file_digest
from studies.dataset.check_images import view_faults
from studies.dataset.check_masks import Annotations, mask_faults
from studies.dataset.check_poses import is_pose, pose_faults
from studies.dataset.config import DatasetConfig
from studies.dataset.draw import SceneDraw
from studies.dataset.folders import LARGEST_FILE, MANIFEST, SCENE, SPLIT, STATISTICS, read_json, scene_name
from studies.dataset.layers import FRAMES, MASKS
from studies.dataset.layers import layers as layers_of
from studies.dataset.reader import read_layer
from studies.dataset.scene_case import FORMAT
from studies.dataset.statistics import counts

JSON_FILES = ("scene_camera.json", "scene_gt.json", "scene_gt_info.json", "scene_gt_coco.json", SCENE, STATISTICS)
SAFE_NAME = re.compile(r"[a-z0-9_]+(/[a-z0-9_]+)?\.(png|json)")
"""No path that leaves the folder."""
UNREADABLE = (OSError, ValueError, KeyError, TypeError, IndexError, AttributeError)
"""What reading something malformed raises."""


@dataclass
class SceneCheck:
    """One scene under check."""

    root: Path
    scene: int
    config: DatasetConfig
    digest: str
    """That `dataset.json` states."""
    problems: list[str] = field(default_factory=list)
    views: int = 0
    changed: set[str] = field(default_factory=set)
    """Files that are not those of the manifest: nothing they say counts, and they are not even decoded."""

    @property
    def folder(self) -> Path:
        """Of the scene."""
        return self.root / SPLIT / scene_name(self.scene)

    def report(self, name: str, what: str) -> None:
        """A problem of one file."""
        self.problems.append(f"{SPLIT}/{scene_name(self.scene)}/{name}: {what}")


def check_scene(root: Path, scene: int, config: DatasetConfig, digest: str) -> SceneCheck:
    """All problems of a scene, of its bytes and of what they say."""
    check = SceneCheck(root, scene, config, digest, views=config.views_of(scene))
    try:
        manifest = read_json(check.folder / MANIFEST)
        check_manifest(check, manifest)
    except UNREADABLE as error:
        check.report(MANIFEST, f"cannot be read ({error})")
        return check
    try:
        check_contents(check)
    except UNREADABLE as error:
        check.report(SCENE, f"the scene's content cannot be checked ({type(error).__name__}: {error})")
    return check


def check_manifest(check: SceneCheck, manifest: dict[str, Any]) -> None:
    """Files: those listed and no others, of the stated size and hash."""
    stated = {"format": FORMAT, "dataset": check.digest, "scene": check.scene, "seed": check.config.seed}
    stated["views"] = check.config.views_of(check.scene)
    for key, value in stated.items():
        if manifest[key] != value:
            check.report(MANIFEST, f"{key} is {manifest[key]!r}, not {value!r}")
    listed: dict[str, list] = manifest["files"]
    there = {path.relative_to(check.folder).as_posix(): path for path in check.folder.rglob("*")}
    found = {name: path for name, path in there.items() if not _is_folder(path)}
    for name in sorted(there.keys() - found.keys() - {Path(name).parent.as_posix() for name in listed}):
        check.report(name, "stray folder")
    for name in sorted(found.keys() - listed.keys() - {MANIFEST}):
        check.report(name, "stray file: the manifest does not list it")
        check.changed.add(name)
    for name, (size, digest) in listed.items():
        if not SAFE_NAME.fullmatch(name):
            check.report(MANIFEST, f"lists {name!r}, which is no name of a dataset's file")
        elif what := change_of(found.get(name), size, digest):
            check.report(name, what)
            check.changed.add(name)


def change_of(path: Path | None, size: int, digest: str) -> str | None:
    """What is wrong with a file's bytes; None if they are those of the manifest."""
    if path is None:
        return "is missing"
    if path.is_symlink():
        return "is a link, not a file"
    if path.stat().st_size != size or size > LARGEST_FILE:
        return f"has {path.stat().st_size} bytes, not {size}"
    return None if file_digest(path) == digest else "was changed: its hash is another"


def _is_folder(path: Path) -> bool:
    return path.is_dir() and not path.is_symlink()


def check_contents(check: SceneCheck) -> None:
    """Everything that the files say, where they are as they were made."""
    if check.changed.intersection(JSON_FILES):
        return
    camera, poses, info, coco, scene, statistics = (read_json(check.folder / name) for name in JSON_FILES)
    draw = SceneDraw.model_validate(scene["draw"])
    if draw.scene != check.scene:
        check.report(SCENE, f"is of scene {draw.scene}")
    if len(draw.views) != check.views:
        check.report(SCENE, f"has {len(draw.views)} views, not {check.views}")
        return
    keys = [str(number) for number in range(check.views)]
    for name, entries in zip((*JSON_FILES[:3], STATISTICS), (camera, poses, info, statistics), strict=True):
        if list(entries) != keys:
            check.report(name, "does not have one entry for each view, in order")
            return
    check_file_names(check, len(draw.objects))
    check_draw(check, draw, scene)
    annotations = _by_view(coco)
    for number in range(check.views):
        faults = [
            *pose_faults(draw, number, camera[str(number)], poses[str(number)]),
            *image_faults(check, draw, scene, number, info[str(number)], annotations, statistics[str(number)]),
        ]
        for name, what in faults:
            check.report(name, f"view {number}: {what}" if name.endswith(".json") else what)


def check_file_names(check: SceneCheck, n_objects: int) -> None:
    """Every image of every view is there, and no other."""
    layers = [layer.folder for layer in layers_of(check.config.n_frames)]
    expected = {f"{folder}/{view:06d}.png" for folder in layers for view in range(check.views)}
    numbered: dict[str, int] = dict.fromkeys(MASKS, n_objects)
    if check.config.keep_frames:
        numbered[FRAMES.folder] = check.config.n_frames
    for folder, count in numbered.items():
        expected |= {f"{folder}/{view:06d}_{place:06d}.png" for view in range(check.views) for place in range(count)}
    found = {path.relative_to(check.folder).as_posix() for path in check.folder.rglob("*.png")}
    for name in sorted(expected - found - check.changed):
        check.report(name, "is missing")
    for name in sorted(found - expected - check.changed):
        check.report(name, "belongs to no view")


def check_draw(check: SceneCheck, draw: SceneDraw, scene: dict[str, Any]) -> None:
    """Rig and exposure are the camera's; every pose is one."""
    rig = d435i_rig(draw.profile)
    reduced = block_centre_intrinsics(rig.intrinsics, check.config.camera.decimation)
    if scene["baseline_m"] != rig.baseline:
        check.report(SCENE, f"the baseline is {scene['baseline_m']} m, not {rig.baseline} m")
    stated = (scene["K_decimated"], scene["size_decimated"])
    if stated != (reduced.matrix.ravel().tolist(), [reduced.width, reduced.height]):
        check.report(SCENE, "the decimated intrinsics are not those of the profile")
    if len(scene["exposures"]) != check.views:
        check.report(SCENE, "does not have one exposure for each view")
    for entry in scene["exposures"]:
        if not (1 <= entry["exposure_us"] <= 165_000 and 16 <= entry["gain"] <= 248):
            check.report(SCENE, f"exposure {entry} is beyond the camera's range")
    for matrix in (*(thing.T_world_model for thing in draw.objects), *(view.T_world_cam for view in draw.views)):
        if not is_pose(np.array(matrix)):
            check.report(SCENE, "holds a matrix that is no pose")


def image_faults(
    check: SceneCheck,
    draw: SceneDraw,
    scene: dict[str, Any],
    number: int,
    info: list[dict[str, Any]],
    annotations: Annotations,
    statistics: list[list[int]],
) -> Iterator[tuple[str, str]]:
    """Sizes and types, what the images say, and what is counted of them."""
    if any(f"/{number:06d}" in name for name in check.changed):
        return
    rig = d435i_rig(draw.profile)
    full, reduced = (rig.intrinsics.height, rig.intrinsics.width), scene["size_decimated"][::-1]
    images: dict[str, np.ndarray] = {}
    for layer in layers_of(check.config.n_frames):
        name = f"{layer.folder}/{number:06d}.png"
        try:
            images[layer.folder] = read_layer(check.folder / name, layer)
        except (OSError, ValueError) as error:
            yield name, f"cannot be read ({error})"
            return
        wanted = list(reduced) if layer.decimated else list(full)
        if list(images[layer.folder].shape[:2]) != wanted:
            yield name, f"is {images[layer.folder].shape[1]}x{images[layer.folder].shape[0]} pixels"
            return
    for folder, what in view_faults(images, scene["bodies"], rig, check.config.n_frames):
        yield f"{folder}/{number:06d}.png", what
    owner = np.array([-1, *(entry["object"] for entry in scene["bodies"])])[images["body"]]
    for place in range(len(draw.objects)):
        yield from mask_faults(check.folder, number, place, owner == place, images["depth"], info[place], annotations)
    if counts(images, owner >= 0) != statistics:
        yield STATISTICS, "the counts are not those of the images"


def _by_view(coco: dict[str, Any]) -> Annotations:
    return {(entry["image_id"], entry["gt_id"]): entry for entry in coco["annotations"]}
