"""The D4-like matcher against the plain float reading of its recipe, on rendered frames of matte and metal parts."""

from dataclasses import replace

import numpy as np
import pytest

from franbv.candidates import first_view
from franbv.parameters import Parameters
from render.d435i import SensorSettings, SimulatedD435i
from render.matcher.d4.decision import select
from render.matcher.d4.matcher import gather
from render.matcher.d4.settings import PROTOTYPE, D4Settings
from render.matcher.interface import N_DISPARITIES
from scenes.build import part_scene
from scenes.parts import EARLIER_PARTS
from tests.render.matcher.d4_reference import match_reference

STEP = 1 / 32
"""Disparity step of the matcher [px]."""
CROP = np.s_[130:210, 200:440]
"""Around the part in the first view; the reference is too slow for more."""


@pytest.fixture(scope="module", params=EARLIER_PARTS)
def rendered_pair(request):
    camera = SimulatedD435i(part_scene(request.param), SensorSettings(crop=None), seed=1)
    measured = camera.measure(first_view(Parameters(), 0.0), 1)
    return measured.lefts[0][CROP], measured.rights[0][CROP]


@pytest.mark.slow
@pytest.mark.parametrize(
    "settings", [D4Settings(), replace(PROTOTYPE, subpixel="totals")], ids=["default", "prototype"]
)
def test_streaming_equals_whole_volumes_on_rendered_frames(rendered_pair, settings):
    """16-bit streaming and whole float64 volumes: the same holes (IoU 0.97) and the same disparities (99 % within a
    step), before the neighbour count and the fit along surfaces, which are checked on their own."""
    left, right = rendered_pair
    reference = match_reference(left, right, N_DISPARITIES, settings)
    found = select(gather(left, right, 0, N_DISPARITIES, settings), N_DISPARITIES, settings) * STEP
    holes, reference_holes = found == 0, reference == 0
    assert 0.05 < reference_holes.mean() < 0.95
    assert np.sum(holes & reference_holes) / np.sum(holes | reference_holes) >= 0.97
    both = ~holes & ~reference_holes
    assert np.mean(np.abs(found - reference)[both] <= STEP) >= 0.99
