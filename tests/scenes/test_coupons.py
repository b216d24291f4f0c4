"""Coupons: where their surfaces are and how they are turned, against plain trigonometry."""

import numpy as np
import pytest

from materials.catalog import material
from materials.input_error import InputError
from scenes.build import COUPONS, coupon_scene
from scenes.coupons import ball_on_metal_table, inside_corner, plate, plate_centre_height, plate_normal, wall
from scenes.reference_points import part_box
from scenes.topology import open_edge_count, signed_volume
from tests.scenes.tangents import centres, u_directions, unit_normals

STEEL = material("stainless_austenitic:ground")


@pytest.mark.parametrize(("tilt_deg", "axis_deg"), [(0, 0), (30, 0), (60, 90), (90, 37), (17, -120)])
def test_plate_turns_about_the_middle_of_its_front(tilt_deg, axis_deg):
    """Tilting by t about a level axis of azimuth a gives the normal (sin t sin a, -sin t cos a, cos t); the front's
    centre stays, and the 4 mm lie behind it. The lay runs along the axis when no angle is asked for."""
    tilt, axis = np.deg2rad([tilt_deg, axis_deg])
    body = plate(STEEL, float(tilt), float(axis))[0]
    expected = [np.sin(tilt) * np.sin(axis), -np.sin(tilt) * np.cos(axis), np.cos(tilt)]
    np.testing.assert_allclose(plate_normal(float(tilt), float(axis)), expected, atol=1e-12)
    front = unit_normals(body.mesh) @ expected > 0.99
    assert front.sum() == 2
    corners = body.mesh.vertices[np.unique(body.mesh.faces[front])]
    np.testing.assert_allclose(corners.mean(axis=0), [0, 0, 0.08], atol=1e-12)
    assert plate_centre_height(0.1) == pytest.approx(0.08)
    assert np.min((body.mesh.vertices - [0, 0, 0.08]) @ expected) == pytest.approx(-0.004)
    assert np.abs(u_directions(body.mesh)[front] @ [np.cos(axis), np.sin(axis), 0]).min() > 1 - 1e-9


@pytest.mark.parametrize("tilt_deg", [0, 45, 90])
def test_stage_stays_behind_the_plate_and_above_the_table(tilt_deg):
    """No point of the stage reaches the front plane within the plate's outline, and nothing is below the table. The
    base may: it lies flat in front of an upright plate's foot, below its edge."""
    tilt = float(np.deg2rad(tilt_deg))
    front, stage = plate(STEEL, tilt)
    assert not stage.is_part
    assert stage.mesh.vertices[:, 2].min() > -1e-12
    assert front.mesh.vertices[:, 2].min() > 0.02
    height = (stage.mesh.vertices - [0, 0, 0.08]) @ plate_normal(tilt)
    inside = stage.mesh.vertices[:, 2] > 0.03 - 1e-9
    assert height[inside].max() < 0


def test_corner_plates_meet_and_look_inward():
    """Two or three plates at right angles: their inner faces are the planes z = t, y = s/2 and x = -s/2."""
    for faces in (2, 3):
        bodies = inside_corner(STEEL, faces, size=0.1, thickness=0.006)
        assert [body.name for body in bodies] == ["floor", "back", "left"][:faces]
        assert all(open_edge_count(body.mesh) == 0 for body in bodies)
        planes = [([0, 0, 1], 0.006), ([0, -1, 0], -0.05), ([1, 0, 0], -0.05)]
        for body, (normal, offset) in zip(bodies, planes, strict=False):
            inner = unit_normals(body.mesh) @ normal > 0.99
            np.testing.assert_allclose(centres(body.mesh)[inner] @ normal, offset, atol=1e-12)


def test_wall_stands_at_its_distance_and_fills_the_view():
    """x = distance everywhere, facing the origin; half its width seen from there is over 43.5 deg, half a D435i's."""
    scene = wall(0.7, STEEL)
    mesh = scene.bodies[0].mesh
    np.testing.assert_allclose(mesh.vertices[:, 0], 0.7)
    np.testing.assert_allclose(unit_normals(mesh), [[-1, 0, 0], [-1, 0, 0]], atol=1e-12)
    assert np.rad2deg(np.arctan(mesh.vertices[:, 1].max() / 0.7)) > 43.5
    assert np.rad2deg(np.arctan(mesh.vertices[:, 2].max() / 0.7)) > 28.5
    assert scene.lamps == ()
    assert scene.ambient_radiance == 0


def test_ball_lies_on_the_metal_table():
    """Every point of the ball is one radius from its centre, which is one radius above the table."""
    scene = ball_on_metal_table(material("gold:polished"), STEEL, radius=0.0435)
    (body,) = scene.part_bodies
    np.testing.assert_allclose(np.linalg.norm(body.mesh.vertices - [0, 0, 0.0435], axis=1), 0.0435)
    table = next(body for body in scene.bodies if not body.is_part)
    assert table.mesh.vertices[:, 2].max() == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("name", COUPONS)
def test_every_coupon_stands_on_the_table(name):
    """Closed, outward, not under the table; the part alone is marked as such."""
    scene = coupon_scene(name, STEEL, room=False)
    assert part_box(scene)[0, 2] > -1e-12
    for body in scene.bodies:
        assert open_edge_count(body.mesh) == 0
        assert signed_volume(body.mesh.vertices, body.mesh.faces) > 0
        assert body.is_part == (body.name not in ("stage", "table"))
    assert all(body.material == STEEL for body in scene.part_bodies)


@pytest.mark.parametrize(
    ("name", "shape", "message"),
    [
        ("plate", {"tilt": 2.0}, r"^plate: tilt is 114\.6 deg; give 0 \(face up\) to 90 \(upright\)$"),
        ("plate", {"size": 0.0}, r"^plate: size is 0 m; give a positive length$"),
        ("ball", {"radius": float("nan")}, r"^ball: radius is nan m; give a positive length$"),
        ("inside_corner", {"faces": 4}, r"^corner: 4 faces; give 2 or 3$"),
        ("bal", {}, r"^coupon bal: there is none; did you mean ball\?$"),
    ],
)
def test_bad_coupons_are_named(name, shape, message):
    """One line with thing, place and mend."""
    with pytest.raises(InputError, match=message):
        coupon_scene(name, STEEL, **shape)
