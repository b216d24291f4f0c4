"""`franbv dataset check`: every byte against the manifests, every label against depth and truth; prints a verdict."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from studies.command_line import parse
from studies.console import progress_bar, say, say_json
from studies.dataset.card import card
from studies.dataset.check_scene import UNREADABLE, SceneCheck, check_scene
from studies.dataset.config import DatasetConfig
from studies.dataset.folders import (
    CAMERA,
    CARD,
    DATASET,
    INDEX,
    MODELS,
    SPLIT,
    WORK,
    bounded_bytes,
    existing_dataset,
    read_json,
    scene_name,
)  # fmt: skip
from studies.dataset.gathered import gather
from studies.dataset.head import dataset_digest
from studies.dataset.index import derived_index, scene_folders
from studies.workers import usable_processors

PROGRAM = "franbv dataset check"
HELP = "Verify hashes, label algebra, ranges, intrinsics, poses and units of a dataset. Exit status 1 on any problem."
SIZES_MM = (5.0, 1000.0)
"""Sides of objects that can be in millimetres [mm]: a screw to what a table holds."""


@dataclass(frozen=True)
class CheckCommand:
    """The flags of `franbv dataset check`."""

    dir: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    """Folder of the dataset."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Check and print."""
    command = parse(CheckCommand, args, PROGRAM, HELP)
    views, problems = dataset_problems(existing_dataset(command.dir))
    for problem in problems:
        say(problem)
    verdict = "sound: every byte, label, pose and count agrees" if not problems else f"{len(problems)} problems"
    say(f"{command.dir}: {views} views, {verdict}")
    if command.json:
        say_json({"views": views, "problems": len(problems)})
    return 1 if problems else 0


def dataset_problems(root: Path) -> tuple[int, list[str]]:
    """Number of views, and one line for each problem."""
    try:
        top = read_json(root / DATASET)
        config = DatasetConfig.model_validate(top["config"])
        digest = str(top["digest"])
    except UNREADABLE as error:
        return 0, [f"{DATASET}: cannot be read ({' '.join(str(error).split())})"]
    problems: list[str] = []
    try:
        problems += head_problems(root, top, config)
    except UNREADABLE as error:
        problems.append(f"{DATASET}: does not say what it must ({type(error).__name__}: {error})")
    there = set(scene_folders(root))
    wanted = [number for number in range(config.scenes) if scene_name(number) in there]
    problems += [f"{SPLIT}/{scene_name(n)}: is missing" for n in range(config.scenes) if scene_name(n) not in there]
    checks: list[SceneCheck] = []
    with ThreadPoolExecutor(usable_processors()) as pool, progress_bar() as progress:
        task = progress.add_task("checking", total=len(wanted))
        for check in pool.map(lambda number: check_scene(root, number, config, digest), wanted):
            checks.append(check)
            problems += check.problems
            progress.update(task, advance=1)
    problems += derived_problems(root, sorted(there))
    return sum(check.views for check in checks), problems


def head_problems(root: Path, top: dict[str, Any], config: DatasetConfig) -> Iterator[str]:
    """Of the top folder: what does not belong there, and what its files say of themselves."""
    if top["digest"] != dataset_digest(config):
        yield f"{DATASET}: the digest is not that of the configuration"
    known = {DATASET, INDEX, CARD, CAMERA, MODELS, SPLIT}
    models = {f"obj_{entry['obj_id']:06d}.ply" for entry in top["objects"]} | {"models_info.json"}
    scenes = {scene_name(number) for number in range(config.scenes)}
    for folder, expected in ((root, known), (root / MODELS, models), (root / SPLIT, scenes)):
        if folder.is_symlink() or not folder.is_dir():
            yield f"{folder.name}: is no folder"
            continue
        for path in sorted(folder.iterdir()):
            name = path.relative_to(root).as_posix()
            if path.name == WORK:
                yield f"{WORK}: the dataset is unfinished; give the `make` command again"
            elif path.name not in expected:
                yield f"{name}: stray"
            elif path.is_symlink():
                yield f"{name}: is a link"
        yield from (
            f"{(folder / name).relative_to(root).as_posix()}: is missing"
            for name in sorted(expected - {path.name for path in folder.iterdir()})
            if folder != root / SPLIT
        )
    try:
        yield from model_problems(root)
    except UNREADABLE as error:
        yield f"{MODELS}: cannot be read ({error})"


def model_problems(root: Path) -> Iterator[str]:
    """Boxes in `models_info.json` are those of the models, in millimetres."""
    for number, info in read_json(root / MODELS / "models_info.json").items():
        name = f"{MODELS}/obj_{int(number):06d}.ply"
        points = ply_points(bounded_bytes(root / name))
        low, size = points.min(axis=0), np.ptp(points, axis=0)
        stated = [[info[f"{what}_{axis}"] for axis in "xyz"] for what in ("min", "size")]
        if np.abs(np.array(stated) - [low, size]).max() > 1e-4:
            yield f"{name}: is not as large as models_info.json says"
        if not SIZES_MM[0] <= size.max() <= SIZES_MM[1]:
            yield f"{name}: is {size.max():.3g} mm long; models are in millimetres"


def ply_points(data: bytes) -> np.ndarray:
    """Vertices of an ASCII PLY of ours, (n, 3)."""
    head, _, body = data.partition(b"end_header\n")
    counts = [int(line.split()[2]) for line in head.splitlines() if line.startswith(b"element vertex ")]
    if len(counts) != 1:
        raise ValueError("a model is no PLY file")
    count = counts[0]
    return np.array([line.split()[:3] for line in body.split(b"\n", count)[:count]], float)


def derived_problems(root: Path, scenes: list[str]) -> Iterator[str]:
    """Index and card are what the scenes make them."""
    for name, derive in (
        (INDEX, lambda: derived_index(root, scenes)),
        (CARD, lambda: card(gather(root)).encode()),
    ):
        try:
            if bounded_bytes(root / name) != derive():
                yield f"{name}: is not what the scenes say; a scene or this file was changed"
        except UNREADABLE as error:
            yield f"{name}: cannot be checked ({' '.join(str(error).split())})"
