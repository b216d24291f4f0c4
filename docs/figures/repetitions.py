"""How often certified and naive choices exceed a level, by views alone: the table of docs/thresholds.md.

`python -m docs.figures.repetitions FOLDER` of a study that `franbv study thresholds` has finished; draws nothing.
"""

import sys
from pathlib import Path

from studies.base.stored_preset import read_preset_file
from studies.thresholds.choose import repeated
from studies.thresholds.command import THRESHOLDS_FORMAT, THRESHOLDS_STUDY
from studies.thresholds.config import Bearable, Budget, ThresholdsPreset
from studies.thresholds.study import Study

LEVELS = (0.1, 0.15, 0.2, 0.25, 0.3, 0.4)
"""Of false recoveries; the level of the other risk is the study's."""
RUNS, CONFIDENCE = 200, 0.9
"""Repetitions, and the confidence of each choice."""


def main(folder: Path) -> None:
    """Print the table."""
    preset = read_preset_file(folder / THRESHOLDS_STUDY, ThresholdsPreset, THRESHOLDS_FORMAT)
    scores = Study.of(folder, preset).view_scores()
    print("| level of false recoveries | certified choices that exceed a level | naive ones |")
    print("|---|---|---|")
    for level in LEVELS:
        risks = {name: preset.risks[name] for name in preset.view_risks}
        risks["false_recoveries"] = Bearable(most=0, level=level)
        budget = Budget(repetitions=RUNS, learn_share=preset.budget.learn_share)
        found = repeated(scores, risks, "missed_reflective_area", budget, CONFIDENCE, preset.seed)
        print(f"| {100 * level:g} % | {found.violations} of {found.runs} | {found.naive_violations} of {found.runs} |")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
