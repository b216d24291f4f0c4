"""Banks of analytic views of a mirroring ball, written where a study looks for its own: nothing is rendered."""

import json
from dataclasses import fields
from pathlib import Path

import numpy as np

from franbv.frames import look_at
from studies.store.views import camera_vector, write_arrays
from studies.thresholds.bank import BankedView, BankSettings, bank_folder, view_file
from studies.thresholds.config import ThresholdsPreset
from studies.thresholds.draw import view_draw
from studies.thresholds.study import Study
from tests.studies.run.analytic_ball import CAMERA, CENTRE, HIGHLIGHT, Ball, ball_depth

FALSE_M = 0.02
"""By how much the depth of some of the ball's pixels is wrong [m]."""


def made_up_view(settings: BankSettings, number: int) -> BankedView:
    """A view of the ball; on its plates a fifth of the ball's depth is false, but not under `high_accuracy`."""
    draw = view_draw(settings.domain, settings.seed, number)
    polar, azimuth = np.radians([draw.polar_deg, draw.azimuth_deg])
    outward = np.array([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)])
    pose = look_at(CENTRE + draw.distance_m * outward, CENTRE)
    burst, _ = Ball().take(pose, settings.n_frames)
    depth, incidence = ball_depth(pose)
    on_ball = np.isfinite(incidence)
    hole = on_ball & (np.nan_to_num(incidence, nan=9.0) < HIGHLIGHT)
    depths = burst.depths.copy()
    if draw.part == "plate" and settings.domain.sensor.preset != "high_accuracy":
        wrong = on_ball & ~hole & (np.random.default_rng(number).random(depth.shape) < 0.2)
        depths[:, wrong] += FALSE_M
    return BankedView(
        depths, camera_vector(CAMERA), pose.as_matrix(), on_ball, hole, depth, np.array(40.125 * 8 * 0.05)
    )


def write_banks(out: Path, preset: ThresholdsPreset) -> None:
    """All views of the budget, by every camera."""
    for bank in Study.of(out, preset).banks:
        folder = bank_folder(out, bank)
        folder.joinpath("views").mkdir(parents=True)
        for number in range(preset.budget.views):
            view = made_up_view(bank, number)
            draw = json.dumps(view_draw(preset.domain, preset.seed, number).model_dump(mode="json"))
            arrays = {field.name: np.asarray(getattr(view, field.name)) for field in fields(view)}
            write_arrays(view_file(folder, number), arrays | {"draw": np.frombuffer(draw.encode(), np.uint8)})
