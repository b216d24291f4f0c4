"""Holes and false depth on boxes whose surface is known in closed form: what is named, what is not, and where it is."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at, rolled
from franbv.model import Model, model_of
from franbv.parameters import Parameters
from franbv.planners import pb
from franbv.reconstruction import reconstruct
from franbv.robust.evidence import integrate_robustly, with_scans
from franbv.robust.hull import ObjectHull, object_hull
from franbv.robust.planner import fra_robust
from franbv.robust.regions import RobustDetection, detect_robustly
from franbv.robust.settings import RobustSettings
from franbv.sensing import DepthBurst
from franbv.voxel_map import VoxelMap, empty_map
from tests.franbv.analytic_camera import SENSOR, AnalyticCamera, FreeArm
from tests.franbv.robust.mirror_camera import BOX, ROOM, MirrorCamera

PARAMETERS, SETTINGS = Parameters(n_frames=3, max_iterations=3), RobustSettings()
NEVER_DULL = SETTINGS.model_copy(update={"dull": 1.0})
"""Names what is missing or false on surface that was measured from aslant, too."""
MIDDLE = np.array([0.0, 0.0, 0.04])
AROUND = [(0.3, 0.0, 0.2), (-0.3, 0.0, 0.2), (0.0, -0.3, 0.2), (0.1, 0.0, 0.4)]
ASLANT = (0.12, 0.28, 0.12)
"""Sees the side towards +y at 30 deg."""
MIN_Z = AnalyticCamera.min_z
"""Of these cameras [m]."""
VOXEL, SHAPE = PARAMETERS.voxel_size, (SENSOR.height, SENSOR.width)


def after(camera: AnalyticCamera, eyes: list, last: DepthBurst | None = None) -> Model:
    """The model of these views, and of a last burst."""
    voxel_map: VoxelMap = empty_map(PARAMETERS)
    bursts = [camera.capture(look_at(np.array(eye), MIDDLE), 3) for eye in eyes]
    for burst in bursts + ([last] if last else []):
        voxel_map = integrate_robustly(voxel_map, burst, PARAMETERS, SETTINGS)
    return model_of(voxel_map, fra_robust(), PARAMETERS, np.random.SeedSequence(0))


def seen_by(
    camera: AnalyticCamera, eye=ASLANT, roll: float = 0.0, frames: int = 3
) -> tuple[DepthBurst, RobustDetection]:
    """A burst from there, and what it shows after the views around."""
    burst = camera.capture(rolled(look_at(np.array(eye), MIDDLE), roll), frames)
    return burst, detect_robustly(burst, after(camera, AROUND, burst), PARAMETERS, MIN_Z, SETTINGS)


def side_of(burst: DepthBurst, margin: float) -> np.ndarray:
    """Pixels whose ray meets the box's side towards +y, this far within its edges [m]; closed form."""
    rays = burst.T_world_cam.rotation.apply(burst.intrinsics.pixel_directions().reshape(-1, 3))
    eye = burst.T_world_cam.translation
    points = eye + ((BOX[1][1] - eye[1]) / rays[:, 1])[:, None] * rays
    on = (np.abs(points[:, 0]) < BOX[1][0] - margin) & (points[:, 2] > margin) & (points[:, 2] < BOX[1][2] - margin)
    return (on & (rays[:, 1] < 0)).reshape(burst.depths.shape[1:])


def holed(points, cosine):
    """No depth on the side towards +y."""
    return (np.abs(points[:, 1] - BOX[1][1]) < 1e-6) & (points[:, 2] > 1e-6)


@pytest.mark.parametrize("roll", [0.0, 90.0])
def test_a_side_without_depth_is_a_reflective_hole_where_it_is(roll):
    """A side that gives no depth is named but for its rim, at its place to a voxel, and not as false depth; the map
    does not hold it, so that it is one region."""
    burst, found = seen_by(AnalyticCamera((BOX,), room=ROOM, hole=holed), roll=roll)
    inner = side_of(burst, 2 * VOXEL)
    assert inner.sum() > 20
    assert np.mean(found.holes[inner]) > 0.95
    assert not np.any(found.holes & ~side_of(burst, -VOXEL))
    assert not found.false_depth.any()
    assert np.nanmax(np.abs(found.places[inner][:, 1] - BOX[1][1])) < VOXEL
    assert np.median(found.uncertainty[inner]) < 3 * VOXEL
    assert len(found.boxes) == 1
    assert found.boxes[0].contains(found.places[inner & found.holes]).mean() > 0.9
    assert np.array_equal(found.retained & found.candidates, found.retained)


@pytest.mark.parametrize("roll", [0.0, 90.0])
def test_what_a_side_mirrors_is_false_depth_if_it_flickers(roll):
    """Depth that stands behind a mirroring side is false, but for the few that end at the far side's surface by chance,
    and its surface lies on that side. Depth past the hull that is as steady as a camera's best may be seen through a
    hollow, and is not."""
    burst, found = seen_by(MirrorCamera(room=ROOM, noise=0.002), roll=roll, frames=15)
    inner = side_of(burst, 3 * VOXEL)
    assert inner.sum() > 10
    assert np.mean(found.false_depth[inner]) > 0.85
    assert not np.any(found.false_depth & ~side_of(burst, -VOXEL))
    assert not found.holes.any()
    assert np.nanmax(np.abs(found.places[inner][:, 1] - BOX[1][1])) < VOXEL
    _, steady = seen_by(MirrorCamera(room=ROOM, noise=0.0002), roll=roll, frames=15)
    assert not steady.false_depth.any()


def test_surface_that_was_measured_from_this_side_is_where_a_hole_lies():
    """The wall within an L lies far behind its hull: once it was measured from the front, a hole on it lies there. The
    far side of a plain box was measured from behind, and a hole before it lies on the hull."""
    legs = (((-0.06, -0.04, 0.0), (0.06, 0.04, 0.02)), ((-0.06, -0.04, 0.0), (-0.04, 0.04, 0.1)))
    plain = AnalyticCamera(legs, room=ROOM)
    front = [(0.3, 0.0, 0.15), (0.28, 0.08, 0.18), (0.28, -0.08, 0.18)]
    burst = plain.capture(look_at(np.array([0.3, 0.0, 0.12]), MIDDLE), 3)
    rays = burst.T_world_cam.rotation.apply(burst.intrinsics.pixel_directions().reshape(-1, 3))
    points = burst.T_world_cam.translation + burst.median_depth().reshape(-1, 1) * rays
    wall = (np.abs(points[:, 0] + 0.04) < 0.003) & (np.abs(points[:, 1]) < 0.02) & (points[:, 2] < 0.07)
    wall = (wall & (points[:, 2] > 0.04)).reshape(SHAPE)
    last = replace(burst, depths=np.where(wall, 0, burst.depths).astype(np.float32))
    found = detect_robustly(last, after(plain, [*AROUND, *front], last), PARAMETERS, MIN_Z, NEVER_DULL)
    assert (found.holes & wall).sum() > 5
    assert np.all(np.abs(found.places[found.holes & wall][:, 0] + 0.04) < VOXEL)


def test_a_matte_box_has_neither():
    """From all sides and both turns a matte box shows no hole and no false depth, whatever its own shadow hides."""
    for roll in (0.0, 90.0):
        for eye in (*AROUND, ASLANT, (0.2, 0.2, 0.05)):
            _, found = seen_by(AnalyticCamera((BOX,), room=ROOM), eye, roll)
            assert not found.candidates.any()
            assert found.boxes == ()


def test_the_object_s_stereo_shadow_is_no_hole():
    """Pixels without depth beside the object, along the baseline, are what it hides from the right imager; those that
    reach over its rim by one pixel are as well."""
    camera = AnalyticCamera((BOX,), room=ROOM)
    burst = camera.capture(look_at(np.array(AROUND[0]), MIDDLE), 3)
    covered = object_hull(with_scans(after(camera, AROUND).voxel_map), PARAMETERS, SETTINGS)
    assert covered is not None
    inside = covered.covered(burst.intrinsics, burst.T_world_cam)
    rim = inside & ~np.pad(inside, ((0, 0), (1, 0)))[:, :-1]
    shadow = np.zeros_like(inside)
    for row, column in np.argwhere(rim):
        shadow[row, max(column - 3, 0) : column + 1] = True
    hidden = replace(burst, depths=np.where(shadow, 0.0, burst.depths).astype(np.float32))
    found = detect_robustly(hidden, after(camera, AROUND, hidden), PARAMETERS, MIN_Z, SETTINGS)
    assert not found.holes.any()


@pytest.mark.parametrize("roll", [0.0, 90.0])
def test_surface_too_steep_for_a_window_is_no_hole(roll):
    """tan(incidence) / (Z / B) is the change of disparity from pixel to pixel: above a half at 75 deg, below it at
    40 deg. A side without depth is a hole in the second view alone."""
    camera = AnalyticCamera((((-0.1, -0.04, 0.0), (0.1, 0.04, 0.12)),), room=ROOM)
    found = []
    for degrees in (75.0, 40.0):
        angle = np.radians(degrees)
        eye = np.array([0.3 * np.sin(angle), 0.04 + 0.3 * np.cos(angle), 0.06])
        burst = camera.capture(rolled(look_at(eye, np.array([0.0, 0.04, 0.06])), roll), 3)
        rays = burst.T_world_cam.rotation.apply(burst.intrinsics.pixel_directions().reshape(-1, 3))
        points = eye + burst.median_depth().reshape(-1, 1) * rays
        side = (np.abs(points[:, 1] - 0.04) < 0.004) & (points[:, 2] > 0.02) & (points[:, 2] < 0.1)
        side &= np.abs(points[:, 0]) < 0.05  # where the incidence is within a few degrees of that of the middle
        last = replace(burst, depths=np.where(side.reshape(SHAPE), 0, burst.depths).astype(np.float32))
        model = after(camera, [*AROUND, (0.0, 0.3, 0.2)], last)
        found.append(np.mean(detect_robustly(last, model, PARAMETERS, MIN_Z, NEVER_DULL).holes.ravel()[side]))
    assert found[0] < 0.1
    assert found[1] > 0.9


def test_a_surface_that_the_map_holds_is_named_but_no_region():
    """A side that was measured before gives none to look for, though its holes are named."""
    plain = AnalyticCamera((BOX,), room=ROOM)
    burst = AnalyticCamera((BOX,), room=ROOM, hole=holed).capture(look_at(np.array(ASLANT), MIDDLE), 3)
    model = after(plain, [*AROUND, (0.0, 0.3, 0.2), (0.1, 0.28, 0.2)], burst)
    found = detect_robustly(burst, model, PARAMETERS, MIN_Z, NEVER_DULL)
    assert found.holes.sum() > 20
    assert not found.retained.any()
    assert found.boxes == ()
    assert len(found.points) == 0


def test_unsteady_depth_within_the_hull_is_false():
    """Depth that ends a few voxels behind a side, above the table, is believed while it is steady, and is false once it
    flickers."""
    camera = AnalyticCamera((BOX,), room=ROOM)
    burst = camera.capture(look_at(np.array(ASLANT), MIDDLE), 3)
    pit = side_of(burst, 3 * VOXEL)
    pit[20:] = False  # lower ones would end on the table
    assert pit.sum() > 5
    for swing, named in ((0.0, False), (0.01, True)):
        depths = burst.depths.copy()
        for frame, by in zip(depths, (-swing, 0.0, swing), strict=True):
            frame[side_of(burst, 0.0)] += by
            frame[pit] += 0.045
        last = replace(burst, depths=depths)
        found = detect_robustly(last, after(camera, AROUND, last), PARAMETERS, MIN_Z, NEVER_DULL)
        assert found.false_depth[pit].all() == found.false_depth[pit].any() == named


def test_nothing_is_named_before_anything_was_seen():
    """An empty burst before an empty map: no hull, no regions, and a map without scans does as well."""
    nothing = DepthBurst(np.zeros((3, 40, 60), np.float32), SENSOR, look_at(np.array(ASLANT), MIDDLE))
    empty = model_of(empty_map(PARAMETERS), pb(), PARAMETERS, np.random.SeedSequence(0))
    found = detect_robustly(nothing, empty, PARAMETERS, MIN_Z, SETTINGS)
    assert not found.candidates.any()
    assert found.boxes == ()
    assert found.confidence_map.all()


def test_a_plain_map_has_a_hull_as_well():
    """Of a map without evidence the hull is that of its occupied voxels."""
    camera = AnalyticCamera((BOX,), room=ROOM)
    grid: VoxelMap = empty_map(PARAMETERS)
    for eye in AROUND * 2:
        grid = pb().integrate(grid, camera.capture(look_at(np.array(eye), MIDDLE), 3), PARAMETERS)
    hull = object_hull(with_scans(grid), PARAMETERS, SETTINGS)
    assert hull is not None
    assert np.all(np.abs(hull.vertices.max(axis=0) - BOX[1]) < 1.5 * VOXEL)


def test_rays_through_a_hull_by_closed_form():
    """A cube of side 2 around the origin: entry, exit and depth of a ray through its middle and of one that misses; a
    camera within sees no pixel covered."""
    planes = np.concatenate([np.eye(3), -np.eye(3)])
    corners = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    hull = ObjectHull(corners, np.column_stack([planes, -np.ones(6)]), corners)
    entry, leaves, deepest = hull.crossed(
        np.array([4.0, 0.0, 0.0]), np.array([[-1.0, 0, 0], [0, 1.0, 0], [0, 0, -1.0]])
    )
    assert entry[0] == pytest.approx(3)
    assert leaves[0] == pytest.approx(5)
    assert deepest[0] == pytest.approx(1)
    assert np.all(np.isinf(entry[1:]))
    assert np.all(deepest[1:] == -np.inf)
    assert hull.below(np.array([[0.0, 0.0, -0.9], [0.5, 0.0, 0.0], [2.0, 0.0, 0.0]])) == pytest.approx([1.0, 0.5, -1.0])
    assert not hull.covered(SENSOR, RigidTransform.identity()).any()


def test_the_loop_names_regions_and_recovers_none():
    """fra-robust's acquisitions have detections, no recovery follows from them, and pb's have none."""
    for planner, named in ((fra_robust(), True), (pb(), False)):
        camera = AnalyticCamera((BOX,), room=ROOM, hole=holed)
        run = reconstruct(camera, FreeArm(), planner, PARAMETERS, seed=0)
        assert all((a.detection is not None) == named for a in run.acquisitions)
        assert all(a.kind != "recovery" and a.recovery_poses is None for a in run.acquisitions)
        assert all(("detection" in a.planning_s) == named for a in run.acquisitions)
