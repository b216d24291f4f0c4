"""Utilities by hand: spheres and plates of known area on the optical axis, in every order of depth."""

from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.ellipsoids import Ellipsoids
from franbv.frames import Intrinsics, look_at
from franbv.geometry.oriented_box import OrientedBox
from franbv.parameters import Parameters
from franbv.utility import nearness, ranks, recovery_utility, view_utilities, view_utility

PARAMETERS = Parameters()
SENSOR = Intrinsics(60, 40, 40.0, 40.0, 29.5, 19.5)
IDENTITY = RigidTransform.identity()
RADIUS = 0.02


def spheres(depths, is_frontier) -> Ellipsoids:
    """Equal spheres on the optical axis of a camera at the origin that looks along z."""
    n = len(depths)
    centres = np.zeros((n, 3))
    centres[:, 2] = depths
    return Ellipsoids(centres, np.tile(RADIUS**2 * np.eye(3), (n, 1, 1)), np.array(is_frontier))


def circle(depth: float) -> float:
    """Area of such a sphere's image [px^2]: radius f r / sqrt(D^2 - r^2)."""
    return np.pi * SENSOR.fx**2 * RADIUS**2 / (depth**2 - RADIUS**2)


def test_rank_is_not_the_sorting_order():
    """Depths 0.3, 0.1, 0.2 m rank 2, 0, 1; argsort gives 1, 2, 0, which is who comes first and not a rank."""
    np.testing.assert_array_equal(ranks(np.array([0.3, 0.1, 0.2])), [2, 0, 1])
    np.testing.assert_array_equal(ranks(np.array([[0.3, 0.1, 0.2], [1.0, 2.0, 3.0]])), [[2, 0, 1], [0, 1, 2]])
    np.testing.assert_array_equal(ranks(np.array([0.2, 0.1, 0.2])), [1, 0, 2])


@pytest.mark.parametrize("order", list(permutations([0.2, 0.3, 0.5])))
def test_utility_by_hand(order):
    """The nearest counts whole, the next half, the third a quarter, whatever their order in the list and their kind."""
    kinds = [True, False, True]
    weight = {0.2: 1.0, 0.3: 0.5, 0.5: 0.25}
    expected = sum((1 if kind else -1) * weight[d] * circle(d) for d, kind in zip(order, kinds, strict=True))
    assert view_utility(spheres(order, kinds), SENSOR, IDENTITY, PARAMETERS) == pytest.approx(expected)


def test_occupied_and_frontier_are_ranked_together():
    """Were each kind ranked by itself, both spheres would count whole."""
    utility = view_utility(spheres([0.2, 0.4], [False, True]), SENSOR, IDENTITY, PARAMETERS)
    assert utility == pytest.approx(-circle(0.2) + 0.5 * circle(0.4))


def test_weight_base_one_turns_the_weights_off():
    """With weights of 1 the utility is the plain difference of areas."""
    flat = PARAMETERS.model_copy(update={"weight_base": 1.0})
    utility = view_utility(spheres([0.2, 0.4], [False, True]), SENSOR, IDENTITY, flat)
    assert utility == pytest.approx(circle(0.4) - circle(0.2))


def test_what_is_behind_the_camera_takes_no_rank():
    """A sphere wholly behind has no area and hides nothing: the one in front still counts whole."""
    both = spheres([-0.3, 0.4], [False, True])
    np.testing.assert_array_equal(nearness(both, IDENTITY, "depth"), [np.inf, 0.4])
    assert view_utility(both, SENSOR, IDENTITY, PARAMETERS) == pytest.approx(circle(0.4))


@pytest.mark.parametrize(("rank_by", "weight"), [("distance", 1.0), ("depth", 0.5)])
def test_rank_is_by_distance_unless_depth_is_asked_for(rank_by, weight):
    """A sphere at z = 0.3 m, 0.3 m aside (distance 0.42 m, out of the image), is farther than one at z = 0.4 m on the
    axis: by distance (paper, below eq. (2)) that one counts whole, by depth half."""
    pair = spheres([0.4, 0.3], [True, True])
    pair.centres[1, 0] = 0.3
    parameters = PARAMETERS.model_copy(update={"rank_by": rank_by})
    assert view_utility(pair, SENSOR, IDENTITY, parameters) == pytest.approx(weight * circle(0.4))


@pytest.mark.parametrize(("rank_by", "weight"), [("distance", 0.5), ("depth", 1.0)])
def test_region_is_ranked_by_the_same_measure(rank_by, weight):
    """A plate at z = 0.25 m, 0.12 m aside (distance 0.277 m), beside a sphere at z = 0.26 m on the axis."""
    plate = OrientedBox(np.array([0.12, 0.0, 0.25]), np.eye(3), np.array([0.02, 0.02, 1e-9]))
    parameters = PARAMETERS.model_copy(update={"rank_by": rank_by})
    found = recovery_utility(spheres([0.26], [True]), plate, SENSOR, IDENTITY, parameters)
    assert found == pytest.approx((1.5 - weight) * circle(0.26) + weight * 6.4**2)


def test_many_poses_are_as_each_alone():
    """The batch equals the single calls, in order; no poses, no utilities."""
    rng = np.random.default_rng(0)
    bodies = spheres(rng.uniform(-0.1, 0.1, 6), rng.uniform(size=6) < 0.5)
    poses = [look_at(np.array([0.3 * np.cos(a), 0.3 * np.sin(a), 0.2]), np.zeros(3)) for a in range(7)]
    alone = [view_utility(bodies, SENSOR, pose, PARAMETERS) for pose in poses]
    np.testing.assert_allclose(view_utilities(bodies, SENSOR, poses, PARAMETERS), alone)
    assert view_utilities(bodies, SENSOR, [], PARAMETERS).shape == (0,)


def test_nothing_known_has_no_utility():
    """No ellipsoids: 0 for every pose."""
    nothing = spheres([], np.zeros(0, bool))
    np.testing.assert_array_equal(view_utilities(nothing, SENSOR, [IDENTITY, IDENTITY], PARAMETERS), [0.0, 0.0])


@pytest.mark.parametrize("kind", [True, False])
def test_recovery_utility_by_hand(kind):
    """A plate of 4 x 4 cm at 0.25 m covers (40 * 0.04 / 0.25)^2 px^2; it is ranked by its centre among the spheres.

    Between spheres at 0.2 and 0.4 m it counts half and makes the farther one count a quarter; it always adds.
    """
    plate = OrientedBox(np.array([0.0, 0.0, 0.25]), np.eye(3), np.array([0.02, 0.02, 1e-9]))
    pair = spheres([0.4, 0.2], [True, kind])
    expected = 0.25 * circle(0.4) + (1 if kind else -1) * circle(0.2) + 0.5 * 6.4**2
    assert recovery_utility(pair, plate, SENSOR, IDENTITY, PARAMETERS) == pytest.approx(expected)


def test_recovery_utility_of_a_region_out_of_sight():
    """Behind the camera the region adds nothing and takes no rank: U_r = U."""
    behind = OrientedBox(np.array([0.0, 0.0, -0.25]), np.eye(3), np.array([0.02, 0.02, 0.01]))
    pair = spheres([0.4, 0.2], [True, False])
    assert recovery_utility(pair, behind, SENSOR, IDENTITY, PARAMETERS) == pytest.approx(
        view_utility(pair, SENSOR, IDENTITY, PARAMETERS)
    )
