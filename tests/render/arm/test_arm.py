"""The simulated arm: where it may stand, why not elsewhere, and how long it moves."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.candidates import first_view
from franbv.frames import look_at, rolled
from franbv.parameters import Parameters
from materials.input_error import InputError
from render.arm.arm import CLEARANCE, ArmLimits, SimulatedArm, motion_time, trapezoidal_time
from render.arm.camera_body import CAMERA_BODIES, WRIST_RADIUS, CameraBody
from render.arm.solid import Solid
from scenes.paper_bench.task_lamp import lamp_on_arm, task_lamp
from scenes.scene import Mesh

BODY = CAMERA_BODIES["d435i"]
BLOCK = (0.2, 0.1, 0.08)
"""Sides of the block that stands on the table [m]."""


def block(height_above_table: float = 0.0, size: tuple[float, float, float] = BLOCK) -> Mesh:
    """A closed block above the origin."""
    box = trimesh.creation.box(size)
    return Mesh(box.vertices + np.array([0, 0, size[2] / 2 + height_above_table]), box.faces)


@pytest.fixture
def arm() -> SimulatedArm:
    """An arm beside the block."""
    return SimulatedArm.around(block())


def above(z: float) -> RigidTransform:
    """The camera over the origin, looking straight down."""
    return look_at(np.array([0.0, 0.0, z]), np.zeros(3))


@pytest.mark.parametrize("polar_deg", [20.0, 40.0, 60.0, 80.0])
def test_views_on_a_hemisphere_are_free(arm, polar_deg):
    """The planner's rings, 40 cm about the block, are all reachable: nothing is near them."""
    polar = np.radians(polar_deg)
    for azimuth in np.radians(np.arange(0, 360, 45)):
        direction = np.array([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)])
        centre = np.array([0, 0, 0.04])
        assert arm.obstacle(look_at(centre + 0.4 * direction, centre)) is None


def test_front_may_come_within_the_clearance_and_no_nearer(arm):
    """Looking down, the housing's front is 4.3 mm below the depth origin: contact starts at 80 + 4.3 + 5 mm."""
    limit = BLOCK[2] + BODY.box[1, 2] + CLEARANCE
    assert arm.obstacle(above(limit + 2e-4)) is None
    assert arm.obstacle(above(limit - 2e-4)) == "touches part"


def test_housing_reaches_farther_to_the_right_than_to_the_left():
    """The left imager is 17.5 mm left of the middle: 62.5 mm of housing on its right, 27.5 mm on its left."""
    np.testing.assert_allclose(BODY.box[:, 0], [-0.0275, 0.0625])
    slab = SimulatedArm.around(block(size=(0.02, 0.4, 0.3)))
    along_the_slab = look_at(np.array([0.0, 0.0, 0.25]), np.array([0.0, 0.5, 0.25]))  # image x axis is world +x
    for x, expected in ((0.055, None), (-0.055, "touches part")):
        pose = RigidTransform.from_translation([x, 0.0, 0.0]) * along_the_slab
        assert slab.obstacle(pose) == expected


def test_reasons(arm):
    """Every way to be blocked says which it is."""
    assert arm.obstacle(above(-0.05)) == "under table"
    low = look_at(np.array([-0.4, 0.0, 0.03]), np.array([0.0, 0.0, 0.03]))
    assert arm.obstacle(low) == "under table"
    assert arm.obstacle(look_at(np.array([0.0, 0.95, 0.3]), np.zeros(3))) == "outside workspace"
    assert arm.obstacle(look_at(np.array([0.8, 0.3, 0.3]), np.zeros(3))) == "out of reach"
    hall = SimulatedArm.around(block(0.01, (0.6, 0.6, 0.6)))
    assert hall.obstacle(look_at(np.array([0.0, 0.0, 0.3]), np.array([0.1, 0.0, 0.3]))) == "inside part"


def test_reachable_is_the_lack_of_an_obstacle(arm):
    """`reachable` and `move_to` agree with `obstacle`; a blocked move is an input error that names the reason."""
    assert arm.reachable(above(0.4))
    assert not arm.reachable(above(0.05))
    with pytest.raises(InputError, match="under table"):
        arm.move_to(above(-0.05))


def test_moves_start_where_the_last_one_ended(arm):
    """Going to a pose takes time, staying there none; there and back take the same."""
    here, there = above(0.4), look_at(np.array([0.3, 0.0, 0.3]), np.zeros(3))
    arm.move_to(here)
    assert arm.move_to(here) == pytest.approx(0.0, abs=1e-6)
    out = arm.move_to(there)
    assert out > 0.1
    assert arm.move_to(here) == pytest.approx(out)


@pytest.mark.parametrize(("way", "seconds"), [(0.0, 0.0), (0.5, 1.0), (2.0, 2.0), (4.0, 3.0), (8.0, 5.0)])
def test_trapezoid(way, seconds):
    """Speed 2, acceleration 2: 2 sqrt(s / a) up to s = v^2 / a = 2, then s / v + v / a."""
    assert trapezoidal_time(way, 2.0, 2.0) == pytest.approx(seconds)


def test_trapezoid_is_continuous():
    """Both branches meet where the top speed is just reached."""
    assert trapezoidal_time(2.0 - 1e-9, 2.0, 2.0) == pytest.approx(trapezoidal_time(2.0, 2.0, 2.0))


def test_slower_of_way_and_turn_decides():
    """1 m without a turn takes 1 / v + v / a; a half turn about the wrist takes pi / omega + omega / alpha."""
    limits = ArmLimits()
    start = above(0.5)
    shifted = RigidTransform.from_translation([0.0, 1.0, 0.0]) * start
    assert motion_time(start, shifted, limits) == pytest.approx(1 / 1.25 + 1.25 / 2.5)
    wrist = RigidTransform.from_translation(BODY.wrist_axis[1])
    about_wrist = wrist * RigidTransform.from_rotation(Rotation.from_euler("z", np.pi)) * wrist.inv()
    assert motion_time(start, start * about_wrist, limits) == pytest.approx(180 / 200 + 200 / 400)


def test_body_distances_against_dense_samples():
    """Closed-form distances agree with the nearest of many points spread through the solids."""
    rng = np.random.default_rng(0)
    queries = rng.uniform(-0.15, 0.15, (40, 3)) + np.array([0.0, 0.0, -0.08])
    inside_box = rng.uniform(*BODY.box, (200_000, 3))
    spheres = rng.normal(size=(200_000, 3))
    spheres *= WRIST_RADIUS * rng.random((200_000, 1)) ** (1 / 3) / np.linalg.norm(spheres, axis=1, keepdims=True)
    inside_wrist = spheres + BODY.wrist_axis[0] + rng.random((200_000, 1)) * (BODY.wrist_axis[1] - BODY.wrist_axis[0])
    for distance, inside in ((BODY.box_distance, inside_box), (BODY.wrist_distance, inside_wrist)):
        nearest = np.array([np.linalg.norm(inside - query, axis=1).min() for query in queries])
        np.testing.assert_allclose(distance(queries), nearest, atol=0.006)


@pytest.mark.parametrize("model", CAMERA_BODIES)
def test_ball_holds_the_whole_body(model):
    """The ball that preselects surface points encloses housing and wrist."""
    body = CAMERA_BODIES[model]
    assert np.linalg.norm(body.corners - body.ball_centre, axis=1).max() < body.ball_radius
    assert np.linalg.norm(body.wrist_axis - body.ball_centre, axis=1).max() + WRIST_RADIUS < body.ball_radius


def test_winding_number_of_nested_and_open_meshes():
    """1 inside, 0 outside, about 0.83 in the middle of a cube that lacks one of its six sides."""
    solid = Solid.from_mesh(block())
    assert solid.winding_number(np.array([0.05, 0.02, 0.04])) == pytest.approx(1.0)
    assert solid.winding_number(np.array([0.0, 0.0, 0.2])) == pytest.approx(0.0)
    cube = trimesh.creation.box((0.1, 0.1, 0.1))
    top = np.all(cube.triangles[:, :, 2] > 0, axis=1)
    assert Solid.from_mesh(Mesh(cube.vertices, cube.faces[~top])).winding_number(np.zeros(3)) == pytest.approx(5 / 6)


def test_surface_points_are_dense():
    """No place of the surface is farther from a sample than the clearance by more than chance allows."""
    solid = Solid.from_mesh(block())
    points, _ = trimesh.sample.sample_surface(trimesh.Trimesh(block().vertices, block().faces), 2000, seed=1)
    assert solid.samples.query(points)[0].max() < 3 * CLEARANCE
    assert np.percentile(solid.samples.query(points)[0], 95) < CLEARANCE


def test_the_outline_follows_the_roll():
    """On end, clockwise, the D435i's 62.5 mm right of the left imager hang below its axis, upright 12.5 mm do: level at
    40 mm above the table the one pose is free and the other under it."""
    level = look_at(np.array([-0.4, 0.0, 0.04]), np.array([0.0, 0.0, 0.04]))
    thin = SimulatedArm(Solid.from_mesh(block()), body=CameraBody(BODY.box * [1, 1, 0.01]))
    lowest = [rolled(level, roll).apply(thin.body.corners)[:, 2].min() for roll in (0.0, 90.0, -90.0)]
    assert lowest == pytest.approx([0.04 - 0.0125, 0.04 - 0.0625, 0.04 - 0.0275])
    assert [BODY.reach_below(roll) for roll in (0.0, 90.0, -90.0)] == pytest.approx([0.0125, 0.0625, 0.0275])


def test_a_rolled_camera_touches_what_an_upright_one_passes():
    """Looking down 60 mm off a slab's face: the housing reaches 27.5 mm to the left of the left imager and 62.5 mm to
    its right, so it passes with its left side towards the slab and not with its right one."""
    slab = SimulatedArm.around(block(size=(0.02, 0.4, 0.3)))
    beside = look_at(np.array([0.07, 0.0, 0.22]), np.array([0.07, 0.0, 0.0]))  # x axis of the image: world +x
    assert slab.obstacle(beside) is None
    assert slab.obstacle(rolled(beside, 180.0)) == "touches part"


def test_the_arm_starts_with_the_mount_s_roll():
    """No time is spent on a turn that the mount has: an upright arm's first move and a rolled one's take as long."""
    times = [SimulatedArm.around(block(), roll_deg=roll).move_to(rolled(above(0.4), roll)) for roll in (0.0, 90.0)]
    assert times[0] == pytest.approx(times[1], rel=0.2)


def paper_arm(roll_deg: float = 90.0) -> SimulatedArm:
    """An arm on the paper's bench, with a block on the plinth."""
    return SimulatedArm.around(block(), roll_deg=roll_deg, fixtures=(lamp_on_arm(),))


def test_the_camera_keeps_out_of_the_task_lamp():
    """Facing the luminous front along its axis, the housing's front, 4.3 mm before the depth origin, may come within
    the clearance of the head's rim and no nearer; in the middle of the head, 13 mm behind the front, it is inside."""
    arm, lamp = paper_arm(), task_lamp().T_world_lamp
    axis = lamp.rotation.apply([0.0, 0.0, 1.0])

    def facing(distance: float) -> RigidTransform:
        return look_at(lamp.translation + distance * axis, lamp.translation - axis)

    nearest = BODY.box[1, 2] + CLEARANCE
    assert arm.obstacle(facing(0.3)) is None
    assert arm.obstacle(facing(nearest - 5e-4 + 1e-3)) is None
    assert arm.obstacle(facing(nearest - 5e-4 - 1e-3)) == "touches task lamp"
    sideways = look_at(lamp.translation - 0.013 * axis, lamp.translation - 0.013 * axis + [0.0, 1.0, 0.0])
    assert arm.obstacle(sideways) == "touches task lamp"
    assert arm.fixtures["task lamp"].winding_number(lamp.translation - 0.013 * axis) == pytest.approx(1.0)
    with pytest.raises(InputError, match="task lamp; choose a free pose"):
        arm.move_to(sideways)


def test_beside_the_plinth_nothing_goes_below_its_top():
    """The plinth's top is the table of planner and arm: 2 cm below it, 30 cm beside the middle, is under the table, on
    end as well as level, though the table itself is 45 mm lower."""
    for roll in (0.0, 90.0):
        eye = np.array([-0.3, 0.0, -0.02])
        assert paper_arm(roll).obstacle(rolled(look_at(eye, np.array([0.0, 0.0, -0.02])), roll)) == "under table"


@pytest.mark.parametrize("roll_deg", [0.0, 90.0])
def test_all_first_views_of_the_paper_are_free(roll_deg):
    """Fifteen starts around the plinth, level or on end: the lamp is in none's way."""
    arm, parameters = paper_arm(roll_deg), Parameters(roll_deg=roll_deg)
    assert [arm.obstacle(first_view(parameters, 24.0 * k)) for k in range(15)] == [None] * 15
