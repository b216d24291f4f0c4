"""What a scene's folder holds, and whether one that is there holds it: names, sizes, and hashes of its texts.

Images are not hashed here: `make` looks at every scene each time it is called, `check` hashes all of them.
"""

from pathlib import Path
from typing import Any

from studies.base.atomic_file import file_digest
from studies.dataset.config import DatasetConfig
from studies.dataset.format.folders import MANIFEST, SCENE, STATISTICS, read_json
from studies.dataset.format.layers import FRAMES, MASKS
from studies.dataset.format.layers import layers as layers_of

TEXTS = ("scene_camera.json", "scene_gt.json", "scene_gt_info.json", "scene_gt_coco.json", SCENE, STATISTICS)
"""Beside the images and the manifest."""
OF_ANOTHER = "is a scene of another dataset"
"""The one fault that is not mended by making the scene again."""


def scene_files(config: DatasetConfig, n_views: int, n_objects: int) -> set[str]:
    """Names in a scene's folder, without its manifest."""
    names = {f"{layer.folder}/{view:06d}.png" for layer in layers_of(config.n_frames) for view in range(n_views)}
    numbered = dict.fromkeys(MASKS, n_objects) | ({FRAMES.folder: config.n_frames} if config.keep_frames else {})
    for folder, count in numbered.items():
        names |= {f"{folder}/{view:06d}_{place:06d}.png" for view in range(n_views) for place in range(count)}
    return names | set(TEXTS)


def belongs_to(folder: Path, digest: str) -> bool:
    """Whether a scene's manifest says that it belongs to the dataset of this configuration."""
    try:
        return read_json(folder / MANIFEST)["dataset"] == digest
    except (OSError, ValueError, KeyError, TypeError):
        return False


def scene_fault(folder: Path, config: DatasetConfig, digest: str, number: int) -> str | None:
    """What keeps a scene that is there from being taken as it is; None if nothing does.

    digest: of the dataset's configuration. Files that do not belong there are nobody's fault here.
    """
    try:
        return _fault(folder, read_json(folder / MANIFEST), config, digest, number)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return f"{MANIFEST} cannot be read"


def _fault(folder: Path, manifest: dict[str, Any], config: DatasetConfig, digest: str, number: int) -> str | None:
    views = config.views_of(number)
    if folder.is_symlink():
        return "is a link"
    if not isinstance(manifest["renderer"], str) or not isinstance(manifest["versions"], dict):
        raise ValueError("does not say what made it")
    if (manifest["dataset"], manifest["scene"], manifest["views"]) != (digest, number, views):
        return OF_ANOTHER
    listed = manifest["files"]
    texts_first = sorted({*TEXTS, *listed}, key=lambda name: (name not in TEXTS, name))
    for name in texts_first:
        if what := _change(folder / name, *listed.get(name, (0, ""))):
            return f"{name} {what}"
    lacking = scene_files(config, views, len(read_json(folder / SCENE)["draw"]["objects"])) - listed.keys()
    return f"{min(lacking)} is missing" if lacking else None


def _change(path: Path, size: int, digest: str) -> str | None:
    if path.is_symlink() or not path.is_file():
        return "is missing"
    changed = path.stat().st_size != size or (path.name in TEXTS and file_digest(path) != digest)
    return "was changed" if changed else None
