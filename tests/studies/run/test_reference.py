"""What of a surface can be seen from above, against closed forms: a ball, a cuboid, a lid over a floor."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from materials.catalog import material
from render.world.mitsuba_scene import load_scene
from render.world.visibility import LOWEST_ELEVATION, seen_from_above, upper_directions
from scenes.build import coupon_scene, part_scene
from scenes.parts import ALL_PARTS
from scenes.primitives import box, joined, moved
from scenes.reference_points import reference_points
from scenes.scene import Body, Scene
from studies.run.reference import N_DRAWN, N_REFERENCE, reference_surface

MATTE = material("matte_paint")


def _visible(scene: Scene):
    world = load_scene(scene)
    return lambda points, normals: seen_from_above(world, points, normals)


def test_directions_cover_the_hemisphere_evenly():
    """Unit vectors from 10 deg elevation up; by height (Archimedes) as many in every layer of equal thickness."""
    directions = upper_directions(256)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    assert directions[:, 2].min() > np.sin(LOWEST_ELEVATION)
    layers, _ = np.histogram(directions[:, 2], bins=4, range=(np.sin(LOWEST_ELEVATION), 1))
    assert layers.tolist() == [64] * 4


def test_ball_is_seen_down_to_ten_degrees_from_its_foot():
    """A point of a ball on a table is seen from elevation e if its normal is less than 90 deg from that direction.

    From 10 deg upwards that is every normal less than 170 deg from the zenith; of the rest nothing. The directions
    are 9 deg apart, so points within 10 deg of that limit may be missed.
    """
    scene = coupon_scene("ball", MATTE, room=False)
    points, normals = reference_points(scene, 4000)
    seen = _visible(scene)(points, normals)
    from_zenith = np.degrees(np.arccos(normals[:, 2]))
    assert seen[from_zenith < 160].all()
    assert not seen[from_zenith > 171].any()


def test_underside_of_a_plate_is_hidden_by_what_it_stands_over():
    """A lid 10 mm above a larger floor plate: its upper side is seen, its underside and the floor below it are not.

    Light could enter below the lid at no more than atan(10 mm / 100 mm) = 6 deg in its middle, under the lowest view.
    """
    lid = moved(box((0.2, 0.2, 0.004)), RigidTransform.from_translation([0, 0, 0.016]))
    floor = moved(box((0.3, 0.3, 0.004)), RigidTransform.from_translation([0, 0, 0.002]))
    scene = Scene("lid", (Body("lid", joined([lid, floor]), MATTE, is_part=True),), (), 0.0)
    points, normals = reference_points(scene, 4000)
    seen = _visible(scene)(points, normals)
    middle = np.abs(points[:, :2]).max(axis=1) < 0.03
    up = normals[:, 2] > 0.9
    assert seen[middle & up & (points[:, 2] > 0.017)].all()
    assert not seen[middle & up & (points[:, 2] < 0.005)].any()
    assert not seen[normals[:, 2] < -0.9].any()


def test_reference_points_are_uniform_over_the_visible_sides():
    """A level plate 100 x 100 x 4 mm: top to rims as 1 to 0.16 by area, the underside left out; distances are exact."""
    scene = coupon_scene("plate", MATTE, room=False)
    reference = reference_surface(scene, _visible(scene))
    assert len(reference.points) == N_REFERENCE
    on_top = np.isclose(reference.points[:, 2], 0.08, atol=1e-6)
    share = 1 / 1.16
    assert np.mean(on_top) == pytest.approx(share, abs=4 * np.sqrt(share * (1 - share) / N_REFERENCE))
    above = np.array([[0.0, 0.0, 0.09], [0.02, -0.03, 0.1]])
    assert reference.distance(above) == pytest.approx([0.01, 0.02], abs=5e-5)


def test_base_is_the_face_that_a_block_stands_on_and_as_dense_as_the_rest():
    """A block of 160 x 100 x 40 mm upright: 488 cm^2 seen, 40 cm^2 base, so 10,000 points that are seen and 820."""
    block = moved(box((0.1, 0.04, 0.16)), RigidTransform.from_translation([0, 0, 0.08]))
    scene = Scene("block", (Body("block", block, MATTE, is_part=True),), (), 0.0)
    reference = reference_surface(scene, lambda points, normals: normals[:, 2] > -0.5)
    assert len(reference.points) == N_REFERENCE
    expected = N_REFERENCE * 40 / 488
    assert len(reference.base) == pytest.approx(expected, abs=4 * np.sqrt(expected))
    assert np.all(reference.base[:, 2] == 0)


def test_what_stands_on_no_face_has_hardly_a_base():
    """By height (Archimedes) 1 - 0.99 of half a ball faces down within 8 deg, and 3/4 of the ball is seen here."""
    scene = coupon_scene("ball", MATTE, room=False)
    reference = reference_surface(scene, lambda points, normals: normals[:, 2] > -0.5)
    expected = N_REFERENCE * (0.01 / 2) / 0.75
    assert len(reference.base) == pytest.approx(expected, abs=4 * np.sqrt(expected))


def test_all_of_the_satin_block_but_its_foot_is_seen():
    """Part A, 100 x 40 x 160 mm, hides its base alone: 4000 of 52,800 mm^2 (chamfers of 0.3 mm change that by 0.1 %),
    within four standard deviations of a binomial draw."""
    n = 10_000
    scene = part_scene("A", room=False)
    hidden = 1 - _visible(scene)(*reference_points(scene, n)).mean()
    base = 100 * 40 / (2 * (100 * 40 + 100 * 160 + 40 * 160))
    assert hidden == pytest.approx(base, abs=4 * np.sqrt(base * (1 - base) / n) + 1e-3)


@pytest.mark.parametrize("part", ALL_PARTS)
def test_enough_of_every_part_is_seen(part):
    """The first draw of points must do: at least N_REFERENCE of N_DRAWN are in sight, or coverages would be coarser."""
    scene = part_scene(part, room=False)
    points, normals = reference_points(scene, 4000)
    assert _visible(scene)(points, normals).mean() > N_REFERENCE / N_DRAWN
