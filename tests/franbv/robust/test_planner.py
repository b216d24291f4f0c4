"""Pieces of fra-robust in other planners: each changes what it names and nothing else."""

import numpy as np
import pytest

from franbv.frames import look_at
from franbv.model import model_of
from franbv.parameters import Parameters
from franbv.planners import fra, pb
from franbv.robust.evidence import EvidenceMap
from franbv.robust.hypothesis import Hypothesis
from franbv.robust.planner import fra_robust, little_to_gain, partly_robust
from franbv.robust.settings import RobustSettings
from franbv.sensing import DepthBurst
from franbv.stopping import StopReason
from franbv.voxel_map import empty_map
from tests.franbv.analytic_camera import AnalyticCamera
from tests.franbv.robust.mirror_camera import BOX, ROOM

PARAMETERS = Parameters(n_frames=1)


def model_after_one_view(planner):
    """The planner's model of one view of a plain box from the side of +x."""
    pose = look_at(np.array([0.3, 0.0, 0.2]), np.array([0.0, 0.0, 0.04]))
    burst = AnalyticCamera((BOX,), room=ROOM).capture(pose, 1)
    seed = np.random.SeedSequence(0)
    return model_of(planner.integrate(empty_map(PARAMETERS), burst, PARAMETERS), planner, PARAMETERS, seed), burst


def test_blocks_that_mix_near_and_far_are_no_points_of_the_cloud():
    """A pixel between a thin part and the table behind it; PB-NBV keeps it, and so do the views alone."""
    _, burst = model_after_one_view(pb())
    depth = np.full(burst.depths.shape[1:], 0.40)
    depth[:, 30:32], depth[:, 32] = 0.30, 0.35  # near, and the mean of near and far
    mixed = DepthBurst(depth[None], burst.intrinsics, burst.T_world_cam)
    for planner in (pb(), partly_robust(pb(), ("views",))):
        np.testing.assert_array_equal(planner.points(mixed, PARAMETERS), depth)
    for planner in (fra_robust(), partly_robust(fra(), ("map",))):
        kept = planner.points(mixed, PARAMETERS)
        assert not kept[:, 32].any()
        np.testing.assert_array_equal(np.delete(kept, 32, axis=1), np.delete(depth, 32, axis=1))


@pytest.mark.parametrize("base", [pb, fra])
def test_the_map_alone_leaves_the_choice_of_views(base):
    """The planner then has the evidence map, its own candidates, its own utility and its own recovery."""
    plain, changed = base(), partly_robust(base(), ("map",))
    model, _ = model_after_one_view(changed)
    assert isinstance(model.voxel_map, EvidenceMap)
    assert len(model.ellipsoids) > 0
    assert (changed.candidates, changed.score) == (plain.candidates, plain.score)
    assert (changed.recovery is None) == (plain.recovery is None)


def test_the_views_alone_work_on_the_papers_map():
    """They look at the far side of a box that one view has shown, whose surface hides it: the count of success is that
    of a run without any."""
    planner = partly_robust(pb(), ("views",))
    model, burst = model_after_one_view(planner)
    assert not isinstance(model.voxel_map, EvidenceMap)
    poses = [look_at(np.array([x, 0.0, 0.1]), np.array([0.0, 0.0, 0.04])) for x in (0.3, -0.3)]
    near, far = planner.score(model, burst.intrinsics, poses, PARAMETERS)
    assert far > 2 * near >= 0
    assert len(planner.candidates(model, PARAMETERS, 0.0)) > 2 * PARAMETERS.n_candidates


def test_it_ends_when_views_promise_little():
    """By hand: 0.5 % of a square metre are 50 cm^2; five views below that end it, four or a better one do not."""
    left = Hypothesis(
        *np.zeros((2, 0, 3)),
        np.zeros(0),
        np.zeros(0, bool),
        np.zeros(0),
        np.zeros((0, 2, 5)),
        np.zeros((2, 5)),
        surface_area=1.0,
    )
    poor, good = 0.0049 / 3, 0.0051 / 3

    def ends(*utilities: float):
        return little_to_gain(utilities, left, PARAMETERS, RobustSettings(least_gain=0.005, sensing_s=3.0))

    assert ends(good, *[poor] * 5) == StopReason.LITTLE_TO_GAIN
    assert ends(*[poor] * 4) is None
    assert ends(*[poor] * 4, good) is None
    assert ends(*[good] * PARAMETERS.max_iterations) == StopReason.MAX_ITERATIONS


def test_all_of_it_is_fra_robust():
    """It has no ellipsoids, which none of its steps looks at."""
    planner = fra_robust()
    model, _ = model_after_one_view(planner)
    assert (planner.name, len(model.ellipsoids)) == ("fra-robust", 0)
