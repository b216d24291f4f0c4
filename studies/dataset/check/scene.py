"""What the files of one scene must satisfy: manifest, poses, intrinsics, counts, masks, and every view's images."""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from franbv.frames import block_centre_intrinsics
from studies.base.atomic_file import file_digest
from studies.base.reading import MALFORMED
from studies.dataset.check.draw import Pool, difference, draw_faults, drawn_again
from studies.dataset.check.poses import is_pose, pose_faults
from studies.dataset.check.view import SceneSaid, ViewSaid, check_view
from studies.dataset.config import DatasetConfig
from studies.dataset.draw.built_scene import BuiltScene
from studies.dataset.draw.draw import SceneDraw
from studies.dataset.format.finished_scenes import made_by
from studies.dataset.format.folders import LARGEST_FILE, MANIFEST, SCENE, SPLIT, STATISTICS, read_json, scene_name
from studies.dataset.format.scene_files import TEXTS, scene_files
from studies.dataset.make import bop
from studies.dataset.make.scene_case import SCENE_FORMAT

SAFE_NAME = re.compile(r"[a-z0-9_]+(/[a-z0-9_]+)?\.(png|json)")
"""No path that leaves the folder."""


@dataclass
class SceneCheck:
    """One scene under check."""

    root: Path
    scene: int
    config: DatasetConfig
    digest: str
    """That `dataset.json` states."""
    objects: list[dict[str, Any]]
    """Their numbers and names, as `dataset.json` states them."""
    pool: Pool | None
    """The objects that scenes are drawn from; None where a CAD file is not at hand."""
    problems: list[str] = field(default_factory=list)
    views: int = 0
    made_by: str = ""
    """Renderer and versions, as the manifest has them."""
    changed: set[str] = field(default_factory=set)
    """Files that are not those of the manifest: nothing they say counts, and they are not even decoded."""

    @property
    def folder(self) -> Path:
        """Of the scene."""
        return self.root / SPLIT / scene_name(self.scene)

    def report(self, name: str, what: str) -> None:
        """A problem of one file."""
        self.problems.append(f"{SPLIT}/{scene_name(self.scene)}/{name}: {what}")


def check_scene(check: SceneCheck) -> SceneCheck:
    """All problems of a scene, of its bytes and of what they say."""
    check.views = check.config.views_of(check.scene)
    try:
        manifest = read_json(check.folder / MANIFEST)
        check_manifest(check, manifest)
    except MALFORMED as error:
        check.report(MANIFEST, f"cannot be read ({error})")
        return check
    try:
        check_contents(check, manifest)
    except MALFORMED as error:
        check.report(SCENE, f"the scene's content cannot be checked ({type(error).__name__}: {error})")
    return check


def check_manifest(check: SceneCheck, manifest: dict[str, Any]) -> None:
    """Files: those listed and no others, of the stated size and hash."""
    stated = {"format": SCENE_FORMAT, "dataset": check.digest, "scene": check.scene, "seed": check.config.seed}
    stated["views"] = check.config.views_of(check.scene)
    for key, value in stated.items():
        if manifest[key] != value:
            check.report(MANIFEST, f"{key} is {manifest[key]!r}, not {value!r}")
    check.made_by = made_by(manifest)
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


def check_contents(check: SceneCheck, manifest: dict[str, Any]) -> None:
    """Everything that the files say, where they are as they were made."""
    if check.changed.intersection(TEXTS):
        return
    camera, poses, info, coco, scene, statistics = (read_json(check.folder / name) for name in TEXTS)
    draw = SceneDraw.model_validate(scene["draw"])
    if draw.scene != check.scene:
        check.report(SCENE, f"is of scene {draw.scene}")
    if len(draw.views) != check.views:
        check.report(SCENE, f"has {len(draw.views)} views, not {check.views}")
        return
    if manifest["noise_seed"] != draw.noise_seed:
        check.report(MANIFEST, "noise_seed is not that of the draw")
    keys = [str(number) for number in range(check.views)]
    for name, entries in zip((*TEXTS[:3], STATISTICS), (camera, poses, info, statistics), strict=True):
        if list(entries) != keys:
            check.report(name, "does not have one entry for each view, in order")
            return
    check_file_names(check, len(draw.objects))
    check_draw(check, draw, scene)
    said = SceneSaid(check.folder, check.config, draw, scene["bodies"], check_drawn_again(check, scene))
    annotations = []
    for number in range(check.views):
        for name, what in pose_faults(draw, number, camera[str(number)], poses[str(number)], said.rig.intrinsics):
            check.report(name, f"view {number}: {what}")
        annotations.append(check_images(check, said, ViewSaid(number, info[str(number)], statistics[str(number)])))
    if None not in annotations:
        check_coco(check, draw, coco, annotations)


def check_images(check: SceneCheck, said: SceneSaid, view: ViewSaid) -> list[dict[str, Any]] | None:
    """Report what is wrong with a view's images; its COCO annotations, None where they cannot be told."""
    if any(f"/{view.number:06d}" in name for name in check.changed):
        return None
    try:
        faults, annotations = check_view(said, view)
    except MALFORMED as error:
        check.report(SCENE, f"view {view.number}: cannot be checked ({type(error).__name__}: {error})")
        return None
    for name, what in faults:
        check.report(name, f"view {view.number}: {what}" if name.endswith(".json") else what)
    return annotations


def check_drawn_again(check: SceneCheck, scene: dict[str, Any]) -> BuiltScene | None:
    """The scene as the configuration gives it; None where it cannot be drawn."""
    if check.pool is None:
        return None
    again, built = drawn_again(check.config, check.pool, check.scene)
    for what in draw_faults(scene, check.config, again, built):
        check.report(SCENE, what)
    return built


def check_coco(check: SceneCheck, draw: SceneDraw, coco: dict[str, Any], annotations: list) -> None:
    """The file is what masks and draw give."""
    k = check.config.camera.rig(draw.profile).intrinsics
    names = {int(entry["obj_id"]): str(entry["name"]) for entry in check.objects}
    if what := difference(coco, bop.coco_file(names, (k.width, k.height), annotations), ""):
        check.report("scene_gt_coco.json", what)


def check_file_names(check: SceneCheck, n_objects: int) -> None:
    """Every image of every view is there, and no other."""
    expected = scene_files(check.config, check.views, n_objects) - set(TEXTS)
    found = {path.relative_to(check.folder).as_posix() for path in check.folder.rglob("*.png")}
    for name in sorted(expected - found - check.changed):
        check.report(name, "is missing")
    for name in sorted(found - expected - check.changed):
        check.report(name, "belongs to no view")


def check_draw(check: SceneCheck, draw: SceneDraw, scene: dict[str, Any]) -> None:
    """Rig and exposure are the camera's; every pose is one."""
    rig = check.config.camera.rig(draw.profile)
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
