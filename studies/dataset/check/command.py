"""`franbv dataset check`: every byte against the manifests, every label against depth and truth; prints a verdict."""

import re
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from materials.input_error import InputError
from studies.base.console import progress_bar, say, say_json
from studies.base.flags import parse
from studies.base.reading import MALFORMED
from studies.dataset.card.card import card
from studies.dataset.check.draw import Pool
from studies.dataset.check.head import camera_problems, model_problems, stray_problems, table_problems
from studies.dataset.check.scene import SceneCheck, check_scene
from studies.dataset.config import DatasetConfig, load_dataset_config
from studies.dataset.draw.objects import object_pool
from studies.dataset.format.finished_scenes import gather_scenes
from studies.dataset.format.folders import (
    CAMERA,
    CARD,
    DATASET,
    INDEX,
    MANIFEST,
    MODELS,
    SPLIT,
    bounded_bytes,
    existing_dataset,
    read_json,
    scene_name,
)  # fmt: skip
from studies.dataset.format.index import derived_index, scene_folders
from studies.dataset.make.manifest import dataset_digest, input_digests
from studies.work.maker import unlikeness, versions
from studies.work.workers import usable_processors

_PROGRAM = "franbv dataset check"
_HELP = "Verify hashes, label algebra, ranges, intrinsics, poses and units of a dataset. Exit status 1 on any problem."


SPOILT_SCENE = re.compile(rf"({SPLIT}/[0-9]{{6}})(/|:)")
MOST_NAMED = 5
"""Scenes and files that the mend names (choice: a line)."""
LONGEST_LINE = 400
"""Of a problem [characters] (choice: a few lines of a terminal)."""
SOUND = (
    "no problem. Every file has the hash that its manifest states; draws, poses, intrinsics, bodies, masks, depth "
    "(from the infrared pair), decimated images and counts follow from the configuration and from each other."
)
NOT_CHECKED = (
    "Not checked, since it takes a new rendering: that infrared images and true maps are what the renderer gives, the "
    "exposure that was chosen automatically, and which of several causes a hole has beyond what geometry decides. "
    "Hashes have no key: they show that nothing changed since, not who made it."
)


@dataclass(frozen=True)
class CheckCommand:
    """The flags of `franbv dataset check`."""

    dir: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    """Folder of the dataset."""
    config: Annotated[str | None, tyro.conf.arg(metavar="CONFIG.yaml")] = None
    """What the dataset was made from; needed to draw scenes with CAD files again."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Check and print."""
    command = parse(CheckCommand, args, _PROGRAM, _HELP)
    root, pool = existing_dataset(command.dir).resolve(), None
    if command.config is not None:
        pool = pool_of(root, load_dataset_config(command.config))
    views, problems = dataset_problems(root, pool)
    for problem in problems:
        say(problem)
    say(f"{command.dir}: {views} views, {SOUND if not problems else f'{len(problems)} problems'}")
    say(mend(problems) if problems else NOT_CHECKED)
    if problems and (what := other_version(root)):
        say(f"The dataset was made by {what} here: problems may come from that; check it with what it was made by.")
    if not problems and pool is None and needs_cad(root):
        say("Draws and models were not made again, because CAD files are needed for that: give --config CONFIG.yaml.")
    if command.json:
        say_json({"views": views, "problems": len(problems)})
    return 1 if problems else 0


def other_version(root: Path) -> str | None:
    """In what the first scene's maker differs from what runs here, in words; None if in nothing, or it does not say."""
    try:
        made = read_json(root / SPLIT / scene_folders(root)[0] / MANIFEST)
        return unlikeness(made["versions"], versions())
    except MALFORMED:
        return None


def pool_of(root: Path, config: DatasetConfig) -> Pool:
    """The objects of the configuration that the dataset was made from; InputError if it was made from another one."""
    try:
        top = read_json(root / DATASET)
        same = top["digest"] == dataset_digest(config.model_copy(update={"views": top["config"]["views"]}))
    except MALFORMED:
        return object_pool(config)  # what is wrong with the dataset is the check's to say
    if not same:
        raise InputError(f"{root}: was not made from this configuration; give the one that it was made from")
    pool = object_pool(config)
    for name, digest in input_digests(config, pool).items():
        if digest not in (*(entry.get("blake2b") for entry in top["objects"]), *top["measured"].values()):
            raise InputError(f"{name}: is not the file that {root} was made from; give that one")
    return pool


def needs_cad(root: Path) -> bool:
    """Whether the pool holds CAD files, which the dataset itself does not."""
    return bool(read_json(root / DATASET)["config"]["objects"]["cad"])


def dataset_problems(root: Path, pool: Pool | None = None) -> tuple[int, list[str]]:
    """Number of views, and one line for each problem.

    pool: the objects that scenes are drawn from; made from the configuration where it names no CAD file.
    """
    try:
        top = read_json(root / DATASET)
        config = DatasetConfig.model_validate(top["config"])
        digest, objects = str(top["digest"]), list(top["objects"])
        pool = pool or (None if config.objects.cad else object_pool(config))
    except MALFORMED as error:
        return 0, [bounded_line(f"{DATASET}: cannot be read ({type(error).__name__}: {error})")]
    problems = head_problems(root, top, config, pool)
    there = set(scene_folders(root))
    wanted = [number for number in range(config.scenes) if scene_name(number) in there]
    problems += missing_scenes([scene_name(n) for n in range(config.scenes) if scene_name(n) not in there])
    checks = [SceneCheck(root, number, config, digest, objects, pool) for number in wanted]
    with ThreadPoolExecutor(usable_processors()) as workers, progress_bar() as progress:
        task = progress.add_task("checking", total=len(wanted))
        for check in workers.map(check_scene, checks):
            problems += check.problems
            progress.update(task, advance=1)
    makers = Counter(check.made_by for check in checks if check.made_by)
    if len(makers) > 1:
        problems.append(f"{SPLIT}: scenes were made by different renderers or versions: {' and '.join(sorted(makers))}")
    problems += derived_problems(root, sorted(there))
    return sum(check.views for check in checks), [bounded_line(problem) for problem in problems]


def missing_scenes(names: list[str]) -> list[str]:
    """One line, however many there are."""
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return [f"{SPLIT}/{names[0]}{more}: missing; give the `make` command again"] if names else []


def head_problems(root: Path, top: dict[str, Any], config: DatasetConfig, pool: Pool | None) -> list[str]:
    """Of the top folder."""
    problems: list[str] = []
    for name, check in (
        (DATASET, lambda: stray_problems(root, top, config)),
        (DATASET, lambda: table_problems(top, config, pool)),
        (CAMERA, lambda: camera_problems(root, config)),
        (MODELS, lambda: model_problems(root, top, pool)),
    ):
        try:
            problems += check()
        except MALFORMED as error:
            problems.append(f"{name}: cannot be checked ({type(error).__name__}: {error})")
    return problems


def bounded_line(text: str) -> str:
    """On one line of bounded length, without what a terminal would obey: names and values come from the files."""
    words = " ".join("".join(c if c.isprintable() else " " for c in text[: 2 * LONGEST_LINE]).split())
    return words if len(words) <= LONGEST_LINE else words[: LONGEST_LINE - 4] + " ..."


def mend(problems: list[str]) -> str:
    """What to delete so that `make` makes it again."""
    spoilt = dict.fromkeys(
        found.group(1) if (found := SPOILT_SCENE.match(problem)) else problem.partition(": ")[0]
        for problem in problems
        if "give the `make` command again" not in problem
    )
    named = ", ".join(list(spoilt)[:MOST_NAMED]) + (
        f" and {len(spoilt) - MOST_NAMED} more" if len(spoilt) > MOST_NAMED else ""
    )
    return (
        f"To mend it: {f'delete {named}, then ' if spoilt else ''}give the `make` command again; it makes what is gone."
    )


def derived_problems(root: Path, scenes: list[str]) -> Iterator[str]:
    """Index and card are what the scenes make them."""
    for name, derive in (
        (INDEX, lambda: derived_index(root, scenes)),
        (CARD, lambda: card(gather_scenes(root)).encode()),
    ):
        try:
            if bounded_bytes(root / name) != derive():
                yield f"{name}: is not what the scenes say; a scene or this file was changed"
        except MALFORMED as error:
            yield f"{name}: cannot be checked ({' '.join(str(error).split())})"
