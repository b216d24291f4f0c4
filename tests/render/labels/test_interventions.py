"""Measured again with one thing changed: what is said of a few pixels is what is said of them among all."""

import numpy as np

from franbv.frames import look_at
from render.d435i import SimulatedD435i
from render.labels.interventions import matched_without_shadows
from render.labels.twin import twin_scene
from render.sensor import SensorSettings
from scenes.build import part_scene

POSE = look_at(np.array([0.3, -0.2, 0.35]), np.array([0.0, 0.0, 0.05]))
FORGOTTEN = 0.005
"""Share of the pixels that may tell where the matcher's paths began (`render.matcher.interface.PATH_MARGIN`)."""


def test_a_few_pixels_are_judged_as_among_all():
    """Those in the projector's shadow, by a matcher that is asked for the smallest window around them."""
    camera = SimulatedD435i(twin_scene(part_scene("D1")), SensorSettings(crop=None))
    measurement, truth = camera.measure(POSE, 1), camera.truth(POSE)
    some = (truth.depth > 0) & (truth.depth < 0.6) & ~truth.visible_from_projector
    rows, columns = np.nonzero(some)
    assert np.ptp(rows) < 240
    assert np.ptp(columns) < 400
    few, among_all = (
        matched_without_shadows(camera, measurement, truth, pixels) for pixels in (some, np.ones_like(some))
    )
    assert few.any()
    assert not few[~some].any()
    assert np.mean(few[some] != among_all[some]) < FORGOTTEN
