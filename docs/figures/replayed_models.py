"""A finished run again: its camera, and the models that fra-robust had, its stored bursts put into the map."""

from collections.abc import Iterator

import numpy as np

from franbv.known_planners import PLANNERS
from franbv.model import Model, model_of, model_with
from franbv.parameters import Parameters
from franbv.sensing import DepthBurst
from franbv.voxel_map import empty_map
from materials.input_error import InputError
from render.d435i import SimulatedD435i
from studies.run.scene_settings import SubjectSettings, build_subject
from studies.run.stored_run import StoredRun


def camera_of(stored: StoredRun, preset: str | None = None) -> SimulatedD435i:
    """The camera of a simulated run before its scene, or another preset of it."""
    config = stored.run["config"]
    if "part" not in config:
        raise InputError(f"{stored.folder}: is no simulated run; give the --out folder of `franbv reconstruct`")
    subject = SubjectSettings.model_validate(
        {name: config[name] for name in SubjectSettings.model_fields if name in config}
    )
    sensor = subject.sensor if preset is None else subject.sensor.model_copy(update={"preset": preset})
    return SimulatedD435i(build_subject(subject).scene, sensor, subject.seed)


def robust_models(stored: StoredRun, parameters: Parameters) -> Iterator[tuple[DepthBurst, Model]]:
    """Each burst, and the model that holds it and those before."""
    planner, seed = PLANNERS["fra-robust"].build(), np.random.SeedSequence(0)
    model = model_of(empty_map(parameters), planner, parameters, seed)
    for number in range(len(stored.rows)):
        view, depths = stored.view(number), stored.depths(number)
        assert depths is not None
        burst = DepthBurst(depths, view.intrinsics, view.pose)
        model = model_with(model.voxel_map, burst, planner, parameters, seed)
        yield burst, model
