"""Power of the drift monitor on runs of this simulator: the table of docs/thresholds.md.

`python -m docs.figures.monitored FOLDER RUNS...`: a study that `franbv study thresholds` has finished, and folders of
runs outside its domain. Every other reconstruction of the study makes the reference, the others are what stays inside.
"""

import sys
from pathlib import Path

from studies.base.stored_preset import read_preset_file
from studies.run.stored_run import StoredRun
from studies.thresholds.command import THRESHOLDS_FORMAT, THRESHOLDS_STUDY
from studies.thresholds.config import ThresholdsPreset
from studies.thresholds.power import power
from studies.thresholds.reference import monitor_reference
from studies.thresholds.signals import Observed, observed_of_stored
from studies.thresholds.study import Study, chosen_of

LENGTH, FALSE_ALARMS, TOLERANCE, SEED = 100, 0.05, 0.05, 0
"""Runs of a stream; the command's defaults; of the drawing."""


def main(folder: Path, outside: list[Path]) -> None:
    """Print the table."""
    inside = inside_runs(folder)
    reference, streams = monitor_reference(inside[::2], SEED), inside[1::2]
    print("| outside | runs | false alarms | alarms | runs until the alarm |")
    print("|---|---|---|---|---|")
    for place in outside:
        runs = [observed_of_stored(StoredRun(case.parent)) for case in sorted(place.glob("*/run.json"))]
        found = power(reference, streams, runs, LENGTH, FALSE_ALARMS, TOLERANCE, SEED)
        delay = f"more than {LENGTH}" if found.median_delay is None else f"{found.median_delay:.0f}"
        print(f"| {place.name} | {len(runs)} | {found.false_alarms:.3f} | {found.alarms:.3f} | {delay} |")


def inside_runs(folder: Path) -> list[Observed]:
    """Of the chosen setting's finished reconstructions."""
    study = Study.of(folder, read_preset_file(folder / THRESHOLDS_STUDY, ThresholdsPreset, THRESHOLDS_FORMAT))
    views = study.view_scores()
    evidence = study.evidence(views, study.settings(views))
    chosen = chosen_of(study, evidence).chosen
    assert chosen is not None
    cases = [task.case for task in study.run_tasks([evidence.settings[chosen]])]
    return [observed_of_stored(StoredRun(case)) for case in cases if case]


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
