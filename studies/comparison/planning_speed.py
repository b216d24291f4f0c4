"""How long PB and RE plan, against the number of voxels, of candidates and of pixels, on the maps of one real run.

The first acquisitions of a finished run are put into maps of finer and finer voxels; then one more enters and the
candidates are scored. Each stage is timed by itself, in processor time of one thread, so that it is seen where a method
spends its time.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from franbv.candidates import candidate_poses
from franbv.frames import Intrinsics
from franbv.model import model_with
from franbv.parameters import Parameters
from franbv.planners import Planner, integrate_burst, pb, ray_entropy
from franbv.sensing import DepthBurst
from franbv.stage_clock import StageClock
from franbv.voxel_map import VoxelMap, empty_map
from studies.base.atomic_file import write_atomically
from studies.base.console import strict_json
from studies.run.bursts import stored_depths
from studies.run.stored_run import StoredRun
from studies.work.machine import machine

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
FEWEST_DECISIONS, MOST = 3, 30
"""Times each decision is made; the median counts."""
REPEATED_S = 1.0
"""Decisions are repeated at least until they have taken this long together [s] (choice: what another process takes from
the caches then weighs little)."""
PB_GOAL_S = 0.10
"""How long a decision of PB may take at the paper's size [s]."""
SPEED_FORMAT = 3
"""Of the file; one of another format is measured anew."""
AZIMUTH = 0.3
"""Turn of the candidates [rad]; any that is not along the grid's axes."""

PAPER = ("candidates", min(CANDIDATES))
"""Axis and size of the setting that has the paper's map, candidates and pixels."""
DECISION_STAGES = ("map", "object", "ellipsoids", "candidates", "score")
"""Of a decision."""
TIMED_PLANNERS: dict[str, Callable[[], Planner]] = {"pb": pb, "re": ray_entropy}


@dataclass(frozen=True)
class SpeedTask:
    """What a worker is given."""

    out: Path
    case: Path
    """A finished run without recoveries among its first views."""
    parameters: Parameters

    def identity(self) -> dict[str, Any]:
        """What was measured; the name of the run stands for its settings, parameters included."""
        sizes = {"voxels": EDGES, "candidates": CANDIDATES, "pixels": IMAGES}
        return json.loads(strict_json({"format": SPEED_FORMAT, "run": self.case.name, "sizes": sizes}))


def measure_speed(task: SpeedTask) -> None:
    """Time all decisions and write them to `SPEED`."""
    rows = []
    for axis, size, grid, burst, parameters in _settings(task):
        setting = {"axis": axis, "size": size}
        for name, planner in TIMED_PLANNERS.items():
            rows.append({**setting, "planner": name, **median_decision(planner(), grid, burst, parameters)})
    found = {**task.identity(), "machine": machine(), "goals": goals(rows), "rows": rows}
    write_atomically(task.out / SPEED, strict_json(found, indent=1).encode())


def stored_speed(out: Path) -> dict[str, Any] | None:
    """The measurement in a study's folder, None if there is none, or one of another format."""
    path = out / SPEED
    found = json.loads(path.read_text()) if path.exists() else {}
    return found if found.get("format") == SPEED_FORMAT else None


def is_measured(task: SpeedTask) -> bool:
    """Whether the stored measurement is of this run and these sizes."""
    found = stored_speed(task.out)
    return found is not None and task.identity().items() <= found.items()


def goals(rows: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, float]]:
    """What is wanted and what was measured at the paper's size."""
    pb_s = next(decision_s(row) for row in rows if (row["axis"], row["size"], row["planner"]) == (*PAPER, "pb"))
    return {"pb_decision_s": {"at_most": PB_GOAL_S, "measured": pb_s}}


def decision_s(row: Mapping[str, Any]) -> float:
    """All stages of a decision [s]."""
    return sum(row[stage] for stage in DECISION_STAGES)


def _settings(task: SpeedTask) -> Iterator[tuple[str, int, VoxelMap, DepthBurst, Parameters]]:
    """Axis, size on it, map before the decision, burst, parameters."""
    *before, burst = stored_bursts(task.case, N_VIEWS)
    closed = [resampled_burst(earlier, *CLOSED) for earlier in before]
    for edge in EDGES:
        parameters = with_voxels(task.parameters, edge)
        yield "voxels", edge, filled_map(closed, parameters), burst, parameters
    grid = filled_map(before, task.parameters)
    for count in CANDIDATES:
        yield "candidates", count, grid, burst, task.parameters.model_copy(update={"n_candidates": count})
    for width, height in IMAGES:
        yield "pixels", width, grid, resampled_burst(burst, width, height), task.parameters


def with_voxels(parameters: Parameters, edge: int) -> Parameters:
    """The same workspace in about edge^3 voxels."""
    volume = float(np.prod(np.subtract(parameters.workspace_max, parameters.workspace_min)))
    return parameters.model_copy(update={"voxel_size": volume ** (1 / 3) / edge})


def resampled_burst(burst: DepthBurst, width: int, height: int) -> DepthBurst:
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
        grid = integrate_burst(grid, burst, parameters)
    return grid


def median_decision(planner: Planner, grid: VoxelMap, burst: DepthBurst, parameters: Parameters) -> dict[str, Any]:
    """Median seconds of each stage of a decision with this burst, and how much there was to decide on."""
    timed: list[dict[str, float]] = []
    sizes: dict[str, int] = {}
    while len(timed) < FEWEST_DECISIONS or (len(timed) < MOST and sum(map(decision_s, timed)) < REPEATED_S):
        stages, sizes = _decision(planner, grid, burst, parameters)
        timed.append(stages)
    return {**{stage: float(np.median([row[stage] for row in timed])) for stage in DECISION_STAGES}, **sizes}


def _decision(
    planner: Planner, grid: VoxelMap, burst: DepthBurst, parameters: Parameters
) -> tuple[dict[str, float], dict[str, int]]:
    clock = StageClock()
    model = model_with(grid, burst, planner, parameters, np.random.SeedSequence(0), clock.planning)
    with clock.planning("candidates"):
        poses = candidate_poses(model.object.box, parameters, AZIMUTH)
    with clock.planning("score"):
        planner.score(model, burst.intrinsics, poses, parameters)
    sizes = {
        "map_voxels": int(grid.log_odds.size),
        "object_voxels": len(model.object.occupied) + len(model.object.frontier),
        "poses": len(poses),
        "rays": burst.intrinsics.width * burst.intrinsics.height,
    }
    return {stage: spent.thread_s for stage, spent in clock.read().items()}, sizes
