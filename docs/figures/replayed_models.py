"""The models that fra-robust had in a finished run: its stored bursts put into the map again."""

from collections.abc import Iterator

import numpy as np

from franbv.known_planners import PLANNERS
from franbv.model import Model, model_of, model_with
from franbv.parameters import Parameters
from franbv.sensing import DepthBurst
from franbv.voxel_map import empty_map
from studies.run.stored_run import StoredRun


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
