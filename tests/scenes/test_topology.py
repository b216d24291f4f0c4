"""Welding, open edges, volume, winding, shading normals and lay on meshes whose answers are known."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.lay import with_planar_charts
from scenes.primitives import box, cylinder, moved, sphere
from scenes.scene import Mesh
from scenes.shading_normals import with_smooth_normals
from scenes.topology import WELD_TOLERANCE, distinct_rows, open_edge_count, signed_volume, welded
from scenes.winding import turned_outward
from tests.scenes.tangents import u_directions, unit_normals

RNG = np.random.default_rng(7)


def cube(side: float = 1.0, centre=(0.0, 0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and outward triangles of a cube, from another library."""
    made = trimesh.creation.box((side, side, side))
    return np.asarray(made.vertices, float) + centre, np.asarray(made.faces, np.int64)


def together(*solids: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Several meshes in one array."""
    offsets = np.cumsum([0, *(len(vertices) for vertices, _ in solids)])
    faces = [faces + offset for (_, faces), offset in zip(solids, offsets, strict=False)]
    return np.concatenate([vertices for vertices, _ in solids]), np.concatenate(faces)


def test_distinct_rows_agree_with_numpy():
    """numpy's unique rows are the slow reference."""
    rows = RNG.integers(0, 5, (500, 3))
    first, group = distinct_rows(rows)
    expected = np.unique(rows, axis=0, return_inverse=True)
    assert len(first) == len(expected[0])
    np.testing.assert_array_equal(rows[first][group], rows)


def test_an_unwelded_cube_is_closed_and_one_without_a_triangle_is_not():
    """STL repeats corners: 36 vertices, still closed. A missing triangle leaves its three edges without a partner."""
    vertices, faces = cube()
    soup = vertices[faces].reshape(-1, 3)
    triangles = np.arange(36).reshape(-1, 3)
    assert len(np.unique(welded(soup))) == 8
    assert open_edge_count(Mesh(soup, triangles)) == 0
    assert open_edge_count(Mesh(soup, triangles[1:])) == 3


def test_corners_are_welded_by_distance_wherever_they_lie():
    """Pairs a little nearer than the tolerance are one point, pairs a little farther apart two, at any place."""
    place = RNG.uniform(-1, 1, (2000, 3))
    away = RNG.normal(size=(2000, 3))
    away *= WELD_TOLERANCE / np.linalg.norm(away, axis=1, keepdims=True)
    for share, points in ((0.95, 2000), (1.05, 4000)):
        place_of = welded(np.concatenate([place, place + share * away]))
        assert len(np.unique(place_of)) == points
        assert np.all(place_of[:2000] == place_of[2000:]) == (share < 1)


def test_a_round_part_with_noisy_corners_is_closed():
    """Corners of a cylinder moved by up to 2e-8 m, as text files round: none of its 256 triangles comes loose."""
    made = trimesh.creation.cylinder(radius=0.015, height=0.03, sections=64)
    corners = np.asarray(made.vertices, float)[np.asarray(made.faces)].reshape(-1, 3)
    noisy = corners + RNG.uniform(-2e-8, 2e-8, corners.shape)
    assert open_edge_count(Mesh(noisy, np.arange(len(noisy)).reshape(-1, 3))) == 0


def test_volume_does_not_depend_on_where_the_mesh_is():
    """A cube of side 2 holds 8, also 1000 away."""
    vertices, faces = cube(2.0, (1000.0, -500.0, 300.0))
    assert signed_volume(vertices, faces) == pytest.approx(8.0, rel=1e-9)
    assert signed_volume(vertices, faces[:, ::-1]) == pytest.approx(-8.0, rel=1e-9)


def test_random_winding_is_repaired():
    """Each triangle turned or not by a coin: afterwards the cube is closed and holds +1 again."""
    vertices, faces = cube()
    coin = RNG.random(len(faces)) < 0.5
    mended, _ = turned_outward(vertices, np.where(coin[:, None], faces[:, ::-1], faces))
    assert open_edge_count(Mesh(vertices, mended)) == 0
    assert signed_volume(vertices, mended) == pytest.approx(1.0)


def test_inside_out_parts_are_turned_and_cavities_kept():
    """A cube with a cubic cavity holds 8 - 1, whichever way its two surfaces were drawn; a cube beside it adds 1."""
    outer, inner, beside = cube(2.0), cube(1.0), cube(1.0, (5.0, 0.0, 0.0))
    for flip_outer in (False, True):
        for flip_inner in (False, True):
            solids = [
                (outer[0], outer[1][:, ::-1] if flip_outer else outer[1]),
                (inner[0], inner[1][:, ::-1] if flip_inner else inner[1]),
                beside,
            ]
            vertices, faces = together(*solids)
            mended, _ = turned_outward(vertices, faces)
            assert signed_volume(vertices, mended) == pytest.approx(8.0)


def test_an_open_surface_keeps_its_winding():
    """The side of a bore looks at its own axis: nothing but its file knows that, since it encloses nothing."""
    made = trimesh.creation.cylinder(radius=1, height=2, sections=24)
    side = np.asarray(made.faces, np.int64)[np.abs(made.face_normals[:, 2]) < 0.5][:, ::-1]
    for faces in (side, side[:, ::-1]):
        mended, turned = turned_outward(np.asarray(made.vertices, float), faces)
        assert turned == 0
        np.testing.assert_array_equal(mended, faces)


def test_a_bolt_in_its_block_is_no_cavity():
    """Two cubes that overlap in part both look outward: 8 + 8."""
    vertices, faces = together(cube(2.0), cube(2.0, (0.7, 0.6, 0.5)))
    mended, turned = turned_outward(vertices, faces)
    assert turned == 0
    assert signed_volume(vertices, mended) == pytest.approx(16.0)


def test_smooth_normals_of_a_ball_are_its_radii():
    """On an icosphere of 4 deg facets angle-weighted normals point along the radius, to a tenth of that angle (they
    err where triangles of unlike shape meet); no vertex is doubled."""
    made = trimesh.creation.icosphere(subdivisions=4)
    mesh = with_smooth_normals(Mesh(np.asarray(made.vertices, float), np.asarray(made.faces, np.int64)))
    assert mesh.normals is not None
    assert len(mesh.vertices) == len(made.vertices)
    np.testing.assert_allclose(mesh.normals, mesh.vertices, atol=np.deg2rad(0.4))


def test_sharp_edges_stay_sharp():
    """A cube's corners get three normals each, those of its faces; a 16-sided prism (22.5 deg) is round at its side."""
    vertices, faces = cube()
    mesh = with_smooth_normals(Mesh(vertices, faces))
    assert mesh.normals is not None
    assert len(mesh.vertices) == 24
    np.testing.assert_allclose(mesh.normals[mesh.faces], np.repeat(unit_normals(mesh)[:, None], 3, axis=1), atol=1e-12)
    made = trimesh.creation.cylinder(radius=1, height=1, sections=16)
    prism = with_smooth_normals(Mesh(np.asarray(made.vertices, float), np.asarray(made.faces, np.int64)))
    assert prism.normals is not None
    side = np.abs(prism.normals[:, 2]) < 0.5
    radial = prism.vertices[side, :2] / np.linalg.norm(prism.vertices[side, :2], axis=1, keepdims=True)
    np.testing.assert_allclose(prism.normals[side, :2], radial, atol=1e-9)
    assert set(np.round(np.abs(prism.normals[~side, 2]), 12)) == {1.0}


def test_planar_charts_run_along_the_long_side_and_keep_lengths():
    """A 3 x 2 x 1 box: u runs along x on four faces and along y on the two ends; distances in uv are those in space."""
    made = trimesh.creation.box((3, 2, 1))
    mesh = with_planar_charts(Mesh(np.asarray(made.vertices, float), np.asarray(made.faces, np.int64)))
    assert mesh.uvs is not None
    ends = np.abs(unit_normals(mesh)[:, 0]) > 0.9
    u = np.abs(u_directions(mesh))
    np.testing.assert_allclose(u[~ends], np.tile([1, 0, 0], (8, 1)), atol=1e-9)
    np.testing.assert_allclose(u[ends], np.tile([0, 1, 0], (4, 1)), atol=1e-9)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        space = np.linalg.norm(mesh.vertices[mesh.faces[:, i]] - mesh.vertices[mesh.faces[:, j]], axis=1)
        chart = np.linalg.norm(mesh.uvs[mesh.faces[:, i]] - mesh.uvs[mesh.faces[:, j]], axis=1)
        np.testing.assert_allclose(chart, space, atol=1e-12)


@pytest.mark.parametrize(
    ("mesh", "volume", "tolerance"),
    [
        (box((0.1, 0.2, 0.3)), 0.006, 1e-12),
        # A regular n-gon has sin(2 pi / n) / (2 pi / n) of its circle's area: 2e-4 less for n = 192.
        (cylinder(0.03, 0.1), np.pi * 0.03**2 * 0.1, 2.5e-4),
        (sphere(0.03), 4 / 3 * np.pi * 0.03**3, 6e-4),
    ],
)
def test_primitives_are_closed_outward_and_of_the_right_volume(mesh, volume, tolerance):
    """Closed forms of box, cylinder and ball; facets lose the stated share."""
    assert open_edge_count(mesh) == 0
    assert signed_volume(mesh.vertices, mesh.faces) == pytest.approx(volume, rel=tolerance)
    cosine = np.einsum("ij,ikj->ik", unit_normals(mesh), mesh.normals[mesh.faces])
    assert cosine.min() > np.cos(2 * np.pi / 192)


def test_lay_of_turned_primitives_runs_round_z():
    """On side, ends and ball u is tangential: square to z and to the radius."""
    for mesh in (cylinder(0.03, 0.1), sphere(0.03)):
        u = u_directions(mesh)
        centre = mesh.vertices[mesh.faces].mean(axis=1)
        np.testing.assert_allclose(u[:, 2], 0, atol=1e-9)
        off_axis = np.linalg.norm(centre[:, :2], axis=1)
        assert np.abs(np.einsum("ij,ij->i", u[:, :2], centre[:, :2]) / off_axis).max() < 0.02


def test_lay_angle_and_motion_of_a_plate():
    """The lay is turned by the angle asked for, and moves with the plate like its normals."""
    turn = Rotation.from_euler("xyz", [0.3, -0.4, 0.5])
    mesh = moved(box((0.1, 0.1, 0.004), lay=0.6), RigidTransform.from_components([0.1, 0.2, 0.3], turn))
    top = unit_normals(mesh) @ turn.apply([0, 0, 1]) > 0.99
    np.testing.assert_allclose(
        u_directions(mesh)[top], np.tile(turn.apply([np.cos(0.6), np.sin(0.6), 0]), (2, 1)), atol=1e-9
    )
    under = unit_normals(mesh) @ turn.apply([0, 0, -1]) > 0.99
    np.testing.assert_allclose(
        u_directions(mesh)[under], np.tile(turn.apply([np.cos(0.6), np.sin(0.6), 0]), (2, 1)), atol=1e-9
    )
    assert mesh.normals is not None
    np.testing.assert_allclose(mesh.normals[mesh.faces[:, 0]], unit_normals(mesh), atol=1e-12)
