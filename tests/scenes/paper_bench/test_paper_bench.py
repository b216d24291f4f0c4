"""The paper's bench: what stands where, that nothing stands in anything else, how much light falls on the plinth."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from materials.input_error import InputError
from materials.lights import Band, black_body, imager_radiance_per_luminance, white_led
from scenes.build import part_scene
from scenes.lamps import form_integral
from scenes.paper_bench.hall import FLOOR, HALL_CENTRE, HALL_SIZE, hall, window
from scenes.paper_bench.lighting import BENCH_LIGHTING_NAMES, bench_lighting
from scenes.paper_bench.table import perforated_table, plinth, plinth_material
from scenes.paper_bench.task_lamp import lamp_on_arm, task_lamp
from scenes.primitives import box, cylinder
from scenes.scene import Body, Lamp
from scenes.topology import signed_volume

SHELL = ("floor", "walls", "ceiling")
FACES_OF_A_BOX = len(box((1.0, 1.0, 1.0)).faces)
FACES_OF_A_ROD = len(cylinder(1.0, 1.0, 24).faces)
PER_LUMINANCE = imager_radiance_per_luminance(white_led())
UP = np.array([0.0, 0.0, 1.0])
TABLE_Z = -0.045


def pieces(body: Body) -> list[tuple[np.ndarray, np.ndarray]]:
    """Lower and upper corners of the boxes and rods that a body is joined of, in the order of its faces."""
    faces = len(body.mesh.faces)
    if body.name == "task lamp":
        ends = [0, FACES_OF_A_BOX, FACES_OF_A_BOX + FACES_OF_A_ROD, faces]
    else:
        ends = [*range(0, faces, FACES_OF_A_BOX), faces]
    corners = [body.mesh.vertices[body.mesh.faces[a:b]].reshape(-1, 3) for a, b in pairwise(ends)]
    return [(points.min(axis=0), points.max(axis=0)) for points in corners]


def standing() -> list[Body]:
    """All of it but the hall's shell, which looks inward, and the holes, which are flat."""
    return [plinth(), *(b for b in (*perforated_table(), lamp_on_arm(), *hall()) if b.name not in (*SHELL, "holes"))]


def test_plinth_and_table_are_as_the_photographs_show_them():
    """250 mm wide, 45 mm thick, black, its top at z = 0; panels and profiles of 45 mm end flush at its foot."""
    block = plinth()
    np.testing.assert_allclose(block.mesh.vertices.min(axis=0), [-0.125, -0.125, TABLE_Z], atol=1e-12)
    np.testing.assert_allclose(block.mesh.vertices.max(axis=0), [0.125, 0.125, 0.0], atol=1e-12)
    assert block.material.name == "black_paint"
    panels, _, profiles = perforated_table()
    assert panels.mesh.vertices[:, 2].max() == pytest.approx(TABLE_Z)
    assert profiles.mesh.vertices[:, 2].max() == pytest.approx(TABLE_Z)
    assert profiles.mesh.vertices[:, 2].min() == pytest.approx(2 * TABLE_Z)


def test_profiles_have_a_groove_as_long_as_they_are():
    """Nine of them with a groove of 10 x 15 mm in the upper face: three of 2.135 m along y and six of 0.7 m between."""
    *_, profiles = perforated_table()
    length = 3 * (2 * 1.0 + 3 * 0.045) + 6 * 0.7
    assert signed_volume(profiles.mesh.vertices, profiles.mesh.faces) == pytest.approx(
        length * (0.045 * 0.045 - 0.010 * 0.015)
    )


def test_holes_are_dots_in_the_panels_beside_the_plinth():
    """Each lies on one panel, 0.1 mm above it, clear of profiles and plinth; neighbours are 60 mm apart."""
    panels, holes, _ = perforated_table()
    dots = holes.mesh.vertices[holes.mesh.faces].reshape(-1, 10, 3, 3)  # a dot of 12 corners is 10 triangles
    low, high = dots.min(axis=(1, 2)), dots.max(axis=(1, 2))
    np.testing.assert_allclose(dots[..., 2], TABLE_Z + 1e-4, atol=1e-12)
    on_panel = sum(((low > a) & (high < b))[:, :2].all(axis=1).astype(int) for a, b in pieces(panels))
    assert (on_panel == 1).all()
    assert (np.maximum(low, -high)[:, :2].max(axis=1) > 0.125).all()
    centres = (low + high)[:, :2] / 2
    apart = np.linalg.norm(centres[:, None] - centres, axis=-1) + np.eye(len(centres))
    np.testing.assert_allclose(apart.min(axis=1), 0.060, atol=1e-9)


def test_no_body_stands_in_another():
    """Boxes around all pieces: no two of different bodies share more than a face, and none leaves the hall."""
    lower = np.array([HALL_CENTRE[0] - HALL_SIZE[0] / 2, HALL_CENTRE[1] - HALL_SIZE[1] / 2, FLOOR])
    bodies = standing()
    for body in bodies:
        for a, b in pieces(body):
            assert (a > lower - 1e-9).all(), body.name
            assert (b < lower + HALL_SIZE + 1e-9).all(), body.name
    for one, other in combinations(bodies, 2):
        for a, b in pieces(one):
            for c, d in pieces(other):
                overlap = np.minimum(b, d) - np.maximum(a, c)
                assert overlap.min() < 1e-9, (one.name, other.name)


def test_lamps_hang_in_the_open():
    """Every emitter lies in the hall and in none of its bodies; the task lamp's 0.5 mm before its own housing."""
    for lamp in bench_lighting("task").lamps:
        x, y = lamp.width / 2, lamp.height / 2
        corners = lamp.T_world_lamp.apply(np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]]))
        a, b = corners.min(axis=0), corners.max(axis=0)
        for body in standing():
            if body.name != "task lamp":
                assert all((np.minimum(b, d) - np.maximum(a, c)).min() < 0 for c, d in pieces(body)), lamp.name
    housing = lamp_on_arm().mesh
    head = task_lamp().T_world_lamp.inv().apply(housing.vertices[housing.faces[:FACES_OF_A_BOX]].reshape(-1, 3))
    assert head[:, 2].max() == pytest.approx(-5e-4)


def test_the_hall_is_closed_around_the_bench():
    """Floor, walls and ceiling enclose 10 x 10 x 5 m, their faces turned in; the floor is 0.85 m under the table."""
    corners = [body.mesh.vertices[body.mesh.faces] for body in hall() if body.name in SHELL]
    volume = sum(float(np.linalg.det(triangles).sum()) / 6 for triangles in corners)
    assert volume == pytest.approx(-500.0)
    assert hall()[0].mesh.vertices[:, 2] == pytest.approx(TABLE_Z - 0.85)


def irradiance(lamp: Lamp, point: tuple[float, float, float], normal: np.ndarray) -> float:
    """At a point, per radiance of the lamp [sr], by adaptive quadrature over its surface."""
    centre, axes = lamp.T_world_lamp.translation, lamp.T_world_lamp.rotation.as_matrix().T

    def density(v: float, u: float) -> float:
        way = np.array(point) - (centre + u * axes[0] + v * axes[1])
        r2 = float(way @ way)
        return max(float(way @ axes[2]), 0.0) * max(float(-way @ normal), 0.0) / r2**2

    x, y = lamp.width / 2, lamp.height / 2
    return dblquad(density, -x, x, -y, y, epsrel=1e-6)[0]


def test_task_lamp_sends_out_its_flux():
    """A Lambertian front of 1200 lm has the intensity 1200 / pi cd along its axis: 1200 / (25 pi) lx at 5 m, where its
    size counts 0.2 %."""
    lamp = task_lamp()
    axis = lamp.T_world_lamp.rotation.apply(UP)
    far = lamp.T_world_lamp.translation + 5.0 * axis
    lux = lamp.radiance / PER_LUMINANCE * irradiance(lamp, (far[0], far[1], far[2]), -axis)
    assert lux == pytest.approx(1200 / (25 * np.pi), rel=0.003)


def test_task_lamp_shines_at_the_object_from_where_it_stands():
    """0.5 m beside the plinth's middle and 0.4 m above it, its axis through the object's middle, opposite the robot."""
    pose = task_lamp().T_world_lamp
    assert np.linalg.norm(pose.translation[:2]) == pytest.approx(0.5, abs=0.01)
    assert pose.translation[2] == pytest.approx(0.4)
    to_object = np.array([0.0, 0.0, 0.1]) - pose.translation
    np.testing.assert_allclose(pose.rotation.apply(UP), to_object / np.linalg.norm(to_object), atol=1e-9)
    ends = pose.apply([[-0.2, 0, 0], [0.2, 0, 0]])
    assert abs(ends[0, 2] - ends[1, 2]) > 0.2  # the photograph shows one end well above the other


def test_light_on_the_plinth():
    """By adaptive quadrature of our own: 300 lx from the hall (EN 12464-1), and from the task lamp what its flux gives
    when it is spread over a line of 0.4 m that slants by 45 deg, its upper end away from the photographer (+y), within
    the 0.5 % that the strip's 5 cm may count. The windows' daylight is a few percent of it, so that one kind of light
    for all is nearly right."""
    light = {lamp.name: lamp for lamp in bench_lighting("task").lamps}
    lux = {name: lamp.radiance / PER_LUMINANCE * irradiance(lamp, (0, 0, 0), UP) for name, lamp in light.items()}
    for name, lamp in light.items():
        coarse = lamp.radiance / PER_LUMINANCE * form_integral(lamp, np.zeros(3), UP)
        assert lux[name] == pytest.approx(coarse, rel=2e-3), name
    assert lux["row_0"] + lux["row_1"] == pytest.approx(300.0, rel=2e-3)
    middle, aim = np.array([0.5, 0.05, 0.4]), np.array([-0.5, -0.05, -0.3]) / np.linalg.norm([0.5, 0.05, 0.3])
    level = np.array([-0.05, 0.5, 0.0]) / np.linalg.norm([0.05, 0.5])
    axis = (level + np.cross(level, aim) * np.sign(np.cross(level, aim)[2])) / np.sqrt(2)

    def of_line(u: float) -> float:
        place = middle + u * axis
        return float(-place @ aim) * float(place[2]) / float(place @ place) ** 2

    on_line = 1200 / np.pi / 0.4 * quad(of_line, -0.2, 0.2)[0]
    assert lux["task lamp"] == pytest.approx(on_line, rel=0.005)
    assert lux["window"] < 0.03 * (lux["task lamp"] + 300)


def test_windows_are_as_bright_as_an_overcast_sky_through_glass():
    """10 klx by the sky's own integral (ISO 15469: (1 + 2 sin g) / 3 of the zenith at elevation g), seen through glass
    of 0.7 where the table's middle sees the strip. Daylight has more infrared than LEDs: it counts more to the imager.
    """
    up, away = 2.1 - 0.85 - 0.045, 7.3  # the strip's middle over the plinth's top; the gate's distance [m]
    horizontal = 2 * np.pi * quad(lambda g: (1 + 2 * np.sin(g)) / 3 * np.sin(g) * np.cos(g), 0, np.pi / 2)[0]
    luminance = 0.7 * 10_000 / horizontal * (1 + 2 * up / np.hypot(up, away)) / 3
    daylight = imager_radiance_per_luminance(black_body(6504.0))
    assert window().radiance / daylight == pytest.approx(luminance, rel=1e-3)
    assert daylight > PER_LUMINANCE
    assert window().T_world_lamp.rotation.apply(UP) == pytest.approx([0, -1, 0])


def test_presets_of_the_bench():
    """`task` is `hall` and the task lamp; `off` is dark; a workshop's preset is refused in one line."""
    names = {name: {lamp.name for lamp in bench_lighting(name).lamps} for name in BENCH_LIGHTING_NAMES}
    assert names["task"] - names["hall"] == {"task lamp"}
    assert names["off"] == set()
    assert bench_lighting("task").band is Band.WHITE_LED
    assert bench_lighting("off").ambient_radiance == 0
    with pytest.raises(InputError, match=r"^lamps workshop: the paper's bench has none; known: task, hall, off$"):
        bench_lighting("workshop")
    with pytest.raises(InputError, match=r"^plinth red: there is none; "):
        plinth_material("red")


def test_a_scene_on_the_paper_s_bench():
    """Plinth, table, lamp and hall in place of table and room; the lamp alone is in a robot's way. The plinth is of the
    material that is asked for, and without the hall its indirect light stands in."""
    scene = part_scene("D", bench="paper")
    names = [body.name for body in scene.bodies if not body.is_part]
    assert names[:5] == ["plinth", "panels", "holes", "profiles", "task lamp"]
    assert len(names) == 5 + len(hall())
    assert [body.name for body in scene.fixtures] == ["task lamp"]
    assert {lamp.name for lamp in scene.lamps} == {"task lamp", "row_0", "row_1", "window"}
    assert scene.ambient_radiance == 0
    bare = part_scene("D", lamps="hall", table_material=plinth_material("white"), room=False, bench="paper")
    assert len(bare.bodies) == len(scene.bodies) - len(hall())
    assert bare.ambient_radiance > 0
    assert next(body for body in bare.bodies if body.name == "plinth").material.name == "white_paint"
