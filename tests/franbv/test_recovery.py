"""Recovery poses on faces that point along the world's axes, and Gamma on patches of voxels, all by hand."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from franbv.frames import look_at
from franbv.geometry.oriented_box import OrientedBox
from franbv.parameters import Parameters
from franbv.recovery import (
    diamond_poses,
    diamond_positions,
    largest_face,
    recovery_index,
    sheet_voxels,
    tangents,
    voxels_in,
)
from franbv.voxel_map import VoxelMap

PARAMETERS = Parameters()
SIZE = PARAMETERS.voxel_size
MIN_Z = 0.127
"""127 mm, of the 640x360 profile."""
CENTRE = np.array([0.02, 0.01, 0.15])
X, Y, Z = np.eye(3)


def always(T):
    """An arm that stands anywhere."""
    return True


def plate(thin: int, centre=CENTRE, sides=(0.04, 0.03, 0.01)) -> OrientedBox:
    """A plate whose shortest side runs along the given world axis."""
    return OrientedBox(np.array(centre, float), np.roll(np.eye(3), -(thin + 1), axis=1), np.array(sides) / 2)


def positions(result) -> np.ndarray:
    """Where the cameras stand."""
    return np.array([T.translation for T in result.poses])


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_face_towards_the_camera(axis, side):
    """Of the two largest faces the one on the camera's side, its centre half a thickness out."""
    target, normal = largest_face(plate(axis), CENTRE + side * 0.3 * np.eye(3)[axis] + 0.02)
    np.testing.assert_allclose(normal, side * np.eye(3)[axis])
    np.testing.assert_allclose(target, CENTRE + side * 0.005 * np.eye(3)[axis])


def test_largest_face_is_not_the_nearest_one():
    """A camera that looks at a plate edge-on still gets a large face, of the two the one it sees at all."""
    _, normal = largest_face(plate(2), CENTRE + np.array([0.5, 0.0, 0.01]))
    np.testing.assert_allclose(normal, Z)


def test_line_like_region_turns_its_side_to_the_camera():
    """Of a line's four equal faces the one that faces the camera; never its end."""
    line = plate(2, sides=(0.06, SIZE, SIZE))  # long side along x
    for offset, expected in (([0.3, 0.05, 0.2], Z), ([0.3, -0.2, 0.1], -Y), ([0.9, 0.1, 0.05], Y)):
        np.testing.assert_allclose(largest_face(line, CENTRE + np.array(offset))[1], expected)


@pytest.mark.parametrize(
    ("normal", "t1", "t2"),
    [(X, Y, Z), (Y, -X, Z), (-X, -Y, Z), (Z, X, Y), (-Z, X, -Y)],
    ids=["x", "y", "-x", "z", "-z"],
)
def test_tangents_by_hand(normal, t1, t2):
    """t_1 = z x n is horizontal, t_2 = n x t_1 points up the face; on a level face t_1 is the world's x axis."""
    for found, expected in zip(tangents(normal), (t1, t2), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_tangents_of_any_normal_obey_eq_11():
    """Unit, orthogonal to n and to each other, right-handed with n, t_1 horizontal."""
    for normal in np.random.default_rng(0).normal(size=(20, 3)):
        n = normal / np.linalg.norm(normal)
        t1, t2 = tangents(n)
        frame = np.column_stack([t1, t2, n])
        np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-12)
        assert np.linalg.det(frame) == pytest.approx(1.0)
        assert t1[2] == pytest.approx(0.0, abs=1e-12)


def test_diamond_on_a_level_face():
    """o_k = c_r + 0.1 n + 0.1 (cos, sin): 10 cm above, 10 cm towards +x, +y, -x, -y, looking at c_r; eqs. (12, 13)."""
    result = diamond_poses(plate(2), look_at(CENTRE + 0.4 * Z + 0.1 * X, CENTRE), PARAMETERS, always, MIN_Z)
    target = CENTRE + 0.005 * Z
    np.testing.assert_allclose(result.target, target)
    np.testing.assert_allclose(result.normal, Z)
    np.testing.assert_allclose(positions(result) - target, 0.1 * Z + 0.1 * np.array([X, Y, -X, -Y]), atol=1e-12)
    for T in result.poses:
        axis = T.rotation.as_matrix()[:, 2]
        np.testing.assert_allclose(axis, (target - T.translation) / (0.1 * np.sqrt(2)), atol=1e-12)
        # d = rho: all see the face at 45 deg
        assert axis @ -result.normal == pytest.approx(np.cos(np.pi / 4))
    assert (result.n_pushed_back, result.n_too_near, result.n_under_table, result.n_unreachable) == (0, 0, 0, 0)
    assert not result.turned


@pytest.mark.parametrize(("n", "first"), [(4, 45.0), (6, 0.0), (8, 22.5), (4, 90.0)])
def test_number_and_turn_of_the_diamond(n, first):
    """n poses, 360/n deg apart, the first at the given angle, in degrees; 90 deg permutes a diamond of four."""
    varied = PARAMETERS.model_copy(update={"n_recovery_poses": n, "diamond_angle_deg": first})
    result = diamond_poses(plate(2), look_at(CENTRE + 0.4 * Z, CENTRE), varied, always, MIN_Z)
    lateral = positions(result) - result.target - 0.1 * Z
    np.testing.assert_allclose(np.linalg.norm(lateral, axis=1), 0.1)
    angles = np.radians(first + 360.0 / n * np.arange(n))
    np.testing.assert_allclose(lateral / 0.1, np.stack([np.cos(angles), np.sin(angles), 0 * angles], -1), atol=1e-12)


def test_distance_and_offset_are_not_exchanged():
    """d = 20 cm along the normal, rho = 5 cm aside."""
    varied = PARAMETERS.model_copy(update={"recovery_distance": 0.2, "lateral_offset": 0.05})
    eyes = diamond_positions(CENTRE, X, varied, 0.0)
    np.testing.assert_allclose(eyes[:2] - CENTRE, [[0.2, 0.05, 0.0], [0.2, 0.0, 0.05]], atol=1e-12)


def test_too_near_is_pushed_back_along_the_view_axis():
    """At 848x480 Min-Z is 171 mm: poses at 141 mm move out to 181 mm on the same rays."""
    seen = look_at(CENTRE + 0.4 * Z, CENTRE)
    near = diamond_poses(plate(2), seen, PARAMETERS, always, 0.171)
    free = diamond_poses(plate(2), seen, PARAMETERS, always, MIN_Z)
    assert near.n_pushed_back == 4
    np.testing.assert_allclose(np.linalg.norm(positions(near) - near.target, axis=1), 0.181)
    np.testing.assert_allclose(
        positions(near) - near.target, (positions(free) - free.target) * 0.181 / (0.1 * np.sqrt(2)), atol=1e-12
    )
    for moved, original in zip(near.poses, free.poses, strict=True):
        np.testing.assert_allclose(moved.rotation.as_matrix(), original.rotation.as_matrix(), atol=1e-12)


def test_under_the_table_is_dropped():
    """An upright face 6 cm above the table: the lower pose would stand at z = -4 cm; three remain."""
    low = plate(0, centre=[0.0, 0.0, 0.06])
    result = diamond_poses(low, look_at(np.array([0.4, 0.0, 0.2]), low.centre), PARAMETERS, always, MIN_Z)
    assert (len(result.poses), result.n_under_table, result.turned) == (3, 1, False)
    assert positions(result)[:, 2].min() == pytest.approx(0.06)


def test_two_of_four_are_enough_and_one_turns_the_diamond():
    """A face that looks down at 0.06 m: all four poses lie at -0.04 m, and turned by 45 deg they still do.

    An arm that only stands at y >= 5 cm keeps one pose of the diamond of a level face, and two of the turned one.
    """
    low = plate(2, centre=[0.0, 0.0, 0.065])
    below = diamond_poses(low, look_at(np.array([0.3, 0.0, 0.01]), low.centre), PARAMETERS, always, MIN_Z)
    assert (below.poses, below.n_under_table, below.turned) == ((), 8, False)

    level, seen = plate(2, centre=[0.0, 0.0, 0.15]), look_at(np.array([0.0, 0.0, 0.5]), np.array([0.0, 0.0, 0.15]))
    turned = diamond_poses(level, seen, PARAMETERS, lambda T: T.translation[1] >= 0.05, MIN_Z)
    assert (len(turned.poses), turned.n_unreachable, turned.turned) == (2, 3 + 2, True)
    lateral = 0.1 / np.sqrt(2)
    np.testing.assert_allclose(positions(turned)[:, :2], [[lateral, lateral], [-lateral, lateral]])

    enough = diamond_poses(
        level, seen, PARAMETERS, lambda T: T.translation[1] >= -0.01 and T.translation[0] > -0.05, MIN_Z
    )
    assert (len(enough.poses), enough.n_unreachable, enough.turned) == (2, 2, False)


def test_a_turn_that_does_not_help_is_not_taken():
    """An arm that stands only straight behind +y keeps one pose of the first diamond and none of the turned one."""
    seen = look_at(np.array([0.0, 0.0, 0.5]), CENTRE)
    result = diamond_poses(plate(2), seen, PARAMETERS, lambda T: T.translation[1] > CENTRE[1] + 0.08, MIN_Z)
    assert (len(result.poses), result.turned, result.n_unreachable) == (1, False, 3 + 4)


def test_fates_are_counted_once_each():
    """Too near and not reachable farther back is too near; every pose of both diamonds has one fate."""
    result = diamond_poses(plate(2), look_at(CENTRE + 0.4 * Z, CENTRE), PARAMETERS, lambda T: False, 0.171)
    assert (result.poses, result.n_too_near, result.n_unreachable, result.n_under_table) == ((), 8, 0, 0)
    assert result.n_pushed_back == 0


def grid(n: int = 40) -> VoxelMap:
    """A cube of n voxels about the origin."""
    return VoxelMap(np.full(3, -(n // 2)), SIZE, np.zeros((n, n, n)))


def voxel_box(counts, centre=(0, 0, 0)) -> OrientedBox:
    """A box flush with the outer faces of n x m x k voxels about the voxel at `centre`; counts odd, longest first."""
    return OrientedBox(np.array(centre) * SIZE, np.eye(3), np.array(counts) * SIZE / 2)


def filled(voxel_map: VoxelMap, counts, centre=(0, 0, 0)) -> np.ndarray:
    """Mask of n x m x k voxels (odd) about the voxel at `centre`."""
    mask = np.zeros(voxel_map.log_odds.shape, bool)
    low = np.array(centre) - voxel_map.first - np.array(counts) // 2
    mask[tuple(slice(a, a + n) for a, n in zip(low, counts, strict=True))] = True
    return mask


@pytest.mark.parametrize("n", [1, 3, 5, 9])
def test_flat_patch_reaches_less_than_a_third(n):
    """n x n voxels one thick: N_cap = 3 (n + 2)^2, so filling it gives n^2 / (3 (n + 2)^2), and 1 of the attainable."""
    voxel_map = grid()
    now = filled(voxel_map, (n, n, 1))
    gamma, attainable = recovery_index(np.zeros_like(now), now, voxel_box((n, n, 1)), voxel_map, PARAMETERS)
    assert gamma == pytest.approx(n**2 / (3 * (n + 2) ** 2))
    assert gamma < 1 / 3
    assert attainable == pytest.approx(1.0)


def test_only_new_voxels_in_the_grown_box_count():
    """5 x 5 x 1: what was occupied before does not count, nor what lies two voxels outside; the margin of one does."""
    voxel_map, region = grid(), voxel_box((5, 5, 1))
    now = filled(voxel_map, (5, 5, 1))
    before = filled(voxel_map, (5, 1, 1))
    assert recovery_index(before, now, region, voxel_map, PARAMETERS)[0] == pytest.approx(20 / 147)
    outside = now | filled(voxel_map, (1, 1, 1), (5, 0, 0)) | filled(voxel_map, (1, 1, 1), (0, 0, 2))
    assert recovery_index(before, outside, region, voxel_map, PARAMETERS)[0] == pytest.approx(20 / 147)
    margin = now | filled(voxel_map, (1, 1, 1), (3, 3, 1))
    assert recovery_index(before, margin, region, voxel_map, PARAMETERS)[0] == pytest.approx(21 / 147)
    assert recovery_index(now, before, region, voxel_map, PARAMETERS) == (0.0, 0.0)  # lost voxels do not count against


def test_all_filled_is_one():
    """Every voxel of the grown box new: Gamma = 1, more than a sheet can do."""
    voxel_map = grid()
    now = np.ones(voxel_map.log_odds.shape, bool)
    gamma, attainable = recovery_index(~now, now, voxel_box((5, 3, 1), (4, -2, 7)), voxel_map, PARAMETERS)
    assert gamma == 1.0
    assert attainable == pytest.approx(7 * 5 * 3 / 15)


def test_capacity_does_not_depend_on_the_map():
    """Beyond the mapped workspace there are voxels too; they can never be filled, but they count as capacity."""
    small = grid(4)
    now = np.ones(small.log_odds.shape, bool)
    gamma, _ = recovery_index(~now, now, voxel_box((3, 3, 3), (2, 0, 0)), small, PARAMETERS)
    assert gamma == pytest.approx(2 * 4 * 4 / 125)  # x = 0, 1 of 0..4; y, z = -2..1 of -2..2


def test_region_grows_by_one_voxel_on_every_side():
    """Half sides of 2.2, 2.2 and 0.6 voxels grow to 3.2, 3.2 and 1.6: centres -3..3, -3..3 and -1..1, 147 voxels.

    Half a voxel would give 5 x 5 x 3, two voxels 9 x 9 x 5.
    """
    voxel_map = grid()
    region = OrientedBox(np.zeros(3), np.eye(3), np.array([2.2, 2.2, 0.6]) * SIZE)
    now = filled(voxel_map, (1, 1, 1))
    assert recovery_index(np.zeros_like(now), now, region, voxel_map, PARAMETERS)[0] == pytest.approx(1 / 147)


def test_voxels_in_a_turned_box():
    """Their number is the box's volume over a voxel's, for a large box, and each lies in the box on the lattice."""
    turn = Rotation.from_euler("xyz", [0.4, 0.7, -0.2]).as_matrix()
    box = OrientedBox(np.array([0.01, 0.02, 0.03]), turn, np.array([0.15, 0.11, 0.09]))
    centres = voxels_in(box, SIZE)
    assert box.contains(centres).all()
    np.testing.assert_allclose(centres / SIZE, np.round(centres / SIZE), atol=1e-9)
    assert len(np.unique(np.round(centres / SIZE), axis=0)) == len(centres)
    surface_noise = 0.02
    assert len(centres) == pytest.approx(box.volume / SIZE**3, rel=surface_noise)


@pytest.mark.parametrize("normal", [(0, 0, 1), (0.3, 0.2, 1), (1, 0, 1), (0.9, 0.8, 1)])
def test_voxels_of_a_sheet(normal):
    """A sheet over 60 x 60 whole columns of voxels: in each it enters those between its lowest and its highest corner.

    z = z0 - (n_x x + n_y y) / n_z over 3600 columns has the area 3600 / |n_z| in unit voxels.
    """
    n = np.array(normal, float) / np.linalg.norm(normal)
    x, y = np.meshgrid(np.arange(61), np.arange(61))
    z = 0.3712 - (n[0] * x + n[1] * y) / n[2]
    corners = np.stack([z[:-1, :-1], z[1:, :-1], z[:-1, 1:], z[1:, 1:]])
    entered = np.sum(np.floor(corners.max(axis=0)) - np.floor(corners.min(axis=0)) + 1)
    side = np.sqrt(3600 / n[2])
    t1, t2 = tangents(n)
    sheet = OrientedBox(np.zeros(3), np.column_stack([t1, t2, n]), np.array([side / 2, side / 2, 0.5]) * SIZE)
    few_columns = 0.01
    assert sheet_voxels(sheet, SIZE) == pytest.approx(entered, rel=few_columns)


def test_recovery_poses_carry_the_roll():
    """On end, the poses stand and look as upright ones do, with their x axes where those have their y axes; as near as
    Min-Z allows, since that does not depend on the roll."""
    seen = look_at(CENTRE + np.array([0.3, 0.0, 0.1]), CENTRE)
    upright, turned = (
        diamond_poses(plate(0), seen, Parameters(roll_deg=roll), always, 0.2).poses for roll in (0.0, 90.0)
    )
    assert len(upright) == len(turned) > 0
    for T, R in zip(upright, turned, strict=True):
        np.testing.assert_allclose(R.translation, T.translation)
        np.testing.assert_allclose(R.rotation.as_matrix()[:, 0], T.rotation.as_matrix()[:, 1], atol=1e-12)
        np.testing.assert_allclose(R.rotation.as_matrix()[:, 2], T.rotation.as_matrix()[:, 2], atol=1e-12)
