"""A thresholds study in its folder: what is drawn, what is scored, which settings go further, what is chosen."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from franbv.parameters import Parameters
from studies.thresholds.bank import BankSettings, ViewTask, bank_folder, bank_settings, with_sensor
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
from studies.thresholds.sensors import SensorAlternative, sensor_alternatives, sensor_names
from studies.thresholds.stress import STRESSES


@dataclass(frozen=True, eq=False)
class Setting:
    """One of those that are chosen among."""

    values: dict[str, Any]
    """By parameter, and by the camera's `SENSOR_CHOICES`."""
    parameters: Parameters
    """All of the method's, these values among them."""
    camera: int
    """Number of its alternative."""
    bank: BankSettings
    """Of its views: the domain before its camera."""
    view_setting: int
    """Column of the views' scores."""


@dataclass(frozen=True, eq=False)
class DrawnEvidence:
    """The numbers of all draws under the settings that are chosen among."""

    settings: tuple[Setting, ...]
    scores: dict[str, Float[np.ndarray, "_ k"]]
    """By risk, those that are not stated too."""
    numbers: dict[str, Int[np.ndarray, "_"]]
    """Of the draws, by risk: those that are not finished are missing."""

    @property
    def cameras(self) -> Int[np.ndarray, "k"]:
        """Number of each setting's."""
        return np.array([setting.camera for setting in self.settings])


@dataclass(frozen=True)
class Study:
    """What a preset asks for, in a folder."""

    out: Path
    preset: ThresholdsPreset
    cameras: tuple[SensorAlternative, ...]
    """That are chosen among; the declared one alone where nothing of it is."""
    banks: tuple[BankSettings, ...]
    """Of each camera."""
    grid: SettingGrid
    """Of the planner's settings, under each camera."""

    @classmethod
    def of(cls, out: Path, preset: ThresholdsPreset) -> "Study":
        """InputError for a setting that no parameter can have, or a file that cannot be read."""
        grid, cameras = view_grid(preset), sensor_alternatives(preset.settings, preset.domain.sensor)
        n_frames = max(parameters.n_frames for parameters in grid.settings)
        declared = bank_settings(preset.domain, preset.seed, n_frames)
        return cls(out, preset, cameras, tuple(with_sensor(declared, camera.sensor) for camera in cameras), grid)

    @property
    def view_tasks(self) -> list[list[ScoreTask]]:
        """All draws of the budget: the view of each by every camera."""
        words = [camera.words for camera in self.cameras]
        banks = [(bank_folder(self.out, bank), bank) for bank in self.banks]
        return [
            [ScoreTask(ViewTask(*bank, k), self.grid, which) for bank, which in zip(banks, words, strict=True)]
            for k in range(self.preset.budget.views)
        ]

    @property
    def finished_views(self) -> list[list[ScoreTask]]:
        """Those draws that are scored under every camera."""
        return [draw for draw in self.view_tasks if all(task.file.exists() for task in draw)]

    def stress_tasks(self, setting: Setting) -> dict[str, list[ScoreTask]]:
        """The first views of the budget under each mismatch, scored with one setting."""
        folder, grid = bank_folder(self.out, setting.bank), SettingGrid(settings=(setting.parameters,))
        numbers = range(min(self.preset.budget.stress_views, self.preset.budget.views))
        names = STRESSES if self.preset.view_risks and len(numbers) else ()
        return {name: [ScoreTask(ViewTask(folder, setting.bank, k, name), grid) for k in numbers] for name in names}

    @property
    def view_settings(self) -> list[dict[str, Any]]:
        """What each column of `view_scores` sets."""
        planned = setting_combinations(self.preset, RESCORED)
        return [{**camera.values, **values} for camera in self.cameras for values in planned]

    def view_scores(self) -> dict[str, Float[np.ndarray, "_ k"]]:
        """Of the finished views, by risk; the grid's settings under the first camera, under the second, and so on."""
        found = np.stack([np.concatenate([read_scores(task).risks for task in draw]) for draw in self.finished_views])
        return {name: found[:, :, k] for k, name in enumerate(VIEW_RISKS)}

    def region_pixels(self) -> Int[np.ndarray, "k 3"]:
        """Sums over the finished views of `ViewScores.pixels`, by column of `view_scores`."""
        found = [np.concatenate([read_scores(task).pixels for task in draw]) for draw in self.finished_views]
        return np.sum(found, axis=0)

    def dealt(self, n: int) -> tuple[Int[np.ndarray, "_"], Int[np.ndarray, "_"]]:
        """Numbers of n draws: those that the order is learned on, and those that certify."""
        share, rng = self.preset.budget.learn_share, np.random.default_rng([self.preset.seed, SPLIT_STREAM, n])
        learn, test = split(n, (share, 1 - share), rng)
        return learn, test

    def settings(self, views: dict[str, Float[np.ndarray, "_ k"]]) -> tuple[Setting, ...]:
        """Those that are chosen among: all that views can tell apart, or, where reconstructions count, the finalists
        with every combination of what only reconstructions can tell apart."""
        preset, others = self.preset, (*RESCORED, *sensor_names(self.preset.settings))
        cheap = self.view_settings
        dear = setting_combinations(preset, [name for name in preset.settings if name not in others])
        numbers = range(len(cheap)) if not preset.run_risks else self._finalists(views)
        chosen = [(k, {**cheap[k], **more}) for k in numbers for more in dear]
        return tuple(self.setting(values, k) for k, values in chosen)

    def setting(self, values: dict[str, Any], view_setting: int) -> Setting:
        """One of those that are chosen among, by what it sets and its column of the views' scores."""
        camera = view_setting // len(self.grid.settings)
        return Setting(values, with_setting(self.preset, values), camera, self.banks[camera], view_setting)

    def _finalists(self, views: dict[str, Float[np.ndarray, "_ k"]]) -> list[int]:
        """By the learning views alone: those whose worst risk is farthest within its level, then what is preferred."""
        risks = {name: self.preset.risks[name] for name in self.preset.view_risks}
        learn, _ = self.dealt(len(views[VIEW_RISKS[0]]))
        n_settings = len(self.cameras) * len(self.grid.settings)
        beyond = np.zeros(n_settings)
        if risks:
            cameras = np.arange(n_settings) // len(self.grid.settings)
            flags = exceeded({name: views[name][learn] for name in risks}, risks, cameras)
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
            run_task(self.out, setting.bank.domain, preset.seed, number, setting.parameters, k)
            for number in range(preset.budget.reconstructions)
            for k, setting in enumerate(settings)
        ]

    def whole_runs(self, settings: Sequence[Setting]) -> dict[int, list[Path]]:
        """By number of the draw, cases of the scenes that are reconstructed under every setting, in the order of the
        settings."""
        tasks, k = self.run_tasks(settings), len(settings)
        rows = [[case for task in tasks[i : i + k] if (case := task.case)] for i in range(0, len(tasks), k)]
        return {number: row for number, row in enumerate(rows) if len(row) == k}

    def evidence(self, views: dict[str, Float[np.ndarray, "_ k"]], settings: tuple[Setting, ...]) -> DrawnEvidence:
        """Of all finished draws. A reconstruction counts where it is finished under every setting."""
        columns = [setting.view_setting for setting in settings]
        scores = {name: found[:, columns] for name, found in views.items()}
        numbers = dict.fromkeys(views, np.array([draw[0].view.number for draw in self.finished_views], int))
        if self.preset.run_risks:
            whole = self.whole_runs(settings)
            found = np.array([[run_scores(case) for case in row] for row in whole.values()])
            found = found.reshape(-1, len(settings), len(RUN_RISKS))
            scores |= {name: found[:, :, j] for j, name in enumerate(RUN_RISKS)}
            numbers |= dict.fromkeys(RUN_RISKS, np.array(list(whole), int))
        return DrawnEvidence(settings, scores, numbers)


WELL_WITHIN = 0.7
"""Part of its level up to which a risk on the learning draws does not count against a finalist (choice: a hundred draws
then certify it more often than not)."""


def chosen_of(study: Study, evidence: DrawnEvidence) -> Choice:
    """The study's own choice, on its own split."""
    preset = study.preset
    dealt = {name: study.dealt(len(numbers)) for name, numbers in evidence.scores.items()}
    learn, test = ({name: rows[k] for name, rows in dealt.items()} for k in range(2))
    return choose_setting(
        evidence.scores, preset.risks, preset.prefer, learn, test, preset.confidence, evidence.cameras
    )


def repetitions_of(study: Study, evidence: DrawnEvidence) -> Repetitions:
    """The choice among the same settings, repeated on other splits."""
    preset, scores = study.preset, evidence.scores
    decided = preset.risks, preset.prefer, preset.budget, preset.confidence, preset.seed
    return repeated(scores, *decided, evidence.cameras)
