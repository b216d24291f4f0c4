"""How long PB and RE plan, against the number of voxels, of candidates and of pixels, on the maps of one real run.

The first acquisitions of a finished run are put into maps of finer and finer voxels; then one more enters and the
candidates are scored. Each stage is timed by itself, in processor time of one thread, so that it is seen where a method
spends its time.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from franbv.candidates import candidate_poses
from franbv.frames import Intrinsics
from franbv.object_model import object_model
from franbv.parameters import Parameters
from franbv.planners import Model, Planner, integrate_median, pb, re
from franbv.sensing import DepthBurst
from franbv.stage_clock import StageClock
from franbv.voxel_map import VoxelMap, empty_map
from studies.captures import stored_depths
from studies.cases import write_atomically
from studies.console import strict_json
from studies.stored_run import StoredRun

SPEED = "planning_speed.json"
"""File of the measurement in the study's folder."""
SPEED_JOB = "planning speed"
"""Name of the job that measures."""
EDGES = (64, 96, 128, 192, 256)
"""Voxels: as many as a cube of this edge has."""
CANDIDATES = (32, 128, 512, 2048)
IMAGES = ((60, 40), (160, 90), (320, 180), (640, 360))
"""Pixels: from the paper's sensor to the whole stream."""
CLOSED = (360, 240)
"""Pixels of the depth images that fill maps of small voxels, so that surfaces in them are closed (choice: finer than
the smallest voxel where the part is)."""
N_VIEWS = 3
"""Acquisitions in the map, the last of which is timed (choice: the object has been seen, much is still unknown)."""
REPEATS = 3
"""Times each decision is made; the median counts."""
MOST_REPEATED_S = 1.0
"""Decisions are repeated until they have taken this long together [s]."""
AZIMUTH = 0.3
"""Turn of the candidates [rad]; any that is not along the grid's axes."""

PLANNERS: dict[str, Callable[[], Planner]] = {"pb": pb, "re": re}


@dataclass(frozen=True)
class SpeedTask:
    """What a worker is given."""

    out: Path
    case: Path
    """A finished run."""
    parameters: Parameters


def measure_speed(task: SpeedTask) -> None:
    """Time all decisions and write them to `SPEED`."""
    rows = [
        {"axis": axis, "size": size, "planner": name, **stages}
        for axis, size, grid, burst, parameters in _settings(task)
        for name, planner in PLANNERS.items()
        for stages in [median_decision(planner(), grid, burst, parameters)]
    ]
    write_atomically(task.out / SPEED, strict_json({"run": task.case.name, "rows": rows}, indent=1).encode())


def _settings(task: SpeedTask) -> Iterator[tuple[str, int, VoxelMap, DepthBurst, Parameters]]:
    """Axis, size on it, map before the decision, burst, parameters."""
    *before, burst = stored_bursts(task.case, N_VIEWS)
    closed = [resampled(earlier, *CLOSED) for earlier in before]
    for edge in EDGES:
        parameters = with_voxels(task.parameters, edge)
        yield "voxels", edge, filled_map(closed, parameters), burst, parameters
    grid = filled_map(before, task.parameters)
    for count in CANDIDATES:
        yield "candidates", count, grid, burst, task.parameters.model_copy(update={"n_candidates": count})
    for width, height in IMAGES:
        yield "pixels", width, grid, resampled(burst, width, height), task.parameters


def with_voxels(parameters: Parameters, edge: int) -> Parameters:
    """The same workspace in about edge^3 voxels."""
    volume = float(np.prod(np.subtract(parameters.workspace_max, parameters.workspace_min)))
    return parameters.model_copy(update={"voxel_size": volume ** (1 / 3) / edge})


def resampled(burst: DepthBurst, width: int, height: int) -> DepthBurst:
    """The burst as a sensor of so many pixels with the same field of view gives it: each takes the nearest depth."""
    k = burst.intrinsics
    x, y = width / k.width, height / k.height
    columns, rows = ((np.arange(n) + 0.5) // scale for n, scale in ((width, x), (height, y)))
    depths = burst.depths[:, rows.astype(int)][:, :, columns.astype(int)]
    finer = Intrinsics(width, height, k.fx * x, k.fy * y, (k.cx + 0.5) * x - 0.5, (k.cy + 0.5) * y - 0.5)
    return replace(burst, depths=depths, intrinsics=finer)


def stored_bursts(case: Path, count: int) -> list[DepthBurst]:
    """The first bursts of a finished run."""
    views = [StoredRun(case).view(k) for k in range(count)]
    return [DepthBurst(stored_depths(case, k), view.intrinsics, view.pose) for k, view in enumerate(views)]


def filled_map(bursts: Sequence[DepthBurst], parameters: Parameters) -> VoxelMap:
    """The map with these bursts in it, which is the same for all planners."""
    grid = empty_map(parameters)
    for burst in bursts:
        grid = integrate_median(grid, burst, parameters)
    return grid


def median_decision(planner: Planner, grid: VoxelMap, burst: DepthBurst, parameters: Parameters) -> dict[str, Any]:
    """Median seconds of each stage of a decision with this burst, and how much there was to decide on."""
    timed: list[dict[str, float]] = []
    sizes: dict[str, int] = {}
    while len(timed) < REPEATS and sum(map(_total, timed)) < MOST_REPEATED_S:
        stages, sizes = _decision(planner, grid, burst, parameters)
        timed.append(stages)
    return {**{stage: float(np.median([row[stage] for row in timed])) for stage in timed[0]}, **sizes}


def _decision(
    planner: Planner, grid: VoxelMap, burst: DepthBurst, parameters: Parameters
) -> tuple[dict[str, float], dict[str, int]]:
    clock = StageClock()
    with clock.planning("map"):
        grid = planner.integrate(grid, burst, parameters)
    with clock.planning("object"):
        estimate = object_model(grid, parameters)
    with clock.planning("ellipsoids"):
        ellipsoids = planner.approximate(estimate, parameters, np.random.SeedSequence(0))
    with clock.planning("candidates"):
        poses = candidate_poses(estimate.box, parameters, AZIMUTH)
    with clock.planning("score"):
        planner.score(Model(grid, estimate, ellipsoids), burst.intrinsics, poses, parameters)
    sizes = {
        "map_voxels": int(grid.log_odds.size),
        "object_voxels": len(estimate.occupied) + len(estimate.frontier),
        "poses": len(poses),
        "rays": burst.intrinsics.width * burst.intrinsics.height,
    }
    return clock.read(), sizes


def _total(stages: dict[str, float]) -> float:
    return sum(stages.values())
