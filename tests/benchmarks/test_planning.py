"""Time of one planning decision at the paper's parameters: map update, object, clustering, 32 candidates."""

import numpy as np
import pytest

from franbv.candidates import candidate_poses, first_view
from franbv.model import Model
from franbv.object_model import object_model
from franbv.parameters import Parameters
from franbv.planners import fra
from franbv.stage_clock import StageClock
from franbv.voxel_map import empty_map
from tests.franbv.analytic_camera import AnalyticCamera

PARAMETERS = Parameters()
BOX = ((-0.05, -0.04, 0.0), (0.05, 0.04, 0.07))
DECISION_GOAL = 0.15
"""One PB or FRA decision on two idle cores [s]."""


@pytest.mark.benchmark
def test_decision(stopwatch):
    """A box's third burst enters the map, the model is refitted, the views are scored; FRA also looks for regions."""
    camera, planner, clock = AnalyticCamera((BOX,)), fra(), StageClock()
    assert planner.recovery is not None
    detect = planner.recovery.detect
    voxel_map = empty_map(PARAMETERS)
    for azimuth in (0.0, 120.0):
        voxel_map = planner.integrate(voxel_map, camera.capture(first_view(PARAMETERS, azimuth), 15), PARAMETERS)
    burst = camera.capture(first_view(PARAMETERS, 240.0), 15)

    def updated():
        return planner.integrate(voxel_map, burst, PARAMETERS)

    def model():
        grid = updated()
        estimate = object_model(grid, PARAMETERS)
        return Model(grid, estimate, planner.approximate(estimate, PARAMETERS, np.random.SeedSequence(0)))

    def decision():
        with clock.planning("decision"):
            now = model()
            poses = candidate_poses(now.object.box, PARAMETERS, 0.0)
            return now, planner.score(now, camera.intrinsics, poses, PARAMETERS)

    def decision_with_detection():
        now, _ = decision()
        with clock.planning("detection"):
            return detect(burst, now, PARAMETERS)

    stopwatch.time("voxel map update, 2400 rays", updated, n=15)
    stopwatch.time("PB decision", decision, n=15, goal=DECISION_GOAL)
    stopwatch.time("FRA decision with detection", decision_with_detection, n=15, goal=DECISION_GOAL)
