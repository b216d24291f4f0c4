"""Out of range by closed form: what lies nearer than f B / (126 + s) or farther than f B / s cannot be measured."""

import numpy as np
import pytest

from render.d435i import SimulatedD435i
from render.labels.causes import Cause
from render.labels.geometric import geometry, in_projector_field
from render.sensor import SensorSettings
from render.world.rig import camera_rig
from render.world.truth import Truth
from tests.physics.simple_scenes import wall

SHAPE = (360, 640)


def slope(nearest: float, farthest: float) -> Truth:
    """A surface whose depth rises from the first to the last row, seen by both imagers and lit [m]."""
    depth = np.repeat(np.linspace(nearest, farthest, SHAPE[0], dtype=np.float32)[:, None], SHAPE[1], axis=1)
    seen, zeros = np.ones(SHAPE, bool), np.zeros(SHAPE, np.float32)
    normal = np.zeros((*SHAPE, 3), np.float32)
    return Truth(depth, normal, zeros, np.zeros(SHAPE, np.uint8), seen, seen, seen)


@pytest.mark.parametrize("shift", [0, 20])
def test_a_disparity_shift_moves_both_ends(shift):
    """16.05 / 126 = 127 mm and no end without a shift; 16.05 / 146 = 110 mm to 16.05 / 20 = 803 mm with 20 px."""
    settings = SensorSettings(preset=f'{{"param-disparityshift": {shift}}}')
    truth = slope(0.08, 1.5)
    beyond = geometry(SimulatedD435i(wall(1.0), settings), truth).impossible == Cause.OUT_OF_RANGE
    expected = (truth.depth < 16.05 / (126 + shift)) | (truth.depth > (16.05 / shift if shift else np.inf))
    np.testing.assert_array_equal(beyond, expected)


def test_the_projector_s_field_is_the_model_s():
    """Across the axis of the projector, the D415's light ends at tan 33.5 deg and tan 20.5 deg: 0.66 and 0.37 m at 1 m,
    27.5 mm to the right of the left imager."""
    rig = camera_rig("d415", "1280x720")
    lit = in_projector_field(rig, np.full((720, 1280), 1.0, np.float32))
    columns, rows = np.flatnonzero(lit[360]), np.flatnonzero(lit[:, 640])
    left = rig.intrinsics.cx + rig.intrinsics.fx * (0.0275 - np.tan(np.radians(33.5)))
    assert columns[0] == pytest.approx(left, abs=1)
    assert len(rows) == pytest.approx(2 * rig.intrinsics.fx * np.tan(np.radians(20.5)), abs=2)
