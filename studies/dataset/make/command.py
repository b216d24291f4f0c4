"""`franbv dataset make`: draw, render and label what is missing, on this machine or a cluster, then index and card."""

import contextlib
import shutil
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tyro

from materials.input_error import InputError
from studies.base.atomic_file import folder_lock
from studies.base.config import validated
from studies.base.console import say, say_json, warn
from studies.base.flags import parse
from studies.base.inputs import check_outside
from studies.base.output_errors import output_errors, prepare_output
from studies.dataset.card.card import write_card
from studies.dataset.config import DatasetConfig, load_dataset_config
from studies.dataset.draw.objects import PoolObject, check_body_count, object_pool
from studies.dataset.format.folders import DATASET, MODELS, SPLIT, WORK, read_json, removed_at_once, scene_name
from studies.dataset.format.index import scene_folders, write_index
from studies.dataset.format.scene_files import belongs_to
from studies.dataset.make.manifest import check_same, dataset_digest, input_digests, input_files, write_head
from studies.dataset.make.resume import scene_makers, sound_scenes
from studies.dataset.make.scene_case import SceneTask, make_scene
from studies.work.executor import Executor, WorkFlags, executor_of, exit_status, reasons_once
from studies.work.maker import agreed_maker, versions
from studies.work.workers import Failure, Job

_PROGRAM = "franbv dataset make"
_HELP = "Render labelled depth of random scenes. The same command takes an interrupted dataset up where it stopped."


@dataclass(frozen=True)
class MakeCommand:
    """The flags of `franbv dataset make`."""

    config: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="CONFIG.yaml")]
    """What to draw from: a YAML file, or `default`."""
    dir: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    """Folder of the dataset."""
    views: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """How many views, instead of those of the configuration."""
    work: Annotated[WorkFlags, tyro.conf.arg(name="")] = field(default_factory=WorkFlags)
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Make what is missing."""
    began = time.perf_counter()
    command = parse(MakeCommand, args, _PROGRAM, _HELP)
    config = load_dataset_config(command.config)
    if command.views is not None:
        config = validated(DatasetConfig, config.model_dump() | {"views": command.views}, "--views")
    pool = object_pool(config)
    for notice in (notice for thing in pool for notice in thing.notices):
        warn(f"{_PROGRAM}: {notice}")
    check_body_count(config, pool)
    root = command.dir.resolve()
    check_outside(input_files(command.config, config), root)
    with executor_of(command.work) as executor:  # before anything is written
        prepare_output(root)
        with _alone(root), output_errors(root):
            check_ours(root, dataset_digest(config))
            (root / WORK).mkdir(exist_ok=True)  # first of all: what is half-written is ours from here on
            clear_debris(root)
            try:
                failures, made = make_missing(root, config, pool, executor)
            finally:
                with contextlib.suppress(OSError):  # unless something in it is worth keeping
                    (root / WORK).rmdir()
            figures = make_summary(root, made, failures, config, time.perf_counter() - began)
            if not failures:
                write_index(root, scene_folders(root))
                write_card(root)
                shutil.rmtree(root / WORK, ignore_errors=True)
    say(sentence(root, figures))
    if command.json:
        say_json(figures)
    return exit_status(failures)


def check_ours(root: Path, digest: str) -> None:
    """InputError for a folder that holds anything but a dataset of ours, whole, just begun, or of this configuration
    without its `dataset.json`."""
    begun = any((root / name).exists() for name in (DATASET, WORK)) or not any(root.iterdir())
    if not begun and not any(belongs_to(root / SPLIT / name, digest) for name in scene_folders(root)):
        raise InputError(f"{root}: holds other files, and no {DATASET}; give an empty folder, or that of a dataset")


def make_missing(
    root: Path, config: DatasetConfig, pool: Sequence[PoolObject], executor: Executor
) -> tuple[list[Failure], list[int]]:
    """Make the scenes that are not there whole; returns those that were given up, and the numbers of those tried."""
    check_same(root, config, pool)
    (root / SPLIT).mkdir(exist_ok=True)
    for leftover in list((root / WORK).glob("*-*")):  # of processes that were killed, and of some that may live on
        removed_at_once(root, leftover)
    digest = dataset_digest(config)
    sound = sound_scenes(root, config, digest)
    missing = sorted(set(range(config.scenes)) - set(sound))
    made_by = agreed_maker(scene_makers(root, sound))
    there = [] if made_by is None else [(str(root), made_by)]
    if missing:
        executor.check_folder(root / WORK)
        made_by = agreed_maker([*there, *executor.makers().items()])
    if made_by and missing:  # models and tables are written here
        agreed_maker([(str(root), made_by), ("this machine", {**made_by, **versions()})])
    write_head(root, config, pool)
    inputs = input_digests(config, pool)
    tasks = [SceneTask(root, config, digest, number, made_by, inputs) for number in missing]
    jobs = [Job(task.title, make_scene, task) for task in tasks]
    tell = reasons_once(_PROGRAM)
    failures = executor.run([jobs], len(sound), tell)
    known, arrived = {failure.name for failure in failures}, set(scene_folders(root))
    for task in tasks:
        if scene_name(task.scene) not in arrived and task.title not in known:
            failures.append(Failure(task.title, "was made, but did not arrive in this folder"))
            tell(failures[-1])
    return failures, missing


def clear_debris(root: Path) -> None:
    """Remove what killed processes left half-written at the top."""
    for pattern in (".*.tmp", f"{MODELS}/.*.tmp", ".write-test-*"):
        for path in root.glob(pattern):
            path.unlink(missing_ok=True)


def make_summary(
    root: Path, made: list[int], failures: list[Failure], config: DatasetConfig, wall_s: float
) -> dict[str, Any]:
    """The figures of this command; `views` and `failed` count views and together make the dataset."""
    times = [read_json(path) for number in made if (path := root / WORK / f"{scene_name(number)}.json").exists()]
    views = sum(entry["views"] for entry in times)
    stages: dict[str, list[float]] = {}
    for entry in times:
        for name, spent in entry["stages"].items():
            stages[name] = [a + b for a, b in zip(stages.get(name, [0.0, 0.0]), spent, strict=True)]
    there = set(scene_folders(root))
    in_folder = sum(config.views_of(number) for number in range(config.scenes) if scene_name(number) in there)
    return {
        "views": in_folder,
        "failed": config.views - in_folder,
        "failed_scenes": len(failures),
        "views_per_s": views / wall_s,
        "peak_rss_gb": max((entry["peak_rss"] for entry in times), default=0) / 1e9,
        "wall_s": wall_s,
        "made_now": views,
        "cpu_s_per_view": {name: spent[1] / views for name, spent in stages.items()} if views else {},
    }


def sentence(root: Path, figures: dict[str, Any]) -> str:
    """The figures in words."""
    lines = [f"{figures['views']} views in {root}, {figures['made_now']} of them made now"]
    if figures["made_now"]:
        lines[0] += f", {figures['views_per_s']:.2f} a second; peak memory {figures['peak_rss_gb']:.2f} GB a worker"
        spent = sorted(figures["cpu_s_per_view"].items(), key=lambda item: -item[1])
        lines.append("Processor time a view [s]: " + ", ".join(f"{name} {seconds:.2f}" for name, seconds in spent))
    if figures["failed"]:
        scenes = "1 scene" if figures["failed_scenes"] == 1 else f"{figures['failed_scenes']} scenes"
        lines.append(f"{scenes} with {figures['failed']} views failed; the same command tries again.")
    return "\n".join(lines)


@contextlib.contextmanager
def _alone(root: Path) -> Iterator[None]:
    """Hold the dataset's folder."""
    with folder_lock(root) as held:
        if held is None:
            raise InputError(f"{root}: another process makes this dataset; wait for it to end")
        yield
