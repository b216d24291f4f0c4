"""The four filters on hand-made bursts and spheres, then clusters and boxes."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.ellipsoids import Ellipsoids
from franbv.frames import Intrinsics, look_at
from franbv.parameters import Parameters
from franbv.reflective_regions import (
    FILTERS,
    View,
    detect_reflective_regions,
    first_hit_is_frontier,
    first_hit_of_any,
    group_into_boxes,
    inside_eroded_silhouette,
    inside_silhouette,
    invalid_share,
    persistent_invalid,
)
from franbv.sensing import DepthBurst

PARAMETERS = Parameters()
SENSOR = Intrinsics(60, 40, 40.0, 40.0, 29.0, 19.0)
"""The pixel (29, 19) looks along the optical axis."""
IDENTITY = RigidTransform.identity()
SIZE = PARAMETERS.voxel_size


def spheres(*bodies) -> Ellipsoids:
    """(centre, radius, is_frontier) of each."""
    centres, radii, kinds = zip(*bodies, strict=True)
    return Ellipsoids(np.array(centres, float), np.array([r**2 * np.eye(3) for r in radii]), np.array(kinds))


def burst(valid, n_frames: int = 4, T: RigidTransform = IDENTITY) -> DepthBurst:
    """The same frame n times: 0.3 m where valid."""
    return DepthBurst(np.tile(np.where(valid, 0.3, 0.0).astype(np.float32), (n_frames, 1, 1)), SENSOR, T)


def hole(u=slice(None), v=slice(None)):
    """A frame that is valid but for the given columns and rows."""
    valid = np.ones((40, 60), bool)
    valid[v, u] = False
    return valid


SPHERE = ([0.0, 0.0, 0.3], 0.06)
"""Its silhouette: pixels within f r / sqrt(D^2 - r^2) = 8.16 px of (29, 19)."""


def disc() -> np.ndarray:
    """Pixels of the silhouette of SPHERE."""
    v, u = np.mgrid[:40, :60]
    return np.hypot(u - 29, v - 19) <= 40 * 0.06 / np.sqrt(0.3**2 - 0.06**2)


def test_invalid_share_counts_zeros():
    """Zeros in 0, 1, 2 and 3 of 4 frames: eta = 0, 1/4, 1/2, 3/4; eq. (6)."""
    depths = np.full((4, 1, 4), 0.3, np.float32)
    for pixel in range(4):
        depths[:pixel, 0, pixel] = 0.0
    np.testing.assert_array_equal(invalid_share(depths), [[0.0, 0.25, 0.5, 0.75]])


def test_confidence_map_begins_at_one_half():
    """eta >= 0.5, one half included, as in eq. (7); with 15 frames that is 8 of them."""
    nobody = Ellipsoids(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros(0, bool))
    for n, least in ((4, 2), (15, 8)):
        depths = np.full((n, 1, n + 1), 0.3, np.float32)
        for pixel in range(n + 1):
            depths[:pixel, 0, pixel] = 0.0
        view = View(DepthBurst(depths, Intrinsics(n + 1, 1, 40.0, 40.0, 0.0, 0.0), IDENTITY), nobody, PARAMETERS)
        np.testing.assert_array_equal(persistent_invalid(view)[0], np.arange(n + 1) >= least)


def test_silhouette_holds_both_kinds_of_ellipsoid():
    """I_o is the union over E_o and E_f: two spheres side by side make two discs."""
    bodies = spheres(([-0.1, 0.0, 0.3], 0.04, True), ([0.1, 0.0, 0.3], 0.04, False))
    mask = inside_silhouette(View(burst(hole()), bodies, PARAMETERS))
    centre = 40 * 0.1 / 0.3
    assert mask[19, round(29 - centre)]
    assert mask[19, round(29 + centre)]
    assert not mask[19, 29]


def test_interior_is_eroded_by_the_four_neighbours():
    """A pixel stays if all four neighbours are in I_o, and none is beyond the image: brute force over pixels."""
    for body in (SPHERE, ([0.2, 0.1, 0.3], 0.1)):  # the second is cut by two edges of the image
        view = View(burst(hole()), spheres((*body, True)), PARAMETERS)
        inside = np.pad(view.silhouette, 1)
        expected = view.silhouette & inside[:-2, 1:-1] & inside[2:, 1:-1] & inside[1:-1, :-2] & inside[1:-1, 2:]
        np.testing.assert_array_equal(inside_eroded_silhouette(view), expected)
        assert expected.sum() < view.silhouette.sum()
    assert not inside_eroded_silhouette(view)[:, -1].any()


@pytest.mark.parametrize(
    ("bodies", "depth"),
    [
        ([(*SPHERE, True)], 0.24),  # one frontier sphere: met at D - r
        ([(*SPHERE, False)], None),  # one occupied sphere: refused
        ([(*SPHERE, False), ([0, 0, 0.2], 0.03, True)], 0.17),  # frontier before occupied
        ([(*SPHERE, True), ([0, 0, 0.2], 0.03, False)], None),  # occupied before frontier
        ([(*SPHERE, True), ([0, 0, 0.5], 0.03, False)], 0.24),  # occupied behind frontier
        ([(*SPHERE, False), ([0, 0, 0.29], 0.06, True)], 0.23),  # overlapping: surfaces decide, not centres
        ([([0.2, 0, 0.3], 0.03, True)], None),  # missed
        ([([0, 0, 0.0], 0.1, True)], 0.1),  # from within: on the way out
        ([([0, 0, -0.3], 0.1, True), (*SPHERE, True)], 0.24),  # behind the camera nothing is met
    ],
)
def test_first_hit_by_hand(bodies, depth):
    """The pixel on the axis, for a camera anywhere: its place, or NaN if the first thing it meets is not frontier."""
    axis = np.zeros((40, 60), bool)
    axis[19, 29] = True
    for T in (IDENTITY, look_at(np.array([0.3, -0.2, 0.4]), np.array([0.0, 0.0, 0.1]))):
        moved = spheres(*((T.apply(np.array(c, float)), r, kind) for c, r, kind in bodies))
        view = View(burst(hole(), T=T), moved, PARAMETERS)
        point = first_hit_is_frontier(view, axis)
        expected = np.full(3, np.nan) if depth is None else T.apply([0.0, 0.0, depth])
        np.testing.assert_allclose(point, [expected], atol=1e-9)


def test_without_the_frontier_test_any_ellipsoid_will_do():
    """For the ablation occupied ellipsoids give places too; a miss still gives none."""
    axis = np.zeros((40, 60), bool)
    axis[19, [0, 29]] = True
    view = View(burst(hole()), spheres((*SPHERE, False)), PARAMETERS)
    np.testing.assert_allclose(first_hit_of_any(view, axis), [[np.nan] * 3, [0, 0, 0.24]], atol=1e-9)


def test_detection_by_hand():
    """A hole of columns 25 to 34, all rows, before a frontier sphere.

    I is the hole, I_o the disc, I_c their common part whose neighbours lie in the disc. All of these meet the sphere,
    in one piece, so that one box holds them; their pixels are (u, v), and the points project back to them.
    """
    detection = detect_reflective_regions(burst(hole(u=slice(25, 35))), spheres((*SPHERE, True)), PARAMETERS)
    padded = np.pad(disc(), 1)
    interior = disc() & padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:]
    candidates = interior & ~hole(u=slice(25, 35))
    np.testing.assert_array_equal(detection.confidence_map, ~hole(u=slice(25, 35)))
    np.testing.assert_array_equal(detection.silhouette, disc())
    np.testing.assert_array_equal(detection.candidates, candidates)
    np.testing.assert_array_equal(detection.retained, candidates)
    assert len(detection.points) == candidates.sum() > 100
    np.testing.assert_allclose(np.linalg.norm(detection.points - SPHERE[0], axis=1), SPHERE[1])
    u, v = detection.pixels.T
    assert candidates[v, u].all()
    np.testing.assert_allclose(40.0 * detection.points[:, :2] / detection.points[:, 2:] + [29, 19], detection.pixels)
    assert len(detection.boxes) == 1
    assert detection.boxes[0].contains(detection.points).all()
    np.testing.assert_array_equal(detection.labels, 0)


def test_what_is_seen_now_and_then_is_no_hole():
    """A pixel that is invalid in 1 of 4 frames, or invalid off the object, or on its rim, is no candidate."""
    frames = np.tile(np.float32(0.3), (4, 40, 60))
    frames[0, 19, 29] = 0.0
    frames[:, 2, 2] = 0.0
    frames[:, 19, 29 + 8] = 0.0  # in the disc, its right neighbour not
    detection = detect_reflective_regions(DepthBurst(frames, SENSOR, IDENTITY), spheres((*SPHERE, True)), PARAMETERS)
    assert detection.silhouette[19, 37]
    assert not detection.candidates.any()
    assert detection.boxes == ()
    assert detection.points.shape == (0, 3)
    assert detection.pixels.shape == (0, 2)


def test_filters_can_be_left_out_and_replaced():
    """Each filter's mask stands by itself; without the erosion the rim counts, with another locator its places do."""
    seen, bodies = burst(hole(u=slice(25, 35))), spheres((*SPHERE, False))
    everything = detect_reflective_regions(seen, bodies, PARAMETERS)
    assert list(everything.masks) == ["persistent_invalid", "inside_silhouette", "inside_eroded_silhouette"]
    assert everything.candidates.any()
    assert not everything.retained.any()  # the sphere is an occupied one
    uneroded = {name: keeps for name, keeps in FILTERS.items() if name != "inside_eroded_silhouette"}
    kept = detect_reflective_regions(seen, bodies, PARAMETERS, uneroded, first_hit_of_any)
    np.testing.assert_array_equal(kept.candidates, disc() & ~hole(u=slice(25, 35)))
    np.testing.assert_array_equal(kept.retained, kept.candidates)

    def half_a_metre_ahead(view, pixels):
        return view.burst.T_world_cam.apply(0.5 * view.burst.intrinsics.pixel_directions()[pixels])

    moved = detect_reflective_regions(seen, bodies, PARAMETERS, locate=half_a_metre_ahead)
    np.testing.assert_allclose(moved.points[:, 2], 0.5)
    assert moved.retained.sum() == everything.candidates.sum()
    none = detect_reflective_regions(seen, bodies, PARAMETERS, {}, first_hit_of_any)
    np.testing.assert_array_equal(none.retained, disc())


def test_filters_without_a_name_of_their_own_are_told_apart():
    """Filters go by their key: of two lambdas each has its own mask, and a candidate passes both."""
    rows, columns = np.indices((40, 60))
    filters = {"left": lambda view: columns < 30, "top": lambda view: rows < 20}
    detection = detect_reflective_regions(burst(hole()), spheres((*SPHERE, True)), PARAMETERS, filters)
    assert {name: mask.sum() for name, mask in detection.masks.items()} == {"left": 40 * 30, "top": 20 * 60}
    assert detection.candidates.sum() == 20 * 30


def test_nothing_known_nothing_found():
    """Without ellipsoids there is no silhouette, hence no region."""
    nobody = Ellipsoids(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros(0, bool))
    detection = detect_reflective_regions(burst(np.zeros((40, 60), bool)), nobody, PARAMETERS)
    assert detection.confidence_map.all()
    assert not detection.silhouette.any()
    assert detection.boxes == ()


def patch(nx: int, ny: int, corner) -> np.ndarray:
    """A flat grid of points one voxel apart."""
    return np.array([[x * SIZE, y * SIZE, 0.0] for x in range(nx) for y in range(ny)]) + np.array(corner)


def test_clusters_and_boxes_by_hand():
    """A 3 x 3 and a 6 x 4 patch and two strays: two boxes, the larger first, strays left out.

    Flat sets get a thickness of one voxel: volumes 2 x 2 x 1 and 5 x 3 x 1 voxels.
    """
    points = np.concatenate([patch(3, 3, [0, 0, 0.1]), [[0.5, 0.5, 0.5]], patch(6, 4, [0.2, 0, 0.1]), [[-0.5, 0, 0]]])
    labels, boxes = group_into_boxes(points, PARAMETERS)
    np.testing.assert_array_equal(labels, [1] * 9 + [-1] + [0] * 24 + [-1])
    np.testing.assert_allclose([box.volume / SIZE**3 for box in boxes], [15.0, 4.0])
    for k, box in enumerate(boxes):
        np.testing.assert_array_equal(box.contains(points), labels == k)


@pytest.mark.parametrize(("gap", "n_regions"), [(1.99, 1), (2.01, 2)])
def test_two_voxels_apart_is_one_region(gap, n_regions):
    """DBSCAN's eps is two voxels: lines of points whose ends are nearer belong together.

    At half a voxel apart the end of a line has four neighbours within eps, so that the region grows through it.
    """
    line = np.array([[x * SIZE / 2, 0.0, 0.0] for x in range(9)])
    points = np.concatenate([line, line + np.array([(4 + gap) * SIZE, 0.0, 0.0])])
    assert len(group_into_boxes(points, PARAMETERS)[1]) == n_regions


@pytest.mark.parametrize(("n", "n_regions"), [(4, 0), (5, 1)])
def test_five_points_make_a_region(n, n_regions):
    """min_samples is 5: four neighbouring points are noise."""
    points = np.array([[x * SIZE / 2, 0.0, 0.0] for x in range(n)])
    assert len(group_into_boxes(points, PARAMETERS)[1]) == n_regions


def test_one_point_seen_by_all_pixels_has_a_box():
    """Even coinciding points have a box: a cube of one voxel."""
    labels, boxes = group_into_boxes(np.zeros((6, 3)), PARAMETERS)
    np.testing.assert_allclose(2 * boxes[0].half_extents, SIZE)
    np.testing.assert_array_equal(labels, 0)


@pytest.mark.parametrize("locate", [first_hit_is_frontier, first_hit_of_any])
def test_nothing_known_gives_no_region(locate):
    """Before the first voxel is occupied there is no ellipsoid: whatever the filters keep, no ray meets one."""
    nothing = Ellipsoids(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros(0, bool))
    found = detect_reflective_regions(
        burst(hole()), nothing, PARAMETERS, {"persistent_invalid": persistent_invalid}, locate
    )
    assert found.candidates.all()
    assert not found.retained.any()
    assert found.boxes == ()
