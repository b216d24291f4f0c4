"""What it does to coverage and cloud that fra-robust leaves out blocks that mix near and far (docs/fra_robust.md).

`python -m docs.figures.robust_mixed FOLDER...`: finished runs of fra-robust, whose bursts are put into its map again;
of every part the means over its runs, with all depth and as the planner keeps it.
"""

import argparse
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from docs.figures.replayed_models import robust_models
from franbv.evaluation.quality import quality
from franbv.evaluation.reference import TOLERANCE, Reference
from franbv.frames import back_project
from franbv.known_planners import PLANNERS
from franbv.object_model import object_points
from franbv.parameters import Parameters
from franbv.planners import Points, all_depth
from render.d435i import SimulatedD435i
from render.world.visibility import seen_from_above
from studies.run.reference import reference_surface
from studies.run.scene_settings import SubjectSettings, build_subject
from studies.run.stored_run import StoredRun, stored_runs

AFTER = (5, 10, 20, 30)
"""Acquisitions after which coverage is told."""


@dataclass(frozen=True)
class CloudFigures:
    """Of one run."""

    coverage: tuple[float, ...]
    """Of the map after AFTER [0, 1]; nan where the run was shorter."""
    map_error: float
    """Mean distance of the points that the final map holds from the surface [m]."""
    all_error: float
    """The same of all points ever measured [m]."""


def main(folders: list[Path]) -> None:
    """Print the table."""
    found: dict[str, list[tuple[CloudFigures, CloudFigures]]] = defaultdict(list)
    references: dict[str, Reference] = {}
    for case in (case for folder in folders for case in stored_runs(folder)):
        run = StoredRun(case)
        config = run.run["config"]
        part = str(config["part"])
        if config["planner"] != "fra-robust":
            continue
        if part not in references:
            references[part] = reference_of(config)
        kept = PLANNERS["fra-robust"].build().points
        found[part].append((figures(run, references[part], all_depth), figures(run, references[part], kept)))
    print("| part, runs | cloud |" + "".join(f" {n} |" for n in AFTER) + " map's cloud, mm | all points, mm |")
    for part, pairs in sorted(found.items()):
        for name, side in (("all depth", 0), ("unmixed", 1)):
            told = [pair[side] for pair in pairs]
            coverage = 100 * np.mean([one.coverage for one in told], axis=0)
            errors = 1e3 * np.mean([[one.map_error, one.all_error] for one in told], axis=0)
            cells = "".join(f" {value:.1f} |" for value in (*coverage, *errors))
            print(f"| {part}, {len(pairs)} | {name} |{cells}", flush=True)


def reference_of(config: dict) -> Reference:
    """The surface of a run's subject."""
    subject = SubjectSettings.model_validate(
        {name: config[name] for name in SubjectSettings.model_fields if name in config}
    )
    scene = build_subject(subject).scene
    camera = SimulatedD435i(scene, subject.sensor, subject.seed)
    return reference_surface(scene, lambda points, normals: seen_from_above(camera.world, points, normals))


def figures(run: StoredRun, reference: Reference, points: Points) -> CloudFigures:
    """Of a run whose cloud is made of this depth."""
    parameters = Parameters.model_validate(run.run["config"]["parameters"])
    cloud: Float[np.ndarray, "n 3"] = np.zeros((0, 3))
    coverage, grid = [], None
    for burst, model in robust_models(run, parameters):
        grid = model.voxel_map
        seen = burst.T_world_cam.apply(back_project(points(burst, parameters), burst.intrinsics))
        cloud = np.concatenate([cloud, object_points(seen, grid, parameters)])
        coverage.append(quality(reference, cloud[grid.lookup(grid.occupied, cloud)]).coverage[TOLERANCE])
    assert grid is not None
    held = cloud[grid.lookup(grid.occupied, cloud)]
    after = tuple(coverage[n - 1] if n <= len(coverage) else np.nan for n in AFTER)
    return CloudFigures(after, quality(reference, held).accuracy_mean, quality(reference, cloud).accuracy_mean)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m docs.figures.robust_mixed")
    parser.add_argument("folders", nargs="+", type=Path)
    main(parser.parse_args().folders)
