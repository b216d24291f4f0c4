"""What the paper leaves open, read the other way: each setting does what it says, and the default is the text's."""

import numpy as np
import pytest

from franbv.geometry.oriented_box import axis_aligned_box
from franbv.parameters import Parameters
from franbv.planners import fra, integrate_burst
from franbv.reconstruction import reconstruct
from franbv.recovery import recovery_index
from franbv.reflective_regions import View, located
from franbv.sensing import DepthBurst
from franbv.stopping import stagnates
from franbv.utility import rank_weights
from franbv.voxel_map import empty_map
from tests.franbv.test_reconstruction import BOX, LOWER, ROOM, UPPER
from tests.franbv.test_reflective_regions import IDENTITY, SENSOR, burst, hole, spheres

DEFAULT = Parameters()
BEHIND = (([0.0, 0.0, 0.30], 0.03, False), ([0.0, 0.0, 0.45], 0.09, True))
"""An occupied sphere, and behind it a frontier one that is wider in the image."""


def read(**changes: object) -> Parameters:
    """The default readings with these changed."""
    return Parameters.model_validate(DEFAULT.model_dump() | changes)


def centre_pixel(parameters: Parameters) -> np.ndarray:
    """Where the pixel on the axis is placed."""
    pixels = np.zeros((40, 60), bool)
    pixels[19, 29] = True
    return located(View(burst(hole()), spheres(*BEHIND), parameters), pixels)[0]


def test_a_pixel_before_an_occupied_ellipsoid_is_refused_or_placed_behind_or_on_it():
    """On the axis the occupied sphere begins at 0.27 m, the frontier's at 0.36 m."""
    assert np.isnan(centre_pixel(DEFAULT)).all()
    np.testing.assert_allclose(centre_pixel(read(located_on="nearest_frontier")), [0, 0, 0.36], atol=1e-9)
    np.testing.assert_allclose(centre_pixel(read(located_on="any")), [0, 0, 0.27], atol=1e-9)


def test_the_silhouette_may_be_that_of_what_is_occupied():
    """Of two spheres the smaller, occupied one: 40 px x 0.03 / sqrt(0.30^2 - 0.03^2) = 4.02 px about the axis."""
    v, u = np.mgrid[:40, :60]
    for parameters, radius in (
        (read(silhouette_of="occupied"), 4.0202),
        (DEFAULT, 40 * 0.09 / np.sqrt(0.45**2 - 0.09**2)),
    ):
        seen = View(burst(hole()), spheres(*BEHIND), parameters).silhouette
        np.testing.assert_array_equal(seen, np.hypot(u - 29, v - 19) <= radius)


def test_every_frame_may_enter_the_map():
    """Two frames hit a voxel twice, their median once: 2 ln(0.7 / 0.3) against 1."""
    depths = np.full((2, 40, 60), 0.3, np.float32)
    seen = DepthBurst(depths, SENSOR, IDENTITY)
    once = integrate_burst(empty_map(read(workspace_max=(0.24, 0.24, 0.4))), seen, DEFAULT)
    twice = integrate_burst(empty_map(read(workspace_max=(0.24, 0.24, 0.4))), seen, read(frames_into_map="each"))
    assert once.log_odds.max() == pytest.approx(np.log(0.7 / 0.3))
    assert twice.log_odds.max() == pytest.approx(2 * np.log(0.7 / 0.3))
    np.testing.assert_array_equal(once.log_odds > 0, twice.log_odds > 0)


def test_one_hit_is_not_enough_where_more_is_asked_for():
    """At 0.7 the voxel of one hit stays uncertain, with a second one it is occupied; neither is it free."""
    strict = read(occupied_probability=0.7, workspace_max=(0.24, 0.24, 0.4))
    seen = DepthBurst(np.full((1, 40, 60), 0.3, np.float32), SENSOR, IDENTITY)
    once = integrate_burst(empty_map(strict), seen, strict)
    hit = once.log_odds > 0
    assert hit.any()
    assert not once.occupied.any()
    assert once.uncertain[hit].all()
    assert once.touched[hit].all()
    twice = integrate_burst(once, seen, strict)
    np.testing.assert_array_equal(twice.occupied, hit)
    with pytest.raises(ValueError, match="occupied_probability"):
        read(occupied_probability=0.4)


def test_weights_may_fall_as_the_harmonic_series():
    """1, 1/2, 1/3 by rank, in the place of 1, 1/2, 1/4."""
    rank = np.arange(3)
    np.testing.assert_allclose(rank_weights(rank, read(weighting="harmonic")), [1, 1 / 2, 1 / 3])
    np.testing.assert_allclose(rank_weights(rank, DEFAULT), [1, 1 / 2, 1 / 4])


def test_stagnation_against_the_last_value():
    """Five changes of 0.5 after 100, then near 2: below 1 % of the largest, far above 1 % of the last."""
    utilities = [100.0, 2.0, 2.5, 2.0, 2.5, 2.0, 2.5]
    assert stagnates(utilities, 0.01, 5)
    assert not stagnates(utilities, 0.01, 5, against_last=True)
    assert stagnates([2.0, *[1.99, 2.0] * 3], 0.01, 5, against_last=True)


def test_gamma_may_be_a_share_of_what_a_sheet_fills():
    """A flat region of 8 x 8 voxels across z, all 64 of its layer added: all of a sheet, and of N_cap a layer in three,
    10 x 10 x 3 voxels with the margin."""
    size = DEFAULT.voxel_size
    grid = empty_map(DEFAULT)
    low, high = np.array([0.0, 0.0, 10.0]) - 0.49, np.array([7.0, 7.0, 10.0]) + 0.49
    region = axis_aligned_box(low * size, high * size)
    before = np.zeros(grid.log_odds.shape, bool)
    now = before.copy()
    x, y, z = np.array([0, 0, 10]) - grid.first
    now[x : x + 8, y : y + 8, z] = True
    gamma, attained = recovery_index(before, now, region, grid, DEFAULT)
    assert gamma == pytest.approx(64 / 300)
    as_sheet, same = recovery_index(before, now, region, grid, read(capacity="sheet"))
    assert as_sheet == same == attained
    assert attained == pytest.approx(64 / 7.98**2)


def two_holes(points: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """Mirror-like patches at both ends of the top, of different size."""
    on_top = (points[:, 2] > UPPER[2] - 1e-6) & (np.abs(points[:, 1]) < 0.03)
    patches = ((points[:, 0] > LOWER[0] + 0.005) & (points[:, 0] < -0.01)) | (points[:, 0] > 0.015)
    return on_top & patches & (cosine > np.cos(np.radians(75)))


def recoveries_of_the_first_view(analytic_camera, free_arm, **changes: object) -> list:
    """Acquisitions of iteration 0 on a box with two holes in its top."""
    parameters = read(n_frames=3, max_iterations=1, recovered_share=1.0, **changes)
    camera = analytic_camera((BOX,), room=ROOM, hole=two_holes)
    run = reconstruct(camera, free_arm(), fra(), parameters, seed=1)
    return [a for a in run.acquisitions if a.nbv_iteration == 0]


def test_all_regions_of_a_burst_may_be_recovered(analytic_camera, free_arm):
    """The largest by four poses that all look at it; then, in the other reading, the next one by poses of its own. The
    acquisition that ends a recovery sets the next one off."""
    literal = recoveries_of_the_first_view(analytic_camera, free_arm)
    regions = literal[0].detection.boxes
    assert len(regions) > 1
    assert [a.activates for a in literal] == [True] + [False] * (len(literal) - 1)
    every = recoveries_of_the_first_view(analytic_camera, free_arm, regions_recovered="all")
    assert sum(a.activates for a in every) > 1
    targets = [a.recovery_poses.target for a in every if a.activates]
    assert all(
        np.linalg.norm(target - box.centre) <= box.half_diagonal for target, box in zip(targets, regions, strict=False)
    )
    assert len(every) > len(literal)


def test_a_recovery_s_last_burst_may_set_off_another(analytic_camera, free_arm):
    """With two in turn the last burst of the first recovery is searched too; with one no recovery's burst is."""
    once = recoveries_of_the_first_view(analytic_camera, free_arm)
    assert all(a.detection is None for a in once[1:])
    twice = recoveries_of_the_first_view(analytic_camera, free_arm, recoveries_in_turn=2)
    searched = [a.index for a in twice[1:] if a.detection is not None]
    n_first = len(twice[0].recovery_poses.poses)
    assert searched[0] == n_first
    assert twice[n_first].activates
    assert twice[n_first + 1].kind == "recovery"
    assert sum(a.activates for a in twice) == 2


def test_holes_may_be_held_against_the_ellipsoids_before_the_burst(analytic_camera, free_arm):
    """The first view has none before it, so that it finds nothing; later ones do."""
    parameters = read(n_frames=3, max_iterations=3, detection_ellipsoids="previous")
    camera = analytic_camera((BOX,), room=ROOM, hole=two_holes)
    run = reconstruct(camera, free_arm(), fra(), parameters, seed=1)
    assert not run.acquisitions[0].detection.silhouette.any()
    second = next(a for a in run.acquisitions if a.nbv_iteration == 1)
    assert second.detection.silhouette.any()
