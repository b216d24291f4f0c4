"""A view of the bank: its truth is that of the labels, and it is drawn once."""

from pathlib import Path

import numpy as np
import pytest

from render.d435i import SimulatedD435i
from render.labels.causes import is_of
from render.labels.labels import label_frame
from studies.run.scene_settings import build_subject
from studies.thresholds.bank import SAMPLING, ViewTask, bank_settings, do_view, read_banked_view
from studies.thresholds.config import Domain
from studies.thresholds.draw import subject_settings, view_pose

DOMAIN = Domain(parts={"D1": 1}, lamps={"workshop": 1})
N_FRAMES = 3


@pytest.fixture(scope="module")
def task(tmp_path_factory: pytest.TempPathFactory) -> ViewTask:
    """A rendered view of a polished part."""
    made = ViewTask(tmp_path_factory.mktemp("bank"), bank_settings(DOMAIN, 0, N_FRAMES), 0)
    assert do_view(made)
    return made


def test_its_truth_is_that_of_the_labels(task: ViewTask):
    """Holes by reflection and false depth of the whole burst, pixel by pixel, as its labels have them."""
    draw, view = read_banked_view(task)
    scene = build_subject(subject_settings(DOMAIN, draw)).scene
    camera = SimulatedD435i(scene, DOMAIN.sensor, draw.seed, SAMPLING)
    pose = view_pose(draw, scene, 0.0)
    measurement = camera.measure(pose, N_FRAMES)
    labels = label_frame(camera, pose, measurement)
    np.testing.assert_array_equal(view.depths, measurement.burst.depths)
    np.testing.assert_array_equal(view.reflective, is_of(labels.cause_decimated, "reflection"))
    np.testing.assert_array_equal(view.is_false(view.burst(N_FRAMES).median_depth()), labels.false_decimated)
    assert view.reflective.any()
    assert labels.false_decimated.any()
    assert 20 < view.part.sum() < view.part.size / 2


def test_it_is_drawn_once(task: ViewTask):
    """Another call leaves the file as it is; a mismatch that changes nothing of the scene makes no view."""
    before = task.file.stat().st_mtime_ns
    assert do_view(task)
    assert task.file.stat().st_mtime_ns == before
    dark = Domain(parts={"ball": 1}, materials={"nickel:bright": 1}, lamps={"off": 1})
    unmoved = ViewTask(task.folder, bank_settings(dark, 0, N_FRAMES), 1, "lamp_moved")
    assert not do_view(unmoved)
    assert not Path(unmoved.file).exists()
