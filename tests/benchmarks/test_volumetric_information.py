"""Time of the ray-cast entropy baseline at the paper's parameters, beside PB's and that of the plain loop it is checked
against: all on the same map, on one thread."""

import time

import numpy as np
import pytest

from franbv.candidates import candidate_poses, first_view
from franbv.object_model import object_model
from franbv.parameters import Parameters
from franbv.planners import Model, pb, re
from franbv.stage_clock import StageClock
from franbv.volumetric_information import view_information
from franbv.voxel_map import empty_map
from studies.plain_information import plain_information
from tests.franbv.analytic_camera import SENSOR, AnalyticCamera

PARAMETERS = Parameters()
BOX = ((-0.05, -0.04, 0.0), (0.05, 0.04, 0.07))
PB_GOAL = 0.10
"""One PB decision [s]."""
AZIMUTH = 0.3
"""Turn of the candidates [rad]: in a view along the grid's axes rays lie in its planes, on no side of them."""
PLAIN_VIEWS = 2
"""Views that the plain loop is timed on; it takes as long for each."""


@pytest.mark.benchmark
def test_ray_cast_entropy(stopwatch):
    """A box's third burst enters the map, 32 views are scored: RE and PB, and RE by the plain loop."""
    camera, clock = AnalyticCamera((BOX,)), StageClock()
    voxel_map = empty_map(PARAMETERS)
    for azimuth in (0.0, 120.0):
        voxel_map = pb().integrate(voxel_map, camera.capture(first_view(PARAMETERS, azimuth), 15), PARAMETERS)
    burst = camera.capture(first_view(PARAMETERS, 240.0), 15)

    def decision(planner):
        with clock.planning("decision"):
            grid = planner.integrate(voxel_map, burst, PARAMETERS)
            estimate = object_model(grid, PARAMETERS)
            now = Model(grid, estimate, planner.approximate(estimate, PARAMETERS, np.random.SeedSequence(0)))
            poses = candidate_poses(estimate.box, PARAMETERS, AZIMUTH)
            return grid, poses, planner.score(now, SENSOR, poses, PARAMETERS)

    stopwatch.time("RE decision", lambda: decision(re()), n=15)
    stopwatch.time("RE decision, untouched voxels of the object's box", lambda: decision(re("unobserved", True)), n=15)
    stopwatch.time("PB decision", lambda: decision(pb()), n=15, goal=PB_GOAL)

    grid, poses, utilities = decision(re())
    fast = stopwatch.time("RE, rays of 32 views", lambda: view_information(grid, SENSOR, poses), n=15)
    start = time.perf_counter()
    plain = [plain_information(grid, SENSOR, pose, "occlusion_aware") for pose in poses[:PLAIN_VIEWS]]
    seconds = (time.perf_counter() - start) / PLAIN_VIEWS
    np.testing.assert_allclose(utilities[:PLAIN_VIEWS], plain, rtol=1e-6)
    stopwatch.note(
        f"RE, rays of one view: plain Python {1e3 * seconds:.0f} ms, compiled {1e3 * fast.median / len(poses):.2f} ms, "
        f"{seconds * len(poses) / fast.median:.0f} times faster (goal 50)"
    )
