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

Maker = dict[str, Any]
"""`renderer` and `versions` of a manifest: what decides the bytes of a scene beside its configuration."""


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
        yield f"{SPLIT}/{name}", {"renderer": manifest["renderer"], "versions": manifest["versions"]}


def agreed_maker(makers: Iterable[tuple[str, Maker]]) -> Maker | None:
    """The one that all of them are, None without any; InputError where two differ: their scenes would, too.

    makers: who it is, for people, and what.
    """
    first: tuple[str, Maker] | None = None
    for who, one in makers:
        first = first or (who, one)
        if what := difference(first[1], one):
            raise InputError(
                f"{first[0]} has {what} of {who}; scenes would differ: use the same everywhere, or another folder"
            )
    return first[1] if first else None


def difference(one: Maker, other: Maker) -> str | None:
    """The first thing in which two makers differ, in words; None if there is none."""
    mine, theirs = ({"renderer": maker["renderer"], **maker["versions"]} for maker in (one, other))
    for name in (*mine, *theirs):
        if mine.get(name) != theirs.get(name):
            return f"{name} {mine.get(name)}, not the {theirs.get(name)}"
    return None
