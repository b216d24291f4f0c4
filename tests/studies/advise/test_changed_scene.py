"""Remedies at the part and its lamps, in closed form."""

import numpy as np
import pytest

from materials.catalog import material
from materials.material import Matte
from scenes.build import coupon_scene
from scenes.reference_points import part_box
from scenes.scene import Lamp
from studies.advise.changed_scene import changed_scene, nearest_lamps


def scene():
    """A steel ball on the workshop's table under four panels."""
    return coupon_scene("ball", material("stainless_austenitic:polished"))


def flux(lamp: Lamp) -> float:
    """Up to a factor that all lamps share."""
    return lamp.radiance * lamp.width * lamp.height


def test_spray_makes_the_part_matte_and_nothing_else():
    """Table and walls keep what they are."""
    before, after = scene(), changed_scene(scene(), sprayed=True, tilt_deg=0.0, lamps="own")
    assert all(isinstance(body.material, Matte) for body in after.part_bodies)
    others = [(b.name, b.material) for b in before.bodies if not b.is_part]
    assert [(b.name, b.material) for b in after.bodies if not b.is_part] == others


def test_a_diffuser_sends_the_same_light_from_four_times_the_area():
    """Radiance falls as area grows."""
    before, after = scene(), changed_scene(scene(), sprayed=False, tilt_deg=0.0, lamps="diffuse")
    for one, other in zip(before.lamps, after.lamps, strict=True):
        assert flux(other) == pytest.approx(flux(one))
        assert other.width * other.height == pytest.approx(4 * one.width * one.height)


def test_lamps_are_swung_about_the_part():
    """A quarter turn about the vertical keeps height and distance; none comes to stand where one stood."""
    before, after = scene(), changed_scene(scene(), sprayed=False, tilt_deg=0.0, lamps="moved")
    assert len(nearest_lamps(before)) == 4
    middle = part_box(before).mean(axis=0)
    old, new = (np.array([lamp.T_world_lamp.translation for lamp in one.lamps]) for one in (before, after))
    np.testing.assert_allclose(np.linalg.norm(new - middle, axis=1), np.linalg.norm(old - middle, axis=1))
    np.testing.assert_allclose(new[:, 2], old[:, 2])
    assert np.linalg.norm(new[:, None] - old[None], axis=-1).min() > 0.2
    x, y = (old - middle)[:, 0], (old - middle)[:, 1]
    np.testing.assert_allclose((new - middle)[:, :2], np.column_stack([-y, x]), atol=1e-12)


def test_a_tilted_part_stands_on_the_same_table():
    """A plate's corners turned about x and set down: lowest point as before, edges as long."""
    before = coupon_scene("plate", material("iron:blasted"))
    after = changed_scene(before, sprayed=False, tilt_deg=30.0, lamps="own")
    assert part_box(after)[0, 2] == pytest.approx(part_box(before)[0, 2])
    one, other = before.part_mesh().vertices, after.part_mesh().vertices
    np.testing.assert_allclose(
        np.linalg.norm(np.diff(other, axis=0), axis=1), np.linalg.norm(np.diff(one, axis=0), axis=1)
    )
    np.testing.assert_allclose(other[:, 0], one[:, 0])
    dy, dz = (one - one[0])[:, 1], (one - one[0])[:, 2]
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    np.testing.assert_allclose(
        (other - other[0])[:, 1:], np.column_stack([c * dy - s * dz, s * dy + c * dz]), atol=1e-12
    )
