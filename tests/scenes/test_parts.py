"""The committed parts: closed, outward, at rest, of the stated size and hash, with true normals and lay."""

import numpy as np
import pytest

from materials.input_error import InputError
from scenes.mesh_files import content_hash
from scenes.part_materials import PartMaterials, part_materials, with_part_materials
from scenes.parts import (
    ALL_PARTS,
    EARLIER_PARTS,
    EXTRA_PARTS,
    MESH_FOLDER,
    PART_NAMES,
    manifest,
    part_bodies,
    part_description,
)
from scenes.scene import Body
from scenes.topology import open_edge_count, signed_volume
from tests.scenes.tangents import centres, u_directions, unit_normals

BODIES = [(part, body.name) for part in ALL_PARTS for body in part_bodies(part)]
FLOAT32_GRAIN = 2e-8
"""Positions are stored in float32 metres; one step at 0.1 m is 7e-9 m."""
LARGEST_FILE = 300_000


def body_of(part: str, name: str) -> Body:
    return next(body for body in part_bodies(part) if body.name == name)


@pytest.mark.parametrize(("part", "name"), BODIES)
def test_body_is_closed_and_outward(part, name):
    """A solid's every edge is run once each way, and by the divergence theorem its outward volume is positive."""
    mesh = body_of(part, name).mesh
    assert open_edge_count(mesh) == 0
    assert signed_volume(mesh.vertices, mesh.faces) > 0


@pytest.mark.parametrize(("part", "name"), BODIES)
def test_normals_are_unit_and_near_the_triangles(part, name):
    """Facets turn by 8.6 deg at most on round surfaces, so normals lie within 10 deg; only tight fillets and threads
    differ more. Measured by area, since slivers in fillets have no area to speak of."""
    mesh = body_of(part, name).mesh
    assert mesh.normals is not None
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-12)
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    cosine = np.einsum("ij,ikj->ik", unit_normals(mesh), mesh.normals[mesh.faces]).min(axis=1)
    allowed_deg, allowed_share = (20, 0.01) if name == "nipple" else (10, 0.015)
    assert area[cosine < np.cos(np.deg2rad(allowed_deg))].sum() < allowed_share * area.sum()


@pytest.mark.parametrize("part", ALL_PARTS)
def test_part_rests_centred_on_the_table(part):
    """Lowest point at z = 0, bounding box over the origin, longest side 8 to 25.5 cm, so that it fits the mapped box,
    as the manifest says."""
    corners = np.concatenate([body.mesh.vertices for body in part_bodies(part)])
    low, high = corners.min(axis=0), corners.max(axis=0)
    assert abs(low[2]) < FLOAT32_GRAIN
    np.testing.assert_allclose((low + high)[:2] / 2, 0, atol=FLOAT32_GRAIN)
    assert 0.08 <= (high - low).max() <= 0.255
    np.testing.assert_allclose(high - low, manifest()["parts"][part]["size"], atol=1e-4)


def test_files_are_those_of_the_manifest():
    """Every committed file is small and its content has the hash that the authoring script wrote down."""
    entries = [body for part in manifest()["parts"].values() for body in part["bodies"]]
    assert sorted(entry["file"] for entry in entries) == sorted(path.name for path in MESH_FOLDER.glob("*.npz"))
    for entry in entries:
        path = MESH_FOLDER / entry["file"]
        assert path.stat().st_size < LARGEST_FILE
        assert content_hash(path) == entry["sha256"]


def test_cuboid_and_block_have_the_drawn_volume():
    """A1: 120 x 80 x 60 mm less the 1.5 mm fillets: each edge loses (1 - pi/4) r^2 per length, which two triply counted
    corners change by under 0.01 %. C1: outline area times 70 mm less the slanted prism and 0.5 mm chamfers (0.2 %)."""
    cuboid = body_of("A1", "cuboid").mesh
    fillets = (1 - np.pi / 4) * 1.5**2 * 4 * (120 + 80 + 60)
    assert signed_volume(cuboid.vertices, cuboid.faces) * 1e9 == pytest.approx(120 * 80 * 60 - fillets, rel=2e-4)
    block = body_of("C1", "block").mesh
    z = (np.arange(5500) + 0.5) / 100  # slices of 0.01 mm
    left = np.where(z < 26.13, -60, -60 + (z - 26.13) * 50 / 28.87)
    right = np.where(z < 20, 60, 60 - (z - 20))
    depth = 70 - np.maximum(z - 20, 0) * np.tan(np.deg2rad(20))
    drawn = np.sum((right - left) * depth) / 100
    assert signed_volume(block.vertices, block.faces) * 1e9 == pytest.approx(drawn, rel=2e-3)


def test_catalogue_geometry_has_its_standard_sizes():
    """ISO 4762: an M6 head is 10 mm wide (10.22 knurled) and 6 mm high. ISO 228-1: G1/2 has crests of 20.955 mm and
    roots of 18.631 mm diameter."""
    screws = body_of("D1", "screws").mesh.vertices
    first = screws[(screws[:, 0] < 0) & (screws[:, 1] < 0)] * 1000
    assert 10.0 <= np.ptp(first[:, 1]) <= 10.22
    assert first[:, 2].max() - 38 == pytest.approx(6.0, abs=0.01)
    nipple = body_of("D1", "nipple").mesh.vertices * 1000
    axis = nipple[np.abs(nipple[:, 2] - nipple[:, 2].max()) < 1e-3][:, :2]
    axis = (axis.min(axis=0) + axis.max(axis=0)) / 2
    free = nipple[(nipple[:, 2] > 48) & (nipple[:, 2] < 56)]
    radius = np.linalg.norm(free[:, :2] - axis, axis=1)
    outside = radius[radius > 9]
    assert 2 * outside.max() == pytest.approx(20.955, abs=0.02)
    assert 2 * outside.min() == pytest.approx(18.631, abs=0.02)


def test_lay_of_the_block_runs_along_each_face():
    """The block's top flat is 70 mm less the slant deep and 35 mm long, so it is milled across (y); its front face,
    120 mm long, along x. Tilted faces keep their lay in their plane."""
    mesh = body_of("C1", "block").mesh
    u, normal, centre = u_directions(mesh), unit_normals(mesh), centres(mesh)
    np.testing.assert_allclose(np.einsum("ij,ij->i", u, normal), 0, atol=1e-6)
    front = normal[:, 1] < -0.999
    top = (normal[:, 2] > 0.999) & (centre[:, 2] > 0.054)
    assert front.any()
    assert top.any()
    np.testing.assert_allclose(np.abs(u[front, 0]), 1, atol=1e-6)
    np.testing.assert_allclose(np.abs(u[top, 1]), 1, atol=1e-6)


def test_lay_of_turned_surfaces_runs_round_the_axis():
    """A lathe's marks are circles: on the pipe's outside u is square to the pipe's axis and to its radius."""
    mesh = body_of("D1", "union").mesh
    u, normal = u_directions(mesh), unit_normals(mesh)
    top = mesh.vertices[:, 2].max()
    side = (np.abs(normal[:, 2]) < 1e-6) & (centres(mesh)[:, 2] > top - 0.012)
    assert side.sum() > 40
    np.testing.assert_allclose(u[side, 2], 0, atol=1e-6)


def test_parts_are_made_of_the_real_things_materials():
    """A1 is painted (diffuse), C1 milled steel (anisotropic), D1's fittings polished; B1 mixes metals and plastic."""
    kinds = {part: {body.name: type(body.material).__name__ for body in part_bodies(part)} for part in ALL_PARTS}
    assert kinds["A1"] == {"cuboid": "Matte"}
    assert set(kinds["B1"].values()) == {"RoughConductor", "RoughPlastic"}
    assert body_of("C1", "block").material.name == "iron:milled"
    assert {body_of("D1", n).material.name for n in ("elbow", "tee", "union")} == {"stainless_austenitic:polished"}
    assert all(part_description(part) for part in ALL_PARTS)


def test_unknown_part_is_named():
    """One line with thing and mend."""
    with pytest.raises(
        InputError, match=r"^part E: there is none; choose A, B, C, D, A1, B1, C1, D1, E1, E2, E3 or E4$"
    ):
        part_bodies("E")


def test_materials_by_word():
    """The last word wins; a body's own word beats the one for all; `@alpha=` is not an assignment."""
    chosen = part_materials(["iron:ground", "brass:ground@alpha=0.1", "coil=rubber", "screws=iron:blasted@alpha=0.3"])
    bodies = {body.name: body.material for body in with_part_materials("part B1", part_bodies("B1"), chosen)}
    assert bodies["coil"].name == "rubber"
    assert bodies["screws"].name == "iron:blasted@alpha=0.3"
    assert bodies["valve_body"].name == "brass:ground@alpha=0.1"
    kept = {body.name: body.material for body in with_part_materials("part B1", part_bodies("B1"), PartMaterials())}
    assert kept["coil"].name == "black_plastic"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["bolt=rubber"], r"^part D1: there is no body bolt to give a material to; known: manifold, .*$"),
        (["=rubber"], r"^=rubber: cannot tell body from material; write body=metal:finish$"),
        (["screws="], r"^screws=: cannot tell body from material; write body=metal:finish$"),
        (["elbow=steel:shiny"], r"^steel:shiny: unknown material; "),
    ],
)
def test_bad_material_words_are_named(words, message):
    """One line with thing, place and mend."""
    with pytest.raises(InputError, match=message):
        with_part_materials("part D1", part_bodies("D1"), part_materials(words))


@pytest.mark.parametrize(
    ("part", "size_mm"),
    [("A", (100, 40, 160)), ("B", (54, 50, 229)), ("C", (180, 45, 180)), ("D", (31, 31, 252))],
)
def test_the_papers_objects_stand_as_they_were_measured(part, size_mm):
    """What was read off the published photographs and drawn to the millimetre."""
    corners = np.concatenate([body.mesh.vertices for body in part_bodies(part)])
    np.testing.assert_allclose(1000 * np.ptp(corners, axis=0), size_mm, atol=0.1)


def test_satin_block_has_the_drawn_volume():
    """A: 100 x 40 x 160 mm less a prism of 0.3 mm legs along each edge; corners change that by 1e-6 of it."""
    block = body_of("A", "block").mesh
    chamfers = 0.3**2 / 2 * 4 * (100 + 40 + 160)
    assert signed_volume(block.vertices, block.faces) * 1e9 == pytest.approx(100 * 40 * 160 - chamfers, rel=2e-6)


def test_port_of_the_filter_regulator_is_g3_8():
    """B: the bore that looks along -y has the minor diameter of G3/8, 14.950 mm (ISO 228-1), around z = 74 mm."""
    mesh = body_of("B", "body").mesh
    points = 1000 * mesh.vertices
    depth = (points[:, 1] > -22) & (points[:, 1] < -5) & (np.abs(points[:, 0]) < 9)
    radius = np.linalg.norm(points[depth][:, [0, 2]] - [0, 74], axis=1)
    assert 2 * radius[radius > 5].min() == pytest.approx(14.950, abs=0.01)


def test_wedge_has_the_drawn_slope_and_volume():
    """C: a right-angled triangle of 180 mm legs less blunt tips of 6 mm, so the slope of 174 mm by 174 mm is at 45 deg.
    Its cross-section is 180^2/2 + 6 x 180 - 6^2/2 mm^2 less what the roundings of 8 mm and 4 mm take, (1 - pi/4) r^2
    each; chamfers take 0.5^2/2 along 2 x 613 mm. Counterbores (15 mm by 8.6 mm twice, 10 mm by 5.4 mm twice) are
    drilled straight into the face."""
    block, sides = body_of("C", "block").mesh, body_of("C", "sides").mesh
    section = 180**2 / 2 + 6 * 180 - 6**2 / 2 - (1 - np.pi / 4) * (8**2 + 4**2)
    bores = np.pi / 4 * (2 * 15**2 * 8.6 + 2 * 10**2 * 5.4)
    drawn = section * 45 - 0.5**2 / 2 * 2 * 613 - bores
    volume = sum(signed_volume(mesh.vertices, mesh.faces) for mesh in (block, sides)) * 1e9
    assert volume == pytest.approx(drawn, rel=1e-4)
    normal = unit_normals(block)
    inclined = normal @ np.array([-1.0, 0.0, 1.0]) / np.sqrt(2) > 1 - 1e-6
    assert inclined.any()
    slope = u_directions(block)[inclined]
    np.testing.assert_allclose(np.abs(slope @ np.array([1.0, 0.0, 1.0]) / np.sqrt(2)), 1, atol=1e-6)


def test_screws_of_the_wedge_lie_below_its_face():
    """ISO 4762 heads of 13 mm (M8) and 8.5 mm (M5), plain to knurled, whose tops lie 0.4 to 0.6 mm below the inclined
    face -x + z = 96 mm, where a head's top must be by DIN 974-1."""
    points = 1000 * body_of("C", "screws").mesh.vertices
    height = (points @ np.array([-1.0, 0.0, 1.0]) - 96) / np.sqrt(2)
    assert height.max() == pytest.approx(-0.4, abs=0.01)
    for side, (low, high, below) in {1: (13.0, 13.27, 0.6), -1: (8.5, 8.72, 0.4)}.items():
        up = points[:, 0] + points[:, 2] > 100
        there = up & (np.sign(points[:, 1]) == side) & (height > -4)
        head = points[there]
        assert height[there].max() == pytest.approx(-below, abs=0.01)
        assert low - 0.05 <= np.ptp(head[:, 1]) <= high


def test_column_has_wrench_flats_of_27_mm():
    """D: turned radii of 15.5, 15.2 and 11.8 mm, and six upright flats a sleeve at 13.5 mm from the axis (ISO 272)."""
    mesh = body_of("D", "fittings").mesh
    normal, centre = unit_normals(mesh), 1000 * centres(mesh)
    radius = 1000 * np.linalg.norm(mesh.vertices[:, :2], axis=1)
    for turned in (15.5, 15.2, 11.8):
        assert np.abs(radius - turned).min() < 1e-3
    assert radius.max() == pytest.approx(15.5, abs=1e-3)
    across = np.einsum("ij,ij->i", centre[:, :2], normal[:, :2])
    flat = (np.abs(normal[:, 2]) < 1e-6) & (np.abs(across - 13.5) < 1e-3)
    turns = np.round(np.degrees(np.arctan2(normal[flat, 1], normal[flat, 0])) % 360, 3) % 360
    sleeves = np.floor(centre[flat, 2] / 63)
    assert len(np.unique(np.column_stack([turns, sleeves]), axis=0)) == 6 * 4


def test_the_papers_objects_are_made_of_what_the_photographs_show():
    """No part of A reflects as a mirror does; C's sides and D do; B is painted metal and plastic."""
    kinds = {part: {body.name: body.material for body in part_bodies(part)} for part in PART_NAMES}
    assert kinds["A"]["block"].name == "iron:blasted"
    assert {m.name for m in kinds["B"].values()} == {"black_plastic", "matte_paint", "white_plastic", "oxide"}
    assert (kinds["C"]["block"].name, kinds["C"]["sides"].name) == ("aluminium:milled", "aluminium:polished")
    assert kinds["D"]["fittings"].name == "nickel:bright"


def test_names_of_parts_are_distinct():
    """No name is given twice; the earlier set has a 1 behind each of the paper's."""
    assert len(set(ALL_PARTS)) == len(ALL_PARTS)
    assert tuple(f"{name}1" for name in PART_NAMES) == EARLIER_PARTS


def test_half_ring_holds_nine_columns_that_do_not_touch():
    """E3: nine columns on a circle of 80 mm, 23 deg apart, so 2 x 80 sin(11.5 deg) = 31.9 mm from axis to axis; each is
    31 mm wide. Seen from above, the open ends are nine rings."""
    points = 1000 * np.concatenate([body.mesh.vertices for body in part_bodies("E3")])
    rims = points[points[:, 2] > 189 - 1e-3][:, :2]
    axes = np.array([80 * np.array([np.sin(a), np.cos(a)]) for a in np.deg2rad(23 * np.arange(-4, 5))])
    axes += (rims.min(axis=0) + rims.max(axis=0)) / 2 - (axes.min(axis=0) + axes.max(axis=0)) / 2
    distance = np.linalg.norm(rims[:, None] - axes, axis=2)
    np.testing.assert_allclose(distance.min(axis=1), np.where(distance.min(axis=1) > 14, 15.1, 12.9), atol=0.05)
    assert len(np.unique(distance.argmin(axis=1))) == 9


@pytest.mark.parametrize("part", EXTRA_PARTS)
def test_things_for_pictures_fit_the_mapped_box(part):
    """Inside 0.5 x 0.5 x 0.3 m with the plinth's 45 mm below it, 16 to 25 cm along the longest side."""
    size = np.array(manifest()["parts"][part]["size"])
    assert 0.16 <= size.max() <= 0.25
    assert size[2] + 0.045 < 0.3
