"""The index of a dataset: scenes and their manifests' hashes. Derived from the folders, so never trusted."""

import hashlib
from pathlib import Path
from typing import Any

from studies.base.atomic_file import DIGEST_BYTES, write_atomically
from studies.dataset.format.folders import CAMERA, DATASET, INDEX, MANIFEST, MODELS, SPLIT, bounded_bytes, compact_json


def derived_index(root: Path, scenes: list[str]) -> bytes:
    """What the index of these scenes must be."""
    heads = [DATASET, CAMERA, *sorted(f"{MODELS}/{path.name}" for path in (root / MODELS).glob("*"))]
    entries: dict[str, Any] = {name: digest(bounded_bytes(root / name)) for name in heads}
    for scene in scenes:
        entries[f"{SPLIT}/{scene}/{MANIFEST}"] = digest(bounded_bytes(root / SPLIT / scene / MANIFEST))
    return compact_json(entries)


def write_index(root: Path, scenes: list[str]) -> None:
    """(Re)build the index."""
    write_atomically(root / INDEX, derived_index(root, scenes))


def scene_folders(root: Path) -> list[str]:
    """Names of the scenes that are there."""
    return sorted(path.name for path in (root / SPLIT).glob("[0-9]*") if path.is_dir())


def digest(data: bytes) -> str:
    """blake2b, as the manifests use it."""
    return hashlib.blake2b(data, digest_size=DIGEST_BYTES).hexdigest()
