"""Which depths are believed by themselves."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics, look_at, rolled
from franbv.parameters import Parameters
from franbv.robust.scans import incidence_cosines, mixed_blocks, quarter_turns, scan_of, supporting_neighbours
from franbv.robust.settings import RobustSettings
from franbv.sensing import DepthBurst
from tests.franbv.analytic_camera import SENSOR


def test_a_block_between_near_and_far_is_mixed():
    """The column between a part at 0.3 m and a wall at 0.6 m; neither side, nor where there is no depth."""
    depth = np.full((5, 7), 0.3)
    depth[:, 4:] = 0.6
    depth[:, 3] = [0.35, 0.4, 0.0, 0.5, 0.305]
    expected = np.zeros((5, 7), bool)
    expected[[0, 1, 3], 3] = True
    np.testing.assert_array_equal(mixed_blocks(depth, 0.012), expected)


def test_a_slanted_plane_is_not_mixed():
    """Five millimetres from pixel to pixel, half of the step."""
    assert not mixed_blocks(0.3 + 0.005 * np.arange(8)[None] * np.ones((6, 1)), 0.012).any()


def test_support_by_hand():
    """Eight in the middle, five at an edge, none without depth, and the lone floater has none."""
    depth = np.zeros((5, 5))
    depth[:, :3] = 0.3
    depth[2, 4] = 0.3
    found = supporting_neighbours(depth, 0.01)
    assert (found[2, 1], found[2, 0], found[0, 0], found[2, 4], found[2, 3]) == (8, 5, 3, 0, 0)


def test_trust_of_a_scan():
    """Whole inside the part, less at its corner and for mixed blocks."""
    frame = np.full((40, 60), 0.6, np.float32)
    frame[10:30, 20:40] = 0.3
    frame[10:30, 40] = 0.45
    settings = RobustSettings()
    scan = scan_of(DepthBurst(frame[None], SENSOR, RigidTransform.identity()), Parameters(), settings)
    assert scan.trust[20, 30] == 1.0
    assert scan.trust[10, 20] == settings.unsupported_trust
    assert scan.trust[20, 40] == settings.mixed_trust
    np.testing.assert_allclose(np.linalg.norm(scan.rays, axis=1), 1.0)
    middle = 20 * 60 + 30
    assert scan.lengths[middle] == pytest.approx(0.3, rel=1e-3)  # next to the optical axis


@pytest.mark.parametrize(("roll", "turn"), [(0, 0), (90, 1), (180, 0), (-90, 1), (30, 0), (60, 1)])
def test_quarter_turns(roll: float, turn: int):
    """Upright or on end, whichever is nearer."""
    assert quarter_turns(rolled(look_at(np.array([0.3, 0.1, 0.2]), np.zeros(3)), roll)) == turn


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0, 60.0, 75.0])
def test_incidence_on_a_tilted_plane(tilt_deg: float):
    """Exact on a plane, whatever the pixel; 1 where a neighbour is missing."""
    camera = Intrinsics(24, 18, 40.0, 42.0, 11.0, 9.0)
    tilt = np.radians(tilt_deg)
    normal = np.array([np.sin(tilt) * 0.6, np.sin(tilt) * 0.8, -np.cos(tilt)])
    rays = camera.pixel_directions()
    depth = -0.3 * np.cos(tilt) / (rays @ normal)
    depth[(depth < 0) | (depth > 5)] = 0.0
    depth[4, 5] = 0.0
    found = incidence_cosines(depth, camera)
    expected = np.abs(rays @ normal) / np.linalg.norm(rays, axis=-1)
    told = found != 1.0
    assert told.sum() > 80
    np.testing.assert_allclose(found[told], expected[told], atol=1e-9)
    assert found[4, 4] == found[4, 6] == found[3, 5] == found[0, 0] == 1.0
