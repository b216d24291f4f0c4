"""Right, false and missing depth by surface, on images that are known."""

import numpy as np
import pytest

from franbv.frames import Intrinsics
from materials.catalog import material
from render.world.truth import Truth
from scenes.build import coupon_scene
from studies.advise.scoring import (
    NO_DEPTH,
    RIGHT_DEPTH,
    WRONG_DEPTH,
    MeasuredPart,
    fused_outcome,
    near_part,
)
from studies.advise.stored_light import FACINGS, SeenPart, facings, seen_part
from studies.scoring.missing_surface import pixel_areas


def seen(area: np.ndarray) -> SeenPart:
    """A part half a metre away."""
    none = np.zeros(area.shape, np.uint8)
    return SeenPart(np.full(area.shape, 0.5, np.float32), area.astype(np.float32), none, none)


def test_areas_of_pixels_sum_to_the_surface_that_they_look_at():
    """A plane at 0.5 m across the axis and one tilted by 50 deg about y: the surface between the image's edges, in
    closed form, to the midpoint rule's error."""
    k = Intrinsics(64, 48, 60.0, 60.0, 31.5, 23.5)
    v, u = np.mgrid[:48, :64]
    x, y = (u - k.cx) / k.fx, (v - k.cy) / k.fy
    rays = np.stack([x, y, np.ones_like(x)], axis=-1)
    for tilt in (0.0, np.radians(50)):
        normal = np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
        depth = (0.5 * normal[2] / (rays @ normal)).astype(np.float32)
        incidence = np.arccos(-(rays @ normal) / np.linalg.norm(rays, axis=-1)).astype(np.float32)
        edges = np.array([-32.0, 32.0]) / k.fx
        # z = 0.5 / (1 - x tan), s along the slope = x z / cos; its height at that place is 2 y_max z.
        fine = np.linspace(edges[0], edges[1], 200_001)
        z = 0.5 / (1 - fine * np.tan(tilt))
        along = fine * z / np.cos(tilt)
        exact = np.trapezoid(2 * 24 / k.fy * z, along)
        assert pixel_areas(
            depth.astype(float), incidence.astype(float), k, np.cos(np.radians(80.0))
        ).sum() == pytest.approx(exact, rel=2e-3)


def test_surface_that_is_too_steep_for_any_matcher_does_not_count():
    """A plate under 0, 64 and 66 deg, and the table: of the second 1 / cos of the first, of the rest none."""
    scene = coupon_scene("plate", material("iron:blasted"))
    body = next(index for index, one in enumerate(scene.bodies) if one.is_part)
    table = next(index for index, one in enumerate(scene.bodies) if not one.is_part)
    shape, seen_at = (1, 4), np.radians([[0.0, 64.0, 66.0, 0.0]]).astype(np.float32)
    yes, up = np.ones(shape, bool), np.broadcast_to(np.array([0, 0, 1], np.float32), (*shape, 3))
    bodies = np.array([[body, body, body, table]], np.uint8)
    truth = Truth(np.full(shape, 0.5, np.float32), up, seen_at, bodies, yes, yes, yes)
    k = Intrinsics(4, 1, 1e6, 1e6, 1.5, 0.0)  # as good as parallel rays
    face_on = 0.25 / 1e12
    found = seen_part(truth, scene, k).area
    np.testing.assert_allclose(found, [[face_on, face_on / np.cos(np.radians(64.0)), 0.0, 0.0]], rtol=1e-5)


def test_surface_counts_and_not_pixels():
    """A steep pixel of 3 mm^2 that is right, and three of 1 mm^2 that are not."""
    part = seen(np.array([[3e-6, 1e-6], [1e-6, 1e-6]]))
    outcome = np.array([[RIGHT_DEPTH, WRONG_DEPTH], [NO_DEPTH, WRONG_DEPTH]], np.uint8)
    error = np.array([[0.001, 0.02], [0.5, 0.03]], np.float32)
    count = MeasuredPart(part, outcome, error, error, outcome).count
    assert count.right / count.seen == pytest.approx(3 / 6)
    assert count.false / count.seen == pytest.approx(2 / 6)
    assert count.error_mm == pytest.approx(20.0)


def test_what_is_not_the_part_does_not_count():
    """A wall that is measured wrongly."""
    part = seen(np.array([[1e-6, 0.0]]))
    outcome = np.array([[RIGHT_DEPTH, WRONG_DEPTH]], np.uint8)
    error = np.zeros((1, 2), np.float32)
    count = MeasuredPart(part, outcome, error, error, outcome).count
    assert (count.right, count.false) == (count.seen, 0.0)


def test_two_looks_fill_each_others_holes_and_contradict_each_other():
    """All nine pairs."""
    kinds = (NO_DEPTH, RIGHT_DEPTH, WRONG_DEPTH)
    mine, other = (np.array(side, np.uint8) for side in zip(*((a, b) for a in kinds for b in kinds), strict=True))
    wanted = [
        NO_DEPTH,
        RIGHT_DEPTH,
        WRONG_DEPTH,
        RIGHT_DEPTH,
        RIGHT_DEPTH,
        NO_DEPTH,
        WRONG_DEPTH,
        NO_DEPTH,
        WRONG_DEPTH,
    ]
    assert fused_outcome(mine, other).tolist() == wanted


def test_the_box_around_the_part_reaches_64_pixels_farther_and_ends_at_the_image():
    """One pixel at row 70, column 10 of 200 x 300."""
    area = np.zeros((200, 300))
    area[70, 10] = 1e-6
    rows, columns = (np.flatnonzero(near_part(seen(area)).any(axis=axis)) for axis in (1, 0))
    assert (rows[0], rows[-1], columns[0], columns[-1]) == (6, 134, 0, 74)


def test_faces_are_named_by_where_they_look():
    """Unit normals along the axes, and one between two of them."""
    diagonal = np.sqrt(0.5)
    normals = [[0, 0, 1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [diagonal, 0, diagonal], [0, 0, -1]]
    found = facings(np.array([normals], np.float32))
    assert [FACINGS[k] for k in found[0]] == list(FACINGS)
