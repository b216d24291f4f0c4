"""Nothing is sent that leaves the workspace, goes under the table or comes near the object, by dense points."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation, Slerp

from franbv.adapters.arms.driver import FlangePath
from franbv.adapters.live.cell import CornerBox
from franbv.adapters.live.guard import Guard, boxes_apart
from franbv.adapters.live.guarded_arm import RefusedError
from franbv.frames import look_at
from tests.franbv.adapters.live.cells import CELL, HOME, MIN_Z, ScriptedArm, guarded


def surface(box: CornerBox, step: float) -> np.ndarray:
    """Points on all faces of a box, edges and corners among them."""
    lower, upper = np.array(box)
    grids = [np.linspace(a, b, max(2, int(np.ceil((b - a) / step)) + 1)) for a, b in zip(lower, upper, strict=True)]
    points = np.stack(np.meshgrid(*grids, indexing="ij"), axis=-1).reshape(-1, 3)
    return points[np.any(np.isclose(points, lower) | np.isclose(points, upper), axis=1)]


def from_box(points: np.ndarray, box: CornerBox) -> np.ndarray:
    """Distance of points from a box [m], 0 inside."""
    return np.linalg.norm(points - np.clip(points, *np.array(box)), axis=-1)


NOWHERE = RigidTransform.from_translation((np.nan, 0.0, 0.3))
BODY = np.concatenate([surface(box, 0.02) for box in CELL.moving])


def faults(poses: list[RigidTransform]) -> list[str]:
    """What is wrong on a way, by points of what moves every 2 mm of it; knows no separating axes."""
    Ts = densely(poses)
    origins = Ts[:, :3, 3]
    points = np.einsum("nij,mj->nmi", Ts[:, :3, :3], BODY) + origins[:, None]
    solids = {"object": CELL.object_box, **CELL.keep_out}
    found = {
        "workspace": np.any(origins < CELL.workspace[0]) or np.any(origins > CELL.workspace[1]),
        "table": points[..., 2].min() < CELL.table_height,
        "Min-Z": from_box(origins, CELL.object_box).min() < MIN_Z,
        **{name: from_box(points, box).min() <= 0 for name, box in solids.items()},
    }
    return [name for name, is_wrong in found.items() if is_wrong]


def densely(poses: list[RigidTransform]) -> np.ndarray:
    """Matrices along a way in steps of 2 mm or less."""
    found = [poses[0].as_matrix()[None]]
    for one, other in pairwise(poses):
        step = other.translation - one.translation
        shares = np.linspace(0, 1, int(np.ceil(np.linalg.norm(step) / 0.002)) + 2)[1:]
        turns = Slerp([0, 1], Rotation.concatenate([one.rotation, other.rotation]))(shares)
        found.append(RigidTransform.from_components(one.translation + shares[:, None] * step, turns).as_matrix())
    return np.concatenate(found)


def test_boxes_apart_is_right_by_their_points():
    """What is called apart is apart by the gap; what is not comes within the gap's corner, by a grid of 2 mm."""
    rng, gap = np.random.default_rng(3), 0.01
    moving, still = ((-0.03, -0.05, -0.17), (0.07, 0.05, -0.02)), CELL.object_box
    poses = [RigidTransform.from_components(rng.uniform(-0.2, 0.2, 3), Rotation.random(rng=rng)) for _ in range(400)]
    apart = boxes_apart(np.array([T.as_matrix() for T in poses]), moving, still, gap)
    grid, middle = surface(moving, 0.002), np.mean(still, axis=0)[None]
    least = np.array([from_box(T.apply(grid), still).min() for T in poses])
    around = np.array([from_box(T.inv().apply(middle), moving)[0] == 0 for T in poses])
    assert 40 < apart.sum() < 360
    assert np.all(least[apart] >= gap)
    assert np.all((least[~apart] <= gap * np.sqrt(3) + 0.002) | around[~apart])


@pytest.mark.parametrize(
    ("place", "why"),
    [
        ((0.0, 0.0, 0.15), "nearer than Min-Z"),
        ((0.7, 0.0, 0.3), "outside the workspace"),
        ((0.4, 0.4, 0.3), "touches lamp"),
        ((0.4, 0.0, 0.01), "under the table"),
    ],
)
def test_reasons(place, why):
    """One pose for each reason."""
    violation = Guard(CELL, MIN_Z).violation(RigidTransform.from_components(place, HOME.rotation))
    assert violation is not None
    assert why in violation


def test_a_pose_that_is_no_number():
    """Neither as a goal nor on a way."""
    guard = Guard(CELL, MIN_Z)
    assert guard.violation(NOWHERE) == "the pose is not a number"
    assert guard.way_violation([HOME, NOWHERE]) == "a pose of the way is not a number"


def test_a_way_through_the_object_between_two_good_ends():
    """Both ends are right and the middle is not."""
    guard = Guard(CELL, MIN_Z)
    ends = [look_at(np.array([x, 0.0, 0.1]), np.array([0.0, 0.0, 0.05])) for x in (-0.4, 0.4)]
    assert [guard.violation(T) for T in ends] == [None, None]
    assert "after" in (guard.way_violation(ends) or "")


def test_the_other_side_is_reached_around_the_object():
    """Where the straight way is not allowed, an arc is gone: several motions, all of them right."""
    driver = ScriptedArm()
    arm = guarded(driver)
    for x in (-0.4, 0.4):
        arm.move_to(look_at(np.array([x, 0.0, 0.1]), np.array([0.0, 0.0, 0.05])))
    assert len(driver.sent) > 3
    assert [faults([CELL.camera_at(T) for T in path.poses]) for path in driver.sent] == [[]] * len(driver.sent)


def misbehaving(rng: np.random.Generator):
    """A driver's planner that goes astray in one of eight ways, or not."""

    def bend(path: FlangePath) -> FlangePath | None:
        poses, kind, n = list(path.poses), rng.integers(10), len(path.poses)
        phases = np.arange(n) / max(1, n - 1)
        if kind == 0:
            return None
        if kind == 1:  # out of the way, smoothly, and back
            push = rng.normal(size=3) * 0.3
            poses = [
                RigidTransform.from_translation(push * np.sin(np.pi * k)) * T
                for k, T in zip(phases, poses, strict=True)
            ]
        elif kind == 2:  # a jump
            poses = [poses[0], poses[-1]]
        elif kind == 3:  # begins elsewhere
            poses = [RigidTransform.from_translation(rng.normal(size=3) * 0.05) * T for T in poses]
        elif kind == 4:  # ends elsewhere
            poses = poses[: max(1, n // 2)]
        elif kind == 5:  # too fast
            return FlangePath(tuple(poses), path.duration_s * rng.uniform(0.0, 0.3))
        elif kind == 6:
            return FlangePath(tuple(poses), np.nan)
        elif kind == 7:  # turned over on the way
            turns = [Rotation.from_rotvec([0, 2 * np.pi * k, 0]) for k in phases]
            poses = [T * RigidTransform.from_rotation(turn) for T, turn in zip(poses, turns, strict=True)]
        return FlangePath(tuple(poses), path.duration_s)

    return bend


def random_goal(rng: np.random.Generator) -> RigidTransform:
    """Most look at the object from around it, the rest are anywhere and anyhow; some are no numbers."""
    if rng.random() < 0.01:
        return NOWHERE
    if rng.random() < 0.7:
        direction = rng.normal(size=3)
        direction[2] = abs(direction[2])
        place = rng.uniform(0.1, 0.55) * direction / np.linalg.norm(direction)
        return look_at(place, rng.uniform(-0.05, 0.05, 3))
    return RigidTransform.from_components(rng.uniform((-0.8, -0.8, -0.1), (0.8, 0.8, 1.0)), Rotation.random(rng=rng))


def send_plans(n: int, seed: int) -> tuple[int, int]:
    """Ask for n poses through a driver that misbehaves; how many motions were sent, how many goals were refused."""
    rng = np.random.default_rng(seed)
    driver = ScriptedArm(bend=misbehaving(rng))
    arm, n_sent, n_refused = guarded(driver), 0, 0
    for _ in range(n):
        try:
            arm.move_to(random_goal(rng))
        except RefusedError:
            n_refused += 1
        for path in driver.sent:
            assert faults([CELL.camera_at(pose) for pose in path.poses]) == []
        n_sent += len(driver.sent)
        driver.sent.clear()
        arm.refused.clear()
    return n_sent, n_refused


def test_random_plans_of_planners_that_misbehave():
    """A few; the slow test has 10,000."""
    n_sent, n_refused = send_plans(120, 1)
    assert n_sent > 10
    assert n_refused > 40


@pytest.mark.slow
def test_ten_thousand_random_plans():
    """No pose of any way that was sent is wrong, by dense points of what moves every 2 mm."""
    n_sent, n_refused = send_plans(10_000, 2)
    print(f"{n_sent} motions sent, {n_refused} of 10000 goals refused, no pose wrong")  # noqa: T201 (shown with -s)
    assert n_sent > 1000
