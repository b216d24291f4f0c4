"""What stands at the top of a dataset: its configuration, its code tables, the camera, the models."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

from materials.input_error import InputError
from materials.user_entries import UserMeasured
from render.labels.causes import LEGEND, Cause
from studies.base.atomic_file import file_digest, write_atomically
from studies.base.case_folder import canonical_json, case_digest
from studies.dataset.config import DatasetConfig, with_files
from studies.dataset.draw.built_scene import material_classes
from studies.dataset.draw.objects import PoolObject
from studies.dataset.format.folders import CAMERA, DATASET, MODELS, compact_json, read_json
from studies.dataset.format.layers import MASKS
from studies.dataset.format.layers import layers as layers_of
from studies.dataset.make import bop

DATASET_COMMAND = "dataset"
"""What the hash of a dataset's configuration calls it."""


def recorded(config: DatasetConfig) -> DatasetConfig:
    """The configuration as the dataset keeps it: CAD and BSDF files by name."""
    cad = tuple(entry.model_copy(update={"file": Path(entry.file.name)}) for entry in config.objects.cad)
    user = {
        name: entry.model_copy(update={"file": Path(entry.file.name)}) if isinstance(entry, UserMeasured) else entry
        for name, entry in config.materials.user.items()
    }
    return with_files(config, cad, user)


def dataset_digest(config: DatasetConfig) -> str:
    """Name of the configuration; scenes say which one they are of."""
    return case_digest(DATASET_COMMAND, recorded(config))


def measured_names(config: DatasetConfig) -> list[str]:
    """The materials that are BSDF files."""
    return [name for name, entry in config.materials.user.items() if isinstance(entry, UserMeasured)]


def measured_digests(config: DatasetConfig) -> dict[str, str]:
    """Hash of every BSDF file, by the material's name."""
    user = config.materials.user
    return {name: file_digest(cast(UserMeasured, user[name]).file) for name in measured_names(config)}


def input_files(name: str, config: DatasetConfig) -> list[Path]:
    """The files that a loaded configuration was read from and that scenes are made of. name: as it was loaded by."""
    own = [] if name == "default" else [Path(name)]
    measured = [entry.file for entry in config.materials.user.values() if isinstance(entry, UserMeasured)]
    return [*own, *(cad.file for cad in config.objects.cad), *measured]


def input_digests(config: DatasetConfig, pool: Sequence[PoolObject]) -> dict[str, str]:
    """Hashes of the CAD and BSDF files that scenes are made of, by file name."""
    cad = {str(thing.name): thing.digest for thing in pool if thing.digest}
    user, measured = config.materials.user, measured_digests(config)
    return cad | {cast(UserMeasured, user[name]).file.name: digest for name, digest in measured.items()}


def head(config: DatasetConfig, pool: Sequence[PoolObject], measured: dict[str, str]) -> dict[str, Any]:
    """`dataset.json`. measured: `measured_digests`."""
    return {
        "title": config.title,
        "digest": dataset_digest(config),
        "config": recorded(config).model_dump(mode="json"),
        "objects": [{"obj_id": o.number, "name": o.name, "blake2b": o.digest} for o in pool],
        "measured": measured,
        "materials": list(material_classes(config.materials.of_user)),
        "causes": {str(int(cause)): LEGEND[cause].name for cause in Cause if cause is not Cause.UNMEASURED},
        "layers": {layer.folder: layer.meaning for layer in layers_of(config.n_frames)},
        "masks": list(MASKS),
    }


def write_head(root: Path, config: DatasetConfig, pool: Sequence[PoolObject]) -> None:
    """Write what of it is missing or was changed; `dataset.json` stays as it is."""
    path = root / DATASET
    files = {f"{MODELS}/obj_{o.number:06d}.ply": bop.model_ply(o.mesh) for o in pool}
    files[f"{MODELS}/models_info.json"] = compact_json({o.number: bop.model_info(o.mesh) for o in pool})
    profiles = sorted(name for name, weight in config.camera.profiles.items() if weight)
    k = config.camera.rig(profiles[0]).intrinsics
    files[CAMERA] = compact_json(bop.camera_file(k))
    (root / MODELS).mkdir(exist_ok=True)
    for name, data in files.items():
        if not (root / name).is_file() or (root / name).read_bytes() != data:
            write_atomically(root / name, data)
    if not path.exists():  # last: a folder with it has the rest
        write_atomically(path, compact_json(head(config, pool, measured_digests(config))))


def check_same(root: Path, config: DatasetConfig, pool: Sequence[PoolObject]) -> None:
    """InputError where the folder holds another dataset; the order of a configuration's keys does not matter."""
    wanted, path = head(config, pool, measured_digests(config)), root / DATASET
    if not path.exists():
        return
    try:
        top = read_json(path)
        before, differing = DatasetConfig.model_validate(top["config"]), [k for k in wanted if top.get(k) != wanted[k]]
    except (ValueError, KeyError, TypeError, AttributeError):
        raise InputError(f"{path}: cannot be read; choose another folder, or remove this one") from None
    if canonical_json(before) == canonical_json(recorded(config)):
        if not differing or differing == ["config"]:
            return
        raise InputError(
            f"{path}: was begun by another version, or with other CAD or BSDF files (`{differing[0]}` differs); choose "
            "another folder"
        )
    old, new = before.model_dump(mode="json"), recorded(config).model_dump(mode="json")
    key = next(name for name in new if old.get(name) != new[name])
    raise InputError(f"{path}: holds another dataset (`{key}` differs); choose another folder, or the same settings")
