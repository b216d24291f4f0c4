"""Stored views scored under every setting, without rendering: the planner's first look at each burst, and what it says.

Settings that differ in the clustering alone share the map, the ellipsoids and the located pixels.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from franbv.geometry.oriented_box import OrientedBox, oriented_box
from franbv.parameters import Parameters
from franbv.reflective_regions import BoxOf, group_into_boxes
from studies.base.case_folder import case_digest
from studies.base.config import Config, validated
from studies.sensitivity.planning import first_look
from studies.store.views import read_arrays, write_arrays
from studies.thresholds.bank import BankedView, ViewTask, do_view, read_banked_view
from studies.thresholds.config import RESCORED, VIEW_RISKS, ThresholdsPreset
from studies.thresholds.sensors import sensor_names

CLUSTERING = ("cluster_radius_voxels", "cluster_min_samples")
"""Parameters of the last step, which are tried on the same located pixels."""
LEAST_HOLE_PX = 5
"""Reflective pixels below which a view says nothing about what is missed (choice: a pixel's cross, the smallest blob
that the default clustering keeps)."""
MOSTLY = 0.5
"""Share of a region's pixels that must be reflective holes for it to be no false one (choice: more than half)."""
SCORES, SCORES_NAME = "scores", "thresholds scores 2"
"""Folder of the scores in a bank's, and what the hash of a grid calls it; the number rises when a score comes to mean
something else."""


class SettingGrid(Config):
    """The settings that views are scored under, in order."""

    settings: tuple[Parameters, ...]

    @property
    def name(self) -> str:
        """Of the folder of its scores."""
        return case_digest(SCORES_NAME, self)


@dataclass(frozen=True)
class ScoreTask:
    """A view to be drawn, if it is not there, and scored."""

    view: ViewTask
    grid: SettingGrid
    camera: str = ""
    """Which of those that are chosen among, for people."""

    @property
    def title(self) -> str:
        """For people."""
        return self.view.title + (f", {self.camera}" if self.camera else "")

    @property
    def file(self) -> Path:
        """Of the scores."""
        return self.view.folder / SCORES / self.view.stress / self.grid.name / f"{self.view.number:06d}.npz"


@dataclass(frozen=True, eq=False)
class ViewScores:
    """What a view says under each setting."""

    risks: Float[np.ndarray, "k 3"]
    """The numbers of VIEW_RISKS; NaN where the view says nothing of one."""
    pixels: Int[np.ndarray, "k 3"]
    """Pixels in regions that are reflective holes, pixels in regions, and reflective holes."""


def setting_combinations(preset: ThresholdsPreset, names: Sequence[str]) -> list[dict[str, Any]]:
    """Every combination of the stated values of these parameters."""
    chosen = {name: values for name, values in preset.settings.items() if name in names}
    return [dict(zip(chosen, values, strict=True)) for values in product(*chosen.values())]


def with_setting(preset: ThresholdsPreset, setting: Mapping[str, Any]) -> Parameters:
    """The planner's parameters under a setting, whatever it says of the camera; InputError for a value that a parameter
    cannot have."""
    planner = {name: value for name, value in setting.items() if name not in sensor_names(preset.settings)}
    stated = preset.parameters.model_dump() | {"roll_deg": preset.domain.sensor.mount_roll_deg} | planner
    return validated(Parameters, stated, "settings")


def view_grid(preset: ThresholdsPreset) -> SettingGrid:
    """What the preset's views are scored under."""
    return SettingGrid(
        settings=tuple(with_setting(preset, chosen) for chosen in setting_combinations(preset, RESCORED))
    )


def do_score(task: ScoreTask) -> None:
    """For a worker: the view drawn and scored, unless it is; NaN where there is no such view."""
    if task.file.exists():
        return
    found = unseen(len(task.grid.settings))
    if do_view(task.view):
        draw, view = read_banked_view(task.view)
        found = scored(view, task.grid.settings, draw.seed)
    task.file.parent.mkdir(parents=True, exist_ok=True)
    write_arrays(task.file, vars(found))


def read_scores(task: ScoreTask) -> ViewScores:
    """Of a view."""
    return ViewScores(**read_arrays(task.file))


def unseen(n_settings: int) -> ViewScores:
    """Where there is no view."""
    return ViewScores(np.full((n_settings, len(VIEW_RISKS)), np.nan), np.zeros((n_settings, 3), int))


def scored(view: BankedView, settings: Sequence[Parameters], seed: int) -> ViewScores:
    """The view under each setting."""
    found = unseen(len(settings))
    for numbers, parameters in _alike_but_for_clusters(settings):
        burst = view.burst(parameters.n_frames)
        detection = first_look(burst, parameters, seed).detection
        depth = burst.median_depth(parameters.invalid_share)
        believed, box_of = false_depth_share(view, depth), remembering_boxes()
        for number in numbers:
            labels, _ = group_into_boxes(detection.points, settings[number], box_of)
            found.risks[number] = (*region_scores(view, detection.pixels, labels, settings[number]), believed)
            found.pixels[number] = region_pixels(view, detection.pixels, labels)
    return found


def _alike_but_for_clusters(settings: Sequence[Parameters]) -> Iterator[tuple[list[int], Parameters]]:
    defaults = Parameters().model_dump(include=set(CLUSTERING))
    groups: dict[str, tuple[list[int], Parameters]] = {}
    for number, parameters in enumerate(settings):
        share = least_share(parameters.invalid_share, parameters.n_frames)
        alike = parameters.model_copy(update={**defaults, "invalid_share": share})
        groups.setdefault(alike.model_dump_json(), ([], alike))[0].append(number)
    yield from groups.values()


def least_share(invalid_share: float, n_frames: int) -> float:
    """The least share that as many frames can have and that reaches `invalid_share`: all that lies between two of them
    tells the same frames apart."""
    return next((k / n_frames for k in range(n_frames + 1) if k / n_frames >= invalid_share), invalid_share)


def remembering_boxes() -> BoxOf:
    """`oriented_box`, which finds the box of the same points once: settings often agree on a cluster, and boxes took
    half of the time."""
    known: dict[bytes, OrientedBox] = {}

    def box_of(points: Float[np.ndarray, "n 3"], least_side: float) -> OrientedBox:
        key = points.tobytes()
        if key not in known:
            known[key] = oriented_box(points, least_side)
        return known[key]

    return box_of


def region_scores(
    view: BankedView, pixels: Int[np.ndarray, "n 2"], labels: Int[np.ndarray, "n"], parameters: Parameters
) -> tuple[float, float]:
    """False regions among those that would be recovered, and the missed share of the reflective holes.

    pixels, labels: of the located pixels, as in `Detection`.
    """
    u, v = pixels.T
    right = view.reflective[v, u]
    n_regions = int(labels.max(initial=-1)) + 1
    recovered = range(n_regions if parameters.regions_recovered == "all" else min(n_regions, 1))
    false = sum(float(right[labels == region].mean()) < MOSTLY for region in recovered)
    n_true = int(view.reflective.sum())
    if n_true < LEAST_HOLE_PX:
        return float(false), np.nan
    return float(false), 1 - float((right & (labels >= 0)).sum()) / n_true


def region_pixels(
    view: BankedView, pixels: Int[np.ndarray, "n 2"], labels: Int[np.ndarray, "n"]
) -> tuple[int, int, int]:
    """Pixels in regions that are reflective holes, pixels in regions, and reflective holes."""
    u, v = pixels[labels >= 0].T
    return int(view.reflective[v, u].sum()), len(u), int(view.reflective.sum())


def false_depth_share(view: BankedView, depth: Float[np.ndarray, "h w"]) -> float:
    """Of the part's pixels with depth; NaN where none has. A share of nothing is of no setting alone: the caller takes
    views with too little depth out for all of them."""
    valid = (depth > 0) & view.part
    return float(view.is_false(depth)[valid].mean()) if valid.any() else np.nan
