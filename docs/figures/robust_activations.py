"""How often fra-robust goes to regions of missing or false depth: the figures of docs/fra_robust.md.

`python -m docs.figures.robust_activations FOLDER...`: finished runs of fra-robust, whose bursts are put into its map
again. A view is for the regions that the burst before it showed if more than half of what it was expected to cover lies
in them.
"""

import argparse
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from docs.figures.replayed_models import camera_of, robust_models
from franbv.known_planners import PLANNERS
from franbv.parameters import Parameters
from franbv.robust.choice import expected_gains
from franbv.robust.hypothesis import hypothesis
from franbv.robust.settings import RobustSettings
from studies.run.stored_run import StoredRun, stored_runs

MOST = 0.5
"""Share of a view's expected gain above which it is for the regions (choice: more than half)."""


def main(folders: list[Path]) -> None:
    """Print a row for each run."""
    print("| run | views | that show regions | for regions | share for regions, largest |\n|---|---|---|---|---|")
    for case in (case for folder in folders for case in stored_runs(folder)):
        run = StoredRun(case)
        if run.run["config"]["planner"] == "fra-robust":
            shares = shares_for_regions(run)
            shown = [share for share in shares if share is not None]
            name = f"{run.run['title'].split(',')[0]}, {run.run['config']['azimuth_deg']:.0f} deg"
            counts = f"{len(shares)} | {len(shown)} | {sum(share > MOST for share in shown)}"
            print(f"| {name} | {counts} | {max(shown, default=0.0):.2f} |", flush=True)


def shares_for_regions(stored: StoredRun) -> list[float | None]:
    """Of each view but the last: the share of the next view's gain in its regions, None where it shows none."""
    parameters = Parameters.model_validate(stored.run["config"]["parameters"])
    detect, settings, shares = PLANNERS["fra-robust"].build().detect, RobustSettings(), []
    assert detect is not None
    min_z = camera_of(stored).min_z
    following = [stored.view(number).pose for number in range(1, len(stored.rows))]
    for pose, (burst, model) in zip(following, robust_models(stored, parameters), strict=False):
        boxes = [box.grown(parameters.voxel_size) for box in detect(burst, model, parameters, min_z).boxes]
        left = hypothesis(model, parameters, settings)
        gains = expected_gains(model, left, burst.intrinsics, RigidTransform.concatenate([pose]), settings)[0]
        inside = np.zeros(len(gains), bool)
        for box in boxes:
            inside |= box.contains(left.places)
        shares.append(float(gains[inside].sum() / gains.sum()) if boxes and gains.sum() > 0 else None)
    return shares


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m docs.figures.robust_activations")
    parser.add_argument("folders", nargs="+", type=Path)
    main(parser.parse_args().folders)
