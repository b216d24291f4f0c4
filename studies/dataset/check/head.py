"""What the top of a dataset must satisfy: no stray file; code tables, camera and models as the configuration gives."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from scenes.scene import Mesh
from studies.dataset.check.draw import Pool, difference
from studies.dataset.config import DatasetConfig
from studies.dataset.format.folders import (
    CAMERA,
    CARD,
    DATASET,
    INDEX,
    MODELS,
    SPLIT,
    WORK,
    bounded_bytes,
    read_json,
    scene_name,
)  # fmt: skip
from studies.dataset.make import bop
from studies.dataset.make.manifest import head, measured_names

SIZES_MM = (5.0, 1000.0)
"""Sides of objects that can be in millimetres [mm]: a screw to what a table holds."""
INFO_ERROR_MM = 1e-3
"""Of sizes that follow from corners written to five digits [mm]."""
SMALLEST_VERTEX = 6
"""Bytes of the shortest line of a vertex, `0 0 0` and its end: a file cannot hold more vertices than that allows."""


def stray_problems(root: Path, top: dict[str, Any], config: DatasetConfig) -> Iterator[str]:
    """What does not belong into the top folders, and what is missing there."""
    known = {DATASET, INDEX, CARD, CAMERA, MODELS, SPLIT}
    models = {model_name(int(entry["obj_id"])) for entry in top["objects"]} | {"models_info.json"}
    scenes = {scene_name(number) for number in range(config.scenes)}
    for folder, expected in ((root, known), (root / MODELS, models), (root / SPLIT, scenes)):
        if folder.is_symlink() or not folder.is_dir():
            yield f"{folder.name}: is no folder"
            continue
        there = sorted(folder.iterdir())
        for path in there:
            name = path.relative_to(root).as_posix()
            if path.name == WORK:
                yield f"{WORK}: the dataset is unfinished; give the `make` command again"
            elif path.name not in expected:
                yield f"{name}: stray"
            elif path.is_symlink():
                yield f"{name}: is a link"
        if folder.name != SPLIT:
            missing = sorted(expected - {path.name for path in there})
            yield from (f"{(folder / name).relative_to(root).as_posix()}: is missing" for name in missing)


def table_problems(top: dict[str, Any], config: DatasetConfig, pool: Pool | None) -> Iterator[str]:
    """`dataset.json` says of codes, materials, layers and objects what this configuration gives."""
    # Files that the dataset was made of are elsewhere, under whatever name: their hashes are taken as they are stated.
    measured = {name: str(top["measured"][name]) for name in measured_names(config)}
    wanted = head(config, pool or (), measured)
    for key in wanted:
        if (pool is not None or key != "objects") and (what := difference(top.get(key), wanted[key], key)):
            yield f"{DATASET}: {what}"


def camera_problems(root: Path, config: DatasetConfig) -> Iterator[str]:
    """`camera.json` is of a stream profile that is drawn, in pixels and millimetres."""
    drawn = [config.camera.rig(name).intrinsics for name, weight in config.camera.profiles.items() if weight]
    if read_json(root / CAMERA) not in [bop.camera_file(k) for k in drawn]:
        yield f"{CAMERA}: is not of a stream profile that is drawn"


def model_problems(root: Path, top: dict[str, Any], pool: Pool | None) -> Iterator[str]:
    """Models are those of the pool, and `models_info.json` says how large they are [mm]."""
    stated = read_json(root / MODELS / "models_info.json")
    numbers = [int(entry["obj_id"]) for entry in top["objects"]]
    if list(stated) != [str(number) for number in numbers]:
        yield f"{MODELS}/models_info.json: does not have one entry for each object"
        return
    made = {thing.number: thing for thing in pool or ()}
    for number in numbers:
        name = f"{MODELS}/{model_name(number)}"
        data = bounded_bytes(root / name)
        mesh = made[number].mesh if number in made else Mesh(ply_points(data) / 1000, np.zeros((0, 3), int))
        if number in made and data != bop.model_ply(mesh):
            yield f"{name}: is not the object's model"
        info = bop.model_info(mesh)
        if info.keys() != stated[str(number)].keys():
            yield f"{MODELS}/models_info.json: object {number} has other entries than {', '.join(info)}"
        elif max(abs(stated[str(number)][key] - value) for key, value in info.items()) > INFO_ERROR_MM:
            yield f"{name}: is not as large as models_info.json says"
        longest = max(info[f"size_{axis}"] for axis in "xyz")
        if not SIZES_MM[0] <= longest <= SIZES_MM[1]:
            yield f"{name}: is {longest:.3g} mm long; models are in millimetres"


def ply_points(data: bytes) -> np.ndarray:
    """Vertices of an ASCII PLY of ours, (n, 3); ValueError if it is none, or says that it has more than it can hold."""
    head, _, body = data.partition(b"end_header\n")
    counts = [line.split()[2] for line in head.splitlines() if line.startswith(b"element vertex ")]
    if len(counts) != 1 or len(counts[0]) > 9 or not 4 <= int(counts[0]) <= len(body) // SMALLEST_VERTEX:
        raise ValueError("a model is no PLY file of ours")
    count = int(counts[0])
    return np.array([line.split()[:3] for line in body.split(b"\n", count)[:count]], float)


def model_name(number: int) -> str:
    """File of an object's model."""
    return f"obj_{number:06d}.ply"
