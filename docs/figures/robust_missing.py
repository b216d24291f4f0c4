"""What fra-robust believes to be missing against what is: the table of docs/fra_robust.md.

`python -m docs.figures.robust_missing FOLDER...`: finished runs of fra-robust. Of every view: the share of the surface
that it expects to be uncovered, and the share that is.
"""

import argparse
from itertools import pairwise
from pathlib import Path

import numpy as np

from studies.run.acquisition_table import MAP_COVERAGE, MISSING_BELIEVED
from studies.run.stored_run import StoredRun, stored_runs

EDGES = (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 1.0)
"""Of the ranges of what is believed to be missing (choice: even steps where runs end)."""


def main(folders: list[Path]) -> None:
    """Print the table over all views of all runs."""
    runs = [StoredRun(case) for folder in folders for case in stored_runs(folder)]
    pairs = np.concatenate([believed_and_true(run) for run in runs if run.run["config"]["planner"] == "fra-robust"])
    print("| believed missing | views | believed, mean | missing, mean | lowest and highest tenth |")
    print("|---" * 5 + "|")
    for low, high in pairwise(EDGES):
        believed, missing = pairs[(pairs[:, 0] >= low) & (pairs[:, 0] < high)].T
        if len(missing):
            tenths = " to ".join(f"{100 * end:.1f}" for end in np.quantile(missing, [0.1, 0.9]))
            means = f"{100 * believed.mean():.1f} | {100 * missing.mean():.1f}"
            print(f"| {100 * low:.0f} to {100 * high:.0f} % | {len(missing)} | {means} | {tenths} |")


def believed_and_true(stored: StoredRun) -> np.ndarray:
    """Both shares after every acquisition, (n, 2)."""
    return np.array([(row[MISSING_BELIEVED], 1.0 - row[MAP_COVERAGE]) for row in stored.rows])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m docs.figures.robust_missing")
    parser.add_argument("folders", nargs="+", type=Path)
    main(parser.parse_args().folders)
