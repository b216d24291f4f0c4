"""Time of the ray-cast entropy baseline at the paper's parameters, beside PB's, Dr.Jit's and that of the plain loop it
is checked against: all on the same map, on one thread."""

import time

import numpy as np
import pytest

from franbv.candidates import candidate_poses, first_view
from franbv.geometry.ray_packets import ray_sum
from franbv.model import Model
from franbv.object_model import object_model
from franbv.parameters import Parameters
from franbv.planners import pb, ray_entropy
from franbv.stage_clock import StageClock
from franbv.volumetric_information import view_information, view_rays, voxel_cells
from franbv.voxel_map import empty_map
from render.world import backend
from studies.comparison.planning_speed import PB_GOAL_S
from tests.benchmarks.drjit_rays import DrJitRays
from tests.franbv.analytic_camera import SENSOR, AnalyticCamera
from tests.franbv.plain_information import plain_information

PARAMETERS = Parameters()
BOX = ((-0.05, -0.04, 0.0), (0.05, 0.04, 0.07))
AZIMUTH = 0.3
"""Turn of the candidates [rad]: in a view along the grid's axes rays lie in its planes, on no side of them."""
PLAIN_VIEWS = 2
"""Views that the plain loop is timed on; it takes as long for each."""


DRJIT_REPEATS = 15
"""Times that both loops are run in turn, so that what else the machine does slows both."""


@pytest.fixture(scope="module")
def scene():
    """A box that has been seen twice: its map, the third burst."""
    camera = AnalyticCamera((BOX,))
    voxel_map = empty_map(PARAMETERS)
    for azimuth in (0.0, 120.0):
        voxel_map = pb().integrate(voxel_map, camera.capture(first_view(PARAMETERS, azimuth), 15), PARAMETERS)
    return voxel_map, camera.capture(first_view(PARAMETERS, 240.0), 15)


@pytest.mark.benchmark
def test_ray_cast_entropy(stopwatch, scene):
    """A box's third burst enters the map, 32 views are scored: RE and PB, and RE by the plain loop."""
    (voxel_map, burst), clock = scene, StageClock()

    def decision(planner):
        with clock.planning("decision"):
            grid = planner.integrate(voxel_map, burst, PARAMETERS)
            estimate = object_model(grid, PARAMETERS)
            now = Model(grid, estimate, planner.approximate(estimate, PARAMETERS, np.random.SeedSequence(0)))
            poses = candidate_poses(estimate.box, PARAMETERS, AZIMUTH)
            return grid, poses, planner.score(now, SENSOR, poses, PARAMETERS)

    stopwatch.time("RE decision", lambda: decision(ray_entropy()), n=15)
    stopwatch.time(
        "RE decision, untouched voxels of the object's box", lambda: decision(ray_entropy("unobserved", True)), n=15
    )
    stopwatch.time("PB decision", lambda: decision(pb()), n=15, goal=PB_GOAL_S)

    grid, poses, utilities = decision(ray_entropy())
    fast = stopwatch.time("RE, rays of 32 views", lambda: view_information(grid, SENSOR, poses), n=15)
    start = time.process_time()
    plain = [plain_information(grid, SENSOR, pose, "occlusion_aware") for pose in poses[:PLAIN_VIEWS]]
    plain_s = (time.process_time() - start) / PLAIN_VIEWS
    np.testing.assert_allclose(utilities[:PLAIN_VIEWS], plain, rtol=1e-6)
    fast_s = float(np.median(fast.cpu_seconds)) / len(poses)
    stopwatch.note(
        f"RE, rays of one view, processor time: plain Python {1e3 * plain_s:.0f} ms, compiled {1e3 * fast_s:.2f} ms, "
        f"{plain_s / fast_s:.0f} times faster"
    )


@pytest.mark.benchmark
def test_rays_beside_drjit(stopwatch, scene):
    """The rays of 32 views through the same cells, in turn: our loop and Dr.Jit's, which must find the same."""
    threads = backend.thread_count()
    backend.thread_count(1)
    voxel_map, burst = scene
    grid = pb().integrate(voxel_map, burst, PARAMETERS)
    poses = candidate_poses(object_model(grid, PARAMETERS).box, PARAMETERS, AZIMUTH)
    cells = voxel_cells(grid.log_odds, "occlusion_aware")

    def view_sums():
        return np.array([ray_sum(cells, *pose, columns, rows, False) for pose in zip(origins, axes, strict=True)])

    origins, axes, columns, rows = view_rays(grid, SENSOR, poses)
    try:
        for precision, tolerance in (("double", 1e-12), ("single", 1e-4)):
            drjit = DrJitRays(cells, origins, axes, columns, rows, precision)
            ours, theirs, seconds = None, None, {"numba": [], "Dr.Jit": []}
            for _ in range(DRJIT_REPEATS + 1):  # the first one compiles
                start = time.process_time()
                ours = np.array(
                    [ray_sum(cells, *pose, columns, rows, False) for pose in zip(origins, axes, strict=True)]
                )
                middle = time.process_time()
                theirs = drjit.sums()
                seconds["numba"].append(middle - start)
                seconds["Dr.Jit"].append(time.process_time() - middle)
            numba_s, drjit_s = (np.median(times[1:]) for times in seconds.values())
            np.testing.assert_allclose(theirs, ours, rtol=tolerance)
            difference = np.max(np.abs(theirs / ours - 1.0))
            stopwatch.note(
                f"RE, rays of 32 views through ready cells, processor time: numba {1e3 * numba_s:.1f} ms, Dr.Jit in "
                f"{precision} precision {1e3 * drjit_s:.1f} ms ({drjit_s / numba_s:.2f} of it; relative difference "
                f"{difference:.0e}, allowed 1e-6)"
            )
    finally:
        backend.thread_count(threads)
