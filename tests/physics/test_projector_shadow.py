"""The projector stands 29 mm beside the left imager: its field and its shadows are displaced by closed forms."""

import numpy as np
import pytest

from materials.material import Matte
from render.d435i import SensorSettings, SimulatedD435i
from render.light.pattern import HALF_FIELD
from render.light.sampling import Sampling
from render.world.rig import BASELINE, PROJECTOR_OFFSET
from scenes.scene import Body, Scene
from tests.physics.simple_scenes import facing_x, rectangle, wall

POST, WALL = 0.5, 1.0
"""Distances of a post's face and of the wall behind it [m]."""
HALF_WIDTH = 0.03
"""Of the post [m]."""
EDGE_PX = 1.0
"""Error of an edge found at whole pixels [px]; half a column for the whole numbers, half for lack of dots there."""
SETTINGS = SensorSettings(crop=None)
DIRECT = Sampling(max_depth=1)


@pytest.fixture(scope="module")
def camera():
    """Before a post that stands before a wall, no lamps; direct light alone, since the post's back sends some of the
    wall's light into its own shadow."""
    face = rectangle([POST, 0, 0], [0, 0, 0], 2 * HALF_WIDTH, 4.0)
    scene = Scene("post", (*wall(WALL).bodies, Body("post", face, Matte("post", 0.5), True)), (), 0.0)
    return SimulatedD435i(scene, SETTINGS, sampling=DIRECT)


@pytest.fixture(scope="module")
def layers(camera):
    """Projector layers of both imagers."""
    return [side.projector for side in camera.render(facing_x())]


def edges_of_darkness(row):
    """Where the longest run of columns without any light begins and ends [px]. A column on an edge has some light, so
    the edges lie up to one column beyond the run's outer sides: the middle of that column is returned."""
    dark = np.flatnonzero(row == 0)
    runs = np.split(dark, np.flatnonzero(np.diff(dark) > 1) + 1)
    longest = max(runs, key=len)
    return longest[0] - 1.0, longest[-1] + 1.0


@pytest.mark.parametrize(("imager", "offset"), [(0, PROJECTOR_OFFSET), (1, PROJECTOR_OFFSET - BASELINE)])
def test_post_casts_its_shadow_beside_itself(layers, imager, offset):
    """Seen from an imager whose projector stands `offset` to the right, the shadow's edge on the wall lies
    f offset (1 / z_post - 1 / z_wall) columns left of the post's edge: the very parallax of a stereo pair of that
    baseline. At 640x360 that is 9.3 px left of the post for the left imager, three quarters of two dots' spacing, and
    6.7 px right of it for the right one."""
    image = layers[imager]
    f, cx = 321.0, 319.5
    imager_x = 0.0 if imager == 0 else BASELINE
    left, right = (cx + f * (side * HALF_WIDTH - imager_x) / POST for side in (-1, 1))
    parallax = f * offset * (1 / POST - 1 / WALL)
    shadow = (left - parallax, left) if offset > 0 else (right, right - parallax)
    assert abs(parallax) > 6
    columns = slice(round(left) - 40, round(right) + 40)
    first, last = (columns.start + edge for edge in edges_of_darkness(image[:, columns].max(axis=0)))
    assert first == pytest.approx(shadow[0], abs=EDGE_PX)
    assert last == pytest.approx(shadow[1], abs=EDGE_PX)


@pytest.mark.parametrize("imager", [0, 1])
def test_lifted_shadow_shows_the_wall_as_if_no_post_were_there(camera, layers, imager):
    """Light and lifted shadow together are the bare wall's light wherever the wall is seen; the post keeps its own."""
    bare = SimulatedD435i(wall(WALL), SETTINGS, sampling=DIRECT).render(facing_x())[imager].projector
    lifted = layers[imager] + camera.dots_in_shadow(facing_x())[imager]
    imager_x = 0.0 if imager == 0 else BASELINE
    sides = [319.5 + 321 * (side * HALF_WIDTH - imager_x) / POST for side in (-1, 1)]
    behind = np.s_[:, round(sides[0]) + 1 : round(sides[1])]
    beside = [np.s_[:, : round(sides[0]) - 1], np.s_[:, round(sides[1]) + 1 :]]
    for columns in beside:
        np.testing.assert_allclose(lifted[columns], bare[columns], rtol=1e-5)
    assert np.array_equal(lifted[behind], layers[imager][behind])
    assert np.any(lifted > layers[imager])


def test_field_ends_hard_on_all_sides():
    """The field is 86 x 57 deg about the projector's axis. Its sides move with the distance of the wall by the
    parallax f 29 mm / z; top and bottom stay. Beyond them there is no light at all, one pixel inside there is."""
    half_x, half_y = HALF_FIELD
    for distance in (0.4, 1.5):
        image = SimulatedD435i(wall(distance), SETTINGS).render(facing_x())[0].projector
        lit_columns, lit_rows = (np.flatnonzero(image.max(axis=axis) > 0) for axis in (0, 1))
        axis = 319.5 + 321 * PROJECTOR_OFFSET / distance
        assert lit_columns[0] == pytest.approx(axis - 321 * half_x, abs=EDGE_PX)
        assert lit_columns[-1] == pytest.approx(min(axis + 321 * half_x, 639), abs=EDGE_PX)
        assert lit_rows[0] == pytest.approx(179.5 - 321 * half_y, abs=EDGE_PX)
        assert lit_rows[-1] == pytest.approx(179.5 + 321 * half_y, abs=EDGE_PX)
