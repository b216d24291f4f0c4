"""The matte twins of a study's looks: measured once, kept on disk, shared by all materials."""

from pathlib import Path

import numpy as np
from jaxtyping import Bool

from render.labels.outcome import Outcome
from render.labels.twin import MatteTwin, measure_twin
from studies.base.case_folder import finished_case, writing
from studies.sensitivity.cases import SceneOf, TwinConfig, look_camera, look_pose, look_scene
from studies.store.views import read_arrays, write_arrays

OUTCOME_MAPS = ("invalid", "is_false", "invalid_decimated", "false_decimated")
OWN_MAPS = ("lost_to_shadow", "lost_to_exposure")
"""Maps of a twin: those of its outcome, and its own."""
TWIN_FILE = "twin.npz"


def make_twin(folder: Path, config: TwinConfig, scene_of: SceneOf = look_scene) -> None:
    """Measure the twin and write its case below `folder`."""
    scene = scene_of(config, config.material, config.light)
    camera = look_camera(config, scene, config.light)
    with writing(folder, config.digest) as case:
        write_twin(case / TWIN_FILE, measure_twin(camera, look_pose(config, scene), config.n_frames))


def stored_twin(folder: Path, config: TwinConfig, scene_of: SceneOf = look_scene) -> MatteTwin:
    """The twin below `folder`; measured now if it is not there yet."""
    if finished_case(folder, config.digest) is None:
        make_twin(folder, config, scene_of)
    return read_twin(folder / config.digest / TWIN_FILE)


def write_twin(path: Path, twin: MatteTwin) -> None:
    """Eight pixels a byte."""
    maps = {name: getattr(twin.outcome, name) for name in OUTCOME_MAPS} | {
        name: getattr(twin, name) for name in OWN_MAPS
    }
    packed = {name: np.packbits(image) for name, image in maps.items()}
    shapes = {f"{name}_shape": np.array(image.shape) for name, image in maps.items()}
    write_arrays(path, {**packed, **shapes, "n_frames": np.array(twin.n_frames)})


def read_twin(path: Path) -> MatteTwin:
    """The twin as it was written."""
    arrays = read_arrays(path)
    maps = {name: _image(arrays, name) for name in (*OUTCOME_MAPS, *OWN_MAPS)}
    outcome = Outcome(*(maps[name] for name in OUTCOME_MAPS))
    return MatteTwin(outcome, maps["lost_to_shadow"], maps["lost_to_exposure"], int(arrays["n_frames"]))


def _image(arrays: dict[str, np.ndarray], name: str) -> Bool[np.ndarray, "h w"]:
    h, w = arrays[f"{name}_shape"]
    return np.unpackbits(arrays[name], count=h * w).astype(bool).reshape(h, w)
