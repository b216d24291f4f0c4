"""Object and frontier out of hand-made maps."""

import numpy as np
import pytest

from franbv.object_model import large_components, object_model, object_points
from franbv.parameters import Parameters
from franbv.voxel_map import VoxelMap, empty_map

PARAMETERS = Parameters(voxel_size=0.01, workspace_min=(-0.1, -0.1, -0.02), workspace_max=(0.1, 0.1, 0.1))
TABLE = 2
"""Index of the layer centred on z = 0."""


def _scene():
    """A map that is free everywhere, with a table and a 4 x 4 x 3 block of uncertain voxels on it whose top is seen."""
    grid = empty_map(PARAMETERS)
    log_odds = np.full(grid.log_odds.shape, -1.0)
    log_odds[:, :, :TABLE] = 0.0
    log_odds[:, :, TABLE] = 1.0
    log_odds[8:12, 8:12, TABLE + 1 : TABLE + 4] = 0.0
    log_odds[8:12, 8:12, TABLE + 3] = 1.0
    return VoxelMap(grid.first, grid.voxel_size, log_odds)


def test_table_goes_and_the_object_stays():
    """The 16 top voxels are the object; its frontier is the ring of 12 uncertain side voxels just below them.

    The bottom side voxels touch free and table voxels, but the table is no object; the 4 inner ones touch nothing free.
    """
    model = object_model(_scene(), PARAMETERS)
    assert (len(model.occupied), len(model.frontier)) == (16, 12)
    np.testing.assert_allclose(model.occupied[:, 2], 0.03)
    np.testing.assert_allclose(model.frontier[:, 2], 0.02)
    assert not model.is_prior


def test_box_encloses_object_and_frontier_voxels():
    """Object and frontier fill 4 x 4 x 2 voxels of 1 cm: the box is 4 x 4 x 2 cm around (-0.005, -0.005, 0.025)."""
    box = object_model(_scene(), PARAMETERS).box
    np.testing.assert_allclose(box.half_extents, [0.02, 0.02, 0.01])
    np.testing.assert_allclose(box.centre, [-0.005, -0.005, 0.025], atol=1e-12)


def test_nothing_seen_leaves_the_prior_box():
    """A bare table is no object: the prior box stands in."""
    scene = _scene()
    scene.log_odds[:, :, TABLE + 1 :] = -1.0
    for grid in (empty_map(PARAMETERS), scene):
        model = object_model(grid, PARAMETERS)
        assert model.is_prior
        assert len(model.occupied) == len(model.frontier) == 0
        np.testing.assert_allclose(model.box.centre, [0.0, 0.0, 0.06])


@pytest.mark.parametrize(("floater", "kept"), [(4, False), (5, False), (9, False), (10, True)])
def test_floaters_are_dropped_by_size_and_share(floater, kept):
    """Beside a component of 100 voxels, one of 10 stays (10 %) and 9 goes; below 5 voxels none ever stays."""
    mask = np.zeros((30, 30, 3), bool)
    mask[:10, :10, 0] = True
    mask[20, :floater, 2] = True
    assert large_components(mask, 5, 0.1).sum() == 100 + floater * kept
    assert large_components(mask[15:], 5, 0.1).sum() == (floater if floater >= 5 else 0)


def test_diagonal_contact_connects():
    """26-connected: voxels that share only a corner are one component."""
    mask = np.zeros((6, 6, 6), bool)
    mask[np.arange(6), np.arange(6), np.arange(6)] = True
    assert large_components(mask, 6, 0.1).sum() == 6
    assert large_components(np.zeros((3, 3, 3), bool), 1, 0.1).sum() == 0


def test_object_points_are_cut_like_the_voxels():
    """Points in the table layer (|z| <= 5 mm), outside the workspace and below the table are not the object's."""
    points = np.array([[0.0, 0, 0.004], [0, 0, 0.006], [0.09, 0, 0.05], [0.2, 0, 0.05], [0, 0, -0.01]])
    np.testing.assert_allclose(object_points(points, empty_map(PARAMETERS), PARAMETERS), points[1:3])
