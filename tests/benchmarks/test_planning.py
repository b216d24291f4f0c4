"""Time of one planning decision at the paper's parameters: map update, object, clustering, 32 candidates."""

import numpy as np
import pytest

from franbv.candidates import candidate_poses, first_view
from franbv.model import Model, model_of
from franbv.object_model import object_model
from franbv.parameters import Parameters
from franbv.planners import fra
from franbv.robust.planner import fra_robust
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


@pytest.mark.benchmark
def test_robust_decision(stopwatch):
    """fra-robust weighs all bursts anew: the same for the third and for the twentieth of the box."""
    camera, planner = AnalyticCamera((BOX,)), fra_robust()
    assert planner.detect is not None
    detect, voxel_map = planner.detect, empty_map(PARAMETERS)
    bursts = [camera.capture(first_view(PARAMETERS, 54.0 * k), 15) for k in range(20)]
    for number, burst in enumerate(bursts, start=1):
        before = voxel_map
        voxel_map = planner.integrate(voxel_map, burst, PARAMETERS)
        if number not in (3, 20):
            continue

        def updated(before=before, burst=burst):
            return planner.integrate(before, burst, PARAMETERS)

        def choice(grid=voxel_map):
            now = model_of(grid, planner, PARAMETERS, np.random.SeedSequence(0))
            poses = planner.candidates(now, PARAMETERS, 0.0)
            return planner.score(now, camera.intrinsics, poses, PARAMETERS)

        now = model_of(voxel_map, planner, PARAMETERS, np.random.SeedSequence(0))
        stopwatch.time(f"fra-robust map update, burst {number}", updated, n=15)
        stopwatch.time(f"fra-robust choice of a view, burst {number}", choice, n=15, goal=DECISION_GOAL)
        stopwatch.time(
            f"fra-robust detection, burst {number}",
            lambda now=now, burst=burst: detect(burst, now, PARAMETERS, camera.min_z),
            n=15,
        )
