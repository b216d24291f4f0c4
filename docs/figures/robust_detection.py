"""What fra-robust's detector and fra's tell of the same bursts: the table of docs/fra_robust.md.

`python -m docs.figures.robust_detection FOLDER... [--preset NAME] [--keep FOLDER]`: finished simulated runs. Their
poses are measured and labelled anew, with the camera of the run or with another preset of it, and the bursts put one
after the other into the map of each planner. --keep: folder in which the labelled views are kept for another time.
"""

import argparse
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from docs.figures.replayed_models import camera_of
from franbv.known_planners import PLANNERS
from franbv.model import Model, model_of, model_with
from franbv.parameters import Parameters
from franbv.planners import Planner
from franbv.reflective_regions import Detection
from franbv.sensing import DepthBurst
from franbv.voxel_map import empty_map
from render.d435i import SimulatedD435i
from studies.run.stored_run import StoredRun, stored_runs
from studies.scoring.burst_detection import BurstScores, ViewTruth, measured_view, score_burst, summed_scores
from studies.store.views import read_arrays, write_arrays

EARLY = 5
"""Views that count as early, when the hull is poor."""
COMPARED = ("fra-robust", "fra")
HEAD = (
    "| run | detector | views | holes: precision | with over-exposed | recall | of | false depth: precision "
    "| wrong at all | recall | of | recall beyond 15 mm | points off by, mm | views with regions |"
)


def main(folders: list[Path], preset: str | None, keep: Path | None) -> None:
    """Print the table, run by run, and all summed_scores."""
    print(HEAD + "\n" + "|---" * HEAD.count(" |") + "|")
    everything: dict[str, list[BurstScores]] = {name: [] for name in COMPARED}
    for case in (case for folder in folders for case in stored_runs(folder)):
        stored = StoredRun(case)
        parameters = Parameters.model_validate(stored.run["config"]["parameters"])
        part = stored.run["title"].split(",")[0]
        camera = camera_of(stored, preset)
        views = list(labelled_views(stored, camera, parameters.n_frames, preset, keep))
        for name in COMPARED:
            scores = scores_of(PLANNERS[name].build(), views, parameters, camera.min_z)
            print(row(part, name, scores))
            if name == "fra-robust":
                print(row(part, f"{name}, first {EARLY}", scores[:EARLY]))
            everything[name] += scores
    for name, scores in everything.items():
        print(row("all", name, scores), flush=True)


def labelled_views(
    stored: StoredRun, camera: SimulatedD435i, n_frames: int, preset: str | None, keep: Path | None
) -> Iterator[tuple[DepthBurst, ViewTruth]]:
    """Bursts from the run's poses, and their truth."""
    for number in range(len(stored.rows)):
        pose = stored.view(number).pose
        file = keep and keep / f"{stored.folder.name}_{preset or 'own'}" / f"{number:03d}.npz"
        if file and file.exists():
            yield kept_view(file, camera, pose)
            continue
        burst, truth = measured_view(camera, pose, n_frames)
        if file:
            file.parent.mkdir(parents=True, exist_ok=True)
            write_arrays(file, {f.name: getattr(truth, f.name) for f in fields(truth)} | {"depths": burst.depths})
        yield burst, truth


def kept_view(file: Path, camera: SimulatedD435i, pose: RigidTransform) -> tuple[DepthBurst, ViewTruth]:
    """As it was written."""
    arrays = read_arrays(file)
    return DepthBurst(arrays.pop("depths"), camera.intrinsics, pose), ViewTruth(**arrays)


def scores_of(
    planner: Planner, views: list[tuple[DepthBurst, ViewTruth]], parameters: Parameters, min_z: float
) -> list[BurstScores]:
    """Of every view, before the planner's own map of all bursts up to it."""
    seed, scores = np.random.SeedSequence(0), []
    model: Model = model_of(empty_map(parameters), planner, parameters, seed)
    for burst, truth in views:
        model = model_with(model.voxel_map, burst, planner, parameters, seed)
        scores.append(score_burst(detected(planner, burst, model, parameters, min_z), burst, truth))
    return scores


def detected(planner: Planner, burst: DepthBurst, model: Model, parameters: Parameters, min_z: float) -> Detection:
    """What a planner that names regions, whether it recovers them or not, tells of a burst."""
    if planner.recovery is not None:
        return planner.recovery.detect(burst, model, parameters)
    assert planner.detect is not None
    return planner.detect(burst, model, parameters, min_z)


def row(run: str, detector: str, scores: list[BurstScores]) -> str:
    """Of the table."""
    s = summed_scores(scores)
    cells = [
        *(run, detector, str(s.views)),
        *(f"{share:.2f}" for share in (s.holes_precision, s.highlight_precision, s.holes_recall)),
        str(s.holes_true),
        *(f"{share:.2f}" for share in (s.false_precision, s.any_false_precision, s.false_recall)),
        str(s.false_true),
        f"{s.far_recall:.2f}",
        f"{1000 * s.point_error:.1f}",
        str(s.views_with_regions),
    ]
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m docs.figures.robust_detection")
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--preset")
    parser.add_argument("--keep", type=Path)
    said = parser.parse_args()
    main(said.folders, said.preset, said.keep)
