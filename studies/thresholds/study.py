"""A thresholds study in its folder: what is drawn, what is scored, which settings go further, what is chosen."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from franbv.parameters import Parameters
from studies.thresholds.bank import BankSettings, ViewTask, bank_folder, bank_settings
from studies.thresholds.choose import (
    SPLIT_STREAM,
    Choice,
    Repetitions,
    choose_setting,
    exceeded,
    known_mean,
    repeated,
    split,
)
from studies.thresholds.config import RESCORED, RUN_RISKS, VIEW_RISKS, ThresholdsPreset
from studies.thresholds.reconstructions import RunDrawTask, run_scores, run_task
from studies.thresholds.score import ScoreTask, SettingGrid, read_scores, setting_combinations, view_grid, with_setting
from studies.thresholds.stress import STRESSES


@dataclass(frozen=True, eq=False)
class Setting:
    """One of those that are chosen among."""

    values: dict[str, Any]
    """By parameter."""
    parameters: Parameters
    """All of the method's, these values among them."""
    view_setting: int
    """Number in the grid that views are scored under."""


@dataclass(frozen=True, eq=False)
class DrawnEvidence:
    """The numbers of all draws under the settings that are chosen among."""

    settings: tuple[Setting, ...]
    scores: dict[str, Float[np.ndarray, "_ k"]]
    """By risk, those that are not stated too."""


@dataclass(frozen=True)
class Study:
    """What a preset asks for, in a folder."""

    out: Path
    preset: ThresholdsPreset
    bank: BankSettings
    grid: SettingGrid

    @classmethod
    def of(cls, out: Path, preset: ThresholdsPreset) -> "Study":
        """InputError for a setting that no parameter can have, or a file that cannot be read."""
        grid = view_grid(preset)
        n_frames = max(parameters.n_frames for parameters in grid.settings)
        return cls(out, preset, bank_settings(preset.domain, preset.seed, n_frames), grid)

    @property
    def view_tasks(self) -> list[ScoreTask]:
        """All views of the budget."""
        folder = bank_folder(self.out, self.bank)
        return [ScoreTask(ViewTask(folder, self.bank, k), self.grid) for k in range(self.preset.budget.views)]

    def stress_tasks(self, setting: Setting) -> dict[str, list[ScoreTask]]:
        """The first views of the budget under each mismatch, scored with one setting."""
        folder, grid = bank_folder(self.out, self.bank), SettingGrid(settings=(setting.parameters,))
        numbers = range(min(self.preset.budget.stress_views, self.preset.budget.views))
        names = STRESSES if self.preset.view_risks and len(numbers) else ()
        return {name: [ScoreTask(ViewTask(folder, self.bank, k, name), grid) for k in numbers] for name in names}

    def view_scores(self) -> dict[str, Float[np.ndarray, "_ k"]]:
        """Of the finished views, by risk and setting of the grid."""
        found = np.stack([read_scores(task).risks for task in self.view_tasks if task.file.exists()])
        return {name: found[:, :, k] for k, name in enumerate(VIEW_RISKS)}

    def region_pixels(self) -> Int[np.ndarray, "k 3"]:
        """Sums over the finished views of `ViewScores.pixels`, by setting of the grid."""
        return np.sum([read_scores(task).pixels for task in self.view_tasks if task.file.exists()], axis=0)

    def dealt(self, n: int) -> tuple[Int[np.ndarray, "_"], Int[np.ndarray, "_"]]:
        """Numbers of n draws: those that the order is learned on, and those that certify."""
        share, rng = self.preset.budget.learn_share, np.random.default_rng([self.preset.seed, SPLIT_STREAM, n])
        learn, test = split(n, (share, 1 - share), rng)
        return learn, test

    def settings(self, views: dict[str, Float[np.ndarray, "_ k"]]) -> tuple[Setting, ...]:
        """Those that are chosen among: all that views can tell apart, or, where reconstructions count, the finalists
        with every combination of what only reconstructions can tell apart."""
        preset, cheap = self.preset, setting_combinations(self.preset, RESCORED)
        dear = setting_combinations(preset, [name for name in preset.settings if name not in RESCORED])
        numbers = range(len(cheap)) if not preset.run_risks else self._finalists(views)
        chosen = [(k, {**cheap[k], **more}) for k in numbers for more in dear]
        return tuple(self.setting(values, k) for k, values in chosen)

    def setting(self, values: dict[str, Any], view_setting: int) -> Setting:
        """One of those that are chosen among, by what it sets and its number in the views' grid."""
        return Setting(values, with_setting(self.preset, values), view_setting)

    def _finalists(self, views: dict[str, Float[np.ndarray, "_ k"]]) -> list[int]:
        """By the learning views alone: those whose worst risk is farthest within its level, then what is preferred."""
        risks = {name: self.preset.risks[name] for name in self.preset.view_risks}
        learn, _ = self.dealt(len(views[VIEW_RISKS[0]]))
        n_settings = len(self.grid.settings)
        beyond = np.zeros(n_settings)
        if risks:
            flags = exceeded({name: views[name][learn] for name in risks}, risks)
            beyond = np.max([np.nan_to_num(known_mean(flags[name])) / risks[name].level for name in risks], axis=0)
        prefer = self.preset.prefer if self.preset.prefer in VIEW_RISKS else VIEW_RISKS[1]
        cost = np.nan_to_num(known_mean(views[prefer][learn]))
        order = sorted(range(n_settings), key=lambda k: (max(beyond[k], WELL_WITHIN), cost[k], beyond[k], k))
        return order[: self.preset.budget.finalists]

    def run_tasks(self, settings: Sequence[Setting]) -> list[RunDrawTask]:
        """All reconstructions of the budget, draw after draw."""
        preset = self.preset
        if not preset.run_risks:
            return []
        return [
            run_task(self.out, preset.domain, preset.seed, number, setting.parameters, k)
            for number in range(preset.budget.reconstructions)
            for k, setting in enumerate(settings)
        ]

    def whole_runs(self, settings: Sequence[Setting]) -> list[list[Path]]:
        """Cases of the drawn scenes that are reconstructed under every setting, in the order of the settings."""
        tasks, k = self.run_tasks(settings), len(settings)
        rows = [[case for task in tasks[i : i + k] if (case := task.case)] for i in range(0, len(tasks), k)]
        return [row for row in rows if len(row) == k]

    def evidence(self, views: dict[str, Float[np.ndarray, "_ k"]], settings: tuple[Setting, ...]) -> DrawnEvidence:
        """Of all finished draws. A reconstruction counts where it is finished under every setting."""
        columns = [setting.view_setting for setting in settings]
        scores = {name: numbers[:, columns] for name, numbers in views.items()}
        if self.preset.run_risks:
            whole = self.whole_runs(settings)
            found = np.array([[run_scores(case) for case in row] for row in whole]).reshape(-1, len(settings), 2)
            scores |= {name: found[:, :, j] for j, name in enumerate(RUN_RISKS)}
        return DrawnEvidence(settings, scores)


WELL_WITHIN = 0.7
"""Part of its level up to which a risk on the learning draws does not count against a finalist (choice: a hundred draws
then certify it more often than not)."""


def chosen_of(study: Study, evidence: DrawnEvidence) -> Choice:
    """The study's own choice, on its own split."""
    preset = study.preset
    dealt = {name: study.dealt(len(numbers)) for name, numbers in evidence.scores.items()}
    learn, test = ({name: rows[k] for name, rows in dealt.items()} for k in range(2))
    return choose_setting(evidence.scores, preset.risks, preset.prefer, learn, test, preset.confidence)


def repetitions_of(study: Study, evidence: DrawnEvidence) -> Repetitions:
    """The choice among the same settings, repeated on other splits."""
    preset = study.preset
    return repeated(evidence.scores, preset.risks, preset.prefer, preset.budget, preset.confidence, preset.seed)
