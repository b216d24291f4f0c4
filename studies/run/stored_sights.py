"""A stored run as the viewer shows it. What was not stored is made again of what was, or left out with a word."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.adapters.view.opening import rrd_file
from franbv.adapters.view.sight import ShownVoxels, Sight
from franbv.object_model import object_model
from franbv.parameters import Parameters
from franbv.planners import integrate_burst
from franbv.sensing import DepthBurst
from franbv.voxel_map import empty_map
from studies.base.config import validated
from studies.base.numbers_as_text import counted
from studies.run.acquisition_table import MAP_COVERAGE, RECOVERY
from studies.run.sentences import is_open_loop
from studies.run.stored_run import RUN, StoredRun
from studies.run.viewing import view_errors
from studies.store.views import StoredView


def write_rrd(case: Path, file: Path) -> list[str]:
    """Write the viewer's file of a case; returns what was left out. InputError where either cannot be."""
    stored = StoredRun(case)
    parameters = validated(Parameters, stored.run["config"]["parameters"], f"{case / RUN}, parameters")
    sights, left_out = stored_sights(stored, parameters)
    with view_errors(), rrd_file(file, stored.run["title"], parameters.invalid_share) as view:
        for sight in sights:
            view.show(sight)
    return left_out


def stored_sights(stored: StoredRun, parameters: Parameters) -> tuple[list[Sight], list[str]]:
    """Its acquisitions, and what of them is left out, in words."""
    views = [stored.view(k) for k in range(len(stored.rows))]
    voxels, without_voxels = _voxels(stored, parameters, views)
    recoveries, without_poses = _recovery_poses(stored, views)
    points, owner = stored.cloud
    sights = [
        Sight(
            index=k,
            kind=row["kind"],
            iteration=row["iteration"],
            T_world_cam=view.pose,
            intrinsics=view.intrinsics,
            depth=view.depth,
            points=points[owner == k],
            ellipsoids=view.ellipsoids,
            regions=tuple(view.regions),
            recovery_poses=recoveries[k],
            voxels=voxels[k] if voxels else None,
            infrared=stored.infrared(k),
            curves={"coverage": row[MAP_COVERAGE], **{key: row[key] for key in ("gamma", "utility")}}
            | {"occupied_voxels": float(row["occupied_voxels"])},
        )
        for k, (row, view) in enumerate(zip(stored.rows, views, strict=True))
    ]
    return sights, [f"{stored.folder}: {words}" for words in (without_voxels, without_poses) if words]


def _voxels(stored: StoredRun, parameters: Parameters, views: Sequence[StoredView]) -> tuple[list[ShownVoxels], str]:
    """Voxels after each acquisition, from the stored depth put into an empty map again; none, and why, where that is
    not the run's map: the table of acquisitions has the number of its voxels."""
    voxel_map, found = empty_map(parameters), []
    for k, (row, view) in enumerate(zip(stored.rows, views, strict=True)):
        frames = stored.depths(k) if parameters.frames_into_map == "each" else view.depth[None]
        if frames is None:
            return [], "its depth frames were not kept, so the map cannot be made again; voxels are left out"
        burst = DepthBurst(np.asarray(frames), view.intrinsics, view.pose)
        voxel_map = integrate_burst(voxel_map, burst, parameters)
        estimate = object_model(voxel_map, parameters)
        numbers = len(estimate.occupied), len(estimate.frontier)
        expected = row["occupied_voxels"], row["frontier_voxels"]
        if numbers != expected:
            return [], (
                f"the map made again of its depth has {numbers[0]} occupied and {numbers[1]} frontier voxels after "
                f"acquisition {k + 1}, and the run's had {expected[0]} and {expected[1]}; voxels are left out"
            )
        found.append(ShownVoxels(estimate.occupied, estimate.frontier, parameters.voxel_size))
    return found, ""


def _recovery_poses(stored: StoredRun, views: Sequence[StoredView]) -> tuple[list[tuple[RigidTransform, ...]], str]:
    """Of the poses that each acquisition planned for a recovery, those that were taken: others are not stored."""
    planned = [row["recovery_poses"] or 0 for row in stored.rows]
    if is_open_loop(stored.run):
        words = f"{counted(sum(planned), 'recovery pose')} of an open-loop replay, which nobody took,"
        return [()] * len(views), f"{words} are not stored and left out" if sum(planned) else ""
    taken = [_taken(stored.rows, k, views) for k in range(len(views))]
    missing = sum(planned) - sum(map(len, taken))
    words = f"{counted(missing, 'recovery pose')} that the run did not take are not stored and left out"
    return taken, words if missing else ""


def _taken(rows: Sequence[dict[str, Any]], activating: int, views: Sequence[StoredView]) -> tuple[RigidTransform, ...]:
    """Poses of the recovery that an acquisition sets off: they follow it, up to the one that sets off the next."""
    poses = []
    if rows[activating]["recovery_poses"]:
        for row, view in zip(rows[activating + 1 :], views[activating + 1 :], strict=True):
            if row["kind"] != RECOVERY:
                break
            poses.append(view.pose)
            if row["recovery_poses"]:
                break
    return tuple(poses)
