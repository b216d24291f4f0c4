"""Whole silhouettes: on all sides of the image, hidden, and where a ray along an edge sees what others do not."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from materials.material import Matte
from render.world.mitsuba_scene import LoadedScene, load_scene
from scenes.primitives import box, moved
from scenes.scene import Body, Scene
from studies.dataset.make.view import NO_BOX, bounding_box, object_silhouette

K = Intrinsics(64, 48, 50.0, 50.0, 31.5, 23.5)
"""The camera stands at the origin and looks along z."""


def cube(u: float, v: float) -> LoadedScene:
    """A cube of 0.2 m whose middle is seen at (u, v) [px] from 1 m."""
    middle = RigidTransform.from_translation([(u - K.cx) / K.fx, (v - K.cy) / K.fy, 1.0])
    return load_scene(
        Scene("cube", (Body("cube", moved(box((0.2, 0.2, 0.2)), middle), Matte("m", 0.5), True),), (), 0.0)
    )


def seen_alone(u: float, v: float) -> tuple[LoadedScene, np.ndarray]:
    """The cube, and the pixels in the image that its front face fills: 11 px wide and high, at 0.9 m."""
    rows, columns = np.mgrid[: K.height, : K.width]
    half = 0.1 / 0.9 * K.fx
    front_u, front_v = K.cx + (u - K.cx) / 0.9, K.cy + (v - K.cy) / 0.9
    return cube(u, v), (np.abs(columns - front_u) < half) & (np.abs(rows - front_v) < half)


@pytest.mark.parametrize(
    ("u", "v"), [(100, 24), (-40, 24), (32, 85), (32, -40), (110, 90), (64, 24), (32, 0), (32, 24)]
)
def test_on_all_sides_of_the_image(u: float, v: float):
    """Box and count go beyond the image, the mask is what is inside; the front face lies in it."""
    world, front = seen_alone(u, v)
    whole = object_silhouette(world, K, RigidTransform.identity(), front)
    assert np.all(whole.mask[front])
    x, y, w, h = whole.box if front.any() else (0, 0, 0, 0)
    inside = np.count_nonzero(whole.mask)
    assert whole.pixels >= 121  # 11 x 11 px of the front face
    if (u, v) == (32, 24):
        assert (whole.box, whole.pixels) == (bounding_box(whole.mask), inside)
    if front.any():
        assert w >= 11
        assert h >= 11
        assert (x < 0 or y < 0 or x + w > K.width or y + h > K.height) == (whole.pixels > inside)
    else:
        assert (whole.box, inside) == (NO_BOX, 0)


def test_what_is_hidden_has_no_box():
    """As BOP writes it; its pixels are counted all the same."""
    whole = object_silhouette(cube(32, 24), K, RigidTransform.identity(), np.zeros((K.height, K.width), bool))
    assert whole.box == NO_BOX
    assert whole.pixels == np.count_nonzero(whole.mask) >= 121


def test_a_pixel_that_only_the_whole_scene_shows_counts():
    """One more pixel beside the silhouette: mask, box and count hold it."""
    world, front = seen_alone(32, 24)
    without = object_silhouette(world, K, RigidTransform.identity(), front)
    x, y, w, h = without.box
    front[y + h // 2, x + w] = True
    whole = object_silhouette(world, K, RigidTransform.identity(), front)
    assert whole.mask[y + h // 2, x + w]
    assert whole.pixels == without.pixels + 1 == np.count_nonzero(whole.mask)
    assert whole.box == (x, y, w + 1, h)
