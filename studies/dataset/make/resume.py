"""Scenes that are there when a dataset is taken up again: which are whole, and by what they were made."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from materials.input_error import InputError
from studies.base.console import warn
from studies.dataset.config import DatasetConfig
from studies.dataset.format.folders import MANIFEST, SPLIT, read_json, removed_at_once, scene_name
from studies.dataset.format.index import scene_folders
from studies.dataset.format.scene_files import OF_ANOTHER, scene_fault
from studies.work.maker import Maker


def sound_scenes(root: Path, config: DatasetConfig, digest: str) -> list[int]:
    """Numbers of the scenes that are there whole; others are removed, with a line each.

    digest: of the dataset's configuration. InputError for a folder that is no scene of this configuration.
    """
    numbers = {scene_name(number): number for number in range(config.scenes)}
    sound = []
    for name in scene_folders(root):
        if name not in numbers:
            raise InputError(f"{root / SPLIT / name}: is no scene of this dataset; move it away")
        fault = scene_fault(root / SPLIT / name, config, digest, numbers[name])
        if fault == OF_ANOTHER:
            raise InputError(f"{root / SPLIT / name}: {fault}; move it away")
        if fault:
            warn(f"{SPLIT}/{name}: {fault}; the scene is made again")
            removed_at_once(root, root / SPLIT / name)
        else:
            sound.append(numbers[name])
    return sound


def scene_makers(root: Path, scenes: Iterable[int]) -> Iterable[tuple[str, Maker]]:
    """What made each of these scenes, by its name."""
    for name in map(scene_name, scenes):
        manifest = read_json(root / SPLIT / name / MANIFEST)
        yield f"{SPLIT}/{name}", manifest_maker(manifest)


def manifest_maker(manifest: dict[str, Any]) -> Maker:
    """What made a scene, by its manifest."""
    return {"renderer": manifest["renderer"]} | manifest["versions"]
