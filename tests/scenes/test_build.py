"""Whole scenes: table, room, lamps around a part, and the reference points on it."""

import numpy as np
import pytest

from materials.catalog import material, matte_twin
from scenes.build import part_scene
from scenes.part_materials import part_materials
from scenes.reference_points import part_box, part_half_diagonal, reference_points
from scenes.surroundings import ROOM_SIZE, TABLE_HEIGHT, TABLE_SIZE, room, table
from scenes.topology import open_edge_count, signed_volume
from tests.scenes.tangents import unit_normals


def test_table_top_is_at_zero():
    """1.2 x 0.8 m around the origin, upper face at z = 0."""
    vertices = table().mesh.vertices
    np.testing.assert_allclose(vertices.min(axis=0), [-0.6, -0.4, -TABLE_SIZE[2]], atol=1e-12)
    np.testing.assert_allclose(vertices.max(axis=0), [0.6, 0.4, 0], atol=1e-12)


def test_room_is_closed_and_looks_inward():
    """Floor, walls and ceiling together enclose the room's volume with the faces turned in: the volume is negative."""
    shell = [body for body in room() if body.name in ("floor", "walls", "ceiling")]
    volume = 0.0
    for body in shell:
        a, b, c = (body.mesh.vertices[body.mesh.faces[:, i]] for i in range(3))
        volume += float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
    assert volume == pytest.approx(-np.prod(ROOM_SIZE))
    for body in room():
        assert not body.is_part
        assert body.mesh.vertices[:, 2].min() > -TABLE_HEIGHT - 1e-9
        assert (np.abs(body.mesh.vertices[:, :2]) <= np.array(ROOM_SIZE[:2]) / 2 + 1e-9).all()


def test_furniture_stands_clear_of_table_and_cameras():
    """Closed boxes, 0.5 m and more from the table's edge, so that no camera on a half-metre sphere is inside one."""
    for body in room():
        if body.name in ("floor", "walls", "ceiling"):
            continue
        assert open_edge_count(body.mesh) == 0
        assert signed_volume(body.mesh.vertices, body.mesh.faces) > 0
        low, high = body.mesh.vertices[:, :2].min(axis=0), body.mesh.vertices[:, :2].max(axis=0)
        gap = np.maximum(np.maximum(low - [0.6, 0.4], [-0.6, -0.4] - high), 0)
        assert np.linalg.norm(gap) >= 0.5


def test_scene_holds_part_table_room_and_lamps():
    """A closed room needs no ambient light; without it the preset's stands in."""
    closed = part_scene("C1")
    assert [body.name for body in closed.bodies[:2]] == ["block", "table"]
    assert len(closed.bodies) == 2 + len(room())
    assert closed.ambient_radiance == 0
    open_air = part_scene("C1", lamps="dim", room=False)
    assert len(open_air.bodies) == 2
    assert open_air.ambient_radiance > 0
    assert len(open_air.lamps) == 4
    painted = part_scene("C1", part_materials(["white_paint"]), table_material=material("rubber"), room=False)
    assert [body.material.name for body in painted.bodies] == ["white_paint", "rubber"]


def test_matte_twin_keeps_shapes_and_lamps():
    """Replacing every material by its twin changes nothing else."""
    scene = part_scene("D1")
    twin = scene.with_materials(lambda body: matte_twin(body.material))
    assert all(type(body.material).__name__ == "Matte" for body in twin.bodies)
    assert all(a.mesh is b.mesh for a, b in zip(scene.bodies, twin.bodies, strict=True))
    assert twin.lamps == scene.lamps


def test_reference_points_lie_on_the_surface_uniformly():
    """On the 120 x 80 x 60 mm cuboid each pair of opposite faces holds its share of the area, within 4 standard
    deviations of a binomial draw (the 1.5 mm fillets take 1 %); same seed, same points."""
    n = 10_000
    points, normals = reference_points(part_scene("A1", room=False), n, seed=3)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-12)
    flat = [(120 - 3) * (80 - 3), (120 - 3) * (60 - 3), (80 - 3) * (60 - 3)]
    fillets = (np.pi / 2) * 1.5 * (117 + 77 + 57) * 4 + 4 * np.pi * 1.5**2
    total = 2 * sum(flat) + fillets
    for axis, area in zip((2, 1, 0), flat, strict=True):
        share = 2 * area / total
        found = np.abs(normals[:, axis]) > 1 - 1e-9
        assert abs(found.mean() - share) < 4 * np.sqrt(share * (1 - share) / n)
        half = np.array([0.06, 0.04, 0.03])[axis]
        centred = points[found] - [0, 0, 0.03]
        np.testing.assert_allclose(np.abs(centred[:, axis]), half, atol=1e-7)
        quarter = np.mean(centred[:, (axis + 1) % 3] > 0)
        assert abs(quarter - 0.5) < 4 * 0.5 / np.sqrt(found.sum())
    again, _ = reference_points(part_scene("A1", room=False), n, seed=3)
    other, _ = reference_points(part_scene("A1", room=False), n, seed=4)
    np.testing.assert_array_equal(points, again)
    assert not np.array_equal(points, other)


def test_reference_normals_look_outward():
    """A step of 0.1 mm along the normal leaves the cuboid's box."""
    scene = part_scene("A1", room=False)
    points, normals = reference_points(scene, 500)
    low, high = part_box(scene)
    inner = points - 1e-4 * normals
    assert ((inner > low) & (inner < high)).all()
    assert part_half_diagonal(scene) == pytest.approx(np.sqrt(0.12**2 + 0.08**2 + 0.06**2) / 2, rel=1e-6)


def test_reference_points_need_no_flat_normals():
    """Normals are those of the triangles, not the shading normals: unit and perpendicular to an edge of a triangle."""
    scene = part_scene("D1", room=False)
    _, normals = reference_points(scene, 200, seed=1)
    known = np.concatenate([unit_normals(body.mesh) for body in scene.part_bodies])
    nearest = (normals @ known.T).max(axis=1)
    np.testing.assert_allclose(nearest, 1, atol=1e-12)
