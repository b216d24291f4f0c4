"""One scene of a dataset, drawn: every choice that was made, as it is recorded beside the views.

A scene's choices depend on the dataset's seed and the scene's number alone, and its views are drawn one after the
other from a stream of their own, so scenes can be made in any order, by anybody.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform
from scipy.stats import qmc

from franbv.frames import look_at, rolled
from studies.base.config import Config
from studies.dataset.config import Camera, DatasetConfig, Views
from studies.dataset.draw.objects import PoolObject
from studies.dataset.draw.placement import Clutter, Placed, placed_clutter, placed_objects
from studies.dataset.draw.weighted_draw import log_uniform, pick

Matrix = tuple[tuple[float, ...], ...]
"""A pose as a 4 x 4 matrix [m]."""
CAMERA_CLEARANCE = 0.10
"""Least distance of the camera from the bounding box of anything on the table [m] (choice: the housing's radius and
some room)."""
STEP_BACK = 0.01
"""A pose that is too near moves back by this until it is not [m] (choice)."""
EXPOSURE_STREAM = 1
"""Tells the seed of exposures from others of the dataset (choice)."""
TRAJECTORY_SPAN_DEG = (30.0, 120.0)
"""Change of azimuth along a trajectory [deg] (choice: what an arm sweeps without changing its configuration)."""


class ObjectDraw(Config):
    """One object on the table."""

    object_id: int
    object: str
    material: str
    """`own`, or the material of the whole part."""
    resting: str
    """`upright`, or which of its stable poses it lies in."""
    T_world_model: Matrix


class ClutterDraw(Config):
    """Something else on the table."""

    shape: str
    size_m: tuple[float, float, float]
    material: str
    T_world_model: Matrix


class ViewDraw(Config):
    """One pose of the camera."""

    azimuth_deg: float
    elevation_deg: float
    distance_m: float
    roll_deg: float
    """The mount's and what was drawn."""
    aim_m: tuple[float, float, float]
    T_world_cam: Matrix
    """Pose of the left imager, the depth frame."""


class SceneDraw(Config):
    """All that was drawn for one scene."""

    scene: int
    noise_seed: int
    """Of the sensor's noise and speckle."""
    arrangement: str
    objects: tuple[ObjectDraw, ...]
    left_out: int
    """Objects and clutter for which no place was found."""
    clutter: tuple[ClutterDraw, ...]
    table: str
    lamps: str
    room: bool
    profile: str
    laser_mw: float
    exposure_us: float | None
    """None = chosen by auto-exposure."""
    motion: str
    views: tuple[ViewDraw, ...]


def drawn_exposure(camera: Camera, seed: int, scene: int) -> float | None:
    """Fixed exposure of a scene [us], None = automatic; by a scrambled Sobol' sequence over the scenes' numbers.

    Few scenes have a fixed one, and it may lie anywhere in a wide range: drawn one by one they would leave gaps.
    """
    sequence = qmc.Sobol(2, rng=np.random.default_rng([seed, EXPOSURE_STREAM]))
    if scene > 0:  # by 0 it cannot be forwarded
        sequence.fast_forward(scene)
    automatic, place = sequence.random()[0]
    low, high = camera.exposure_us
    return None if automatic < camera.auto_exposure else float(round(low * (high / low) ** place))


def draw_scene(config: DatasetConfig, pool: Sequence[PoolObject], scene: int) -> SceneDraw:
    """The choices for scene number `scene`."""
    choices, places, views, noise = (
        np.random.default_rng(seed) for seed in np.random.SeedSequence([config.seed, scene]).spawn(4)
    )
    s, camera = config.surroundings, config.camera
    arrangement = pick(choices, config.objects.arrangement)
    most = config.objects.pile_parts
    n_objects = 1 if arrangement == "single" else int(choices.integers(most[0], most[1] + 1))
    objects = placed_objects(config, pool, n_objects, choices, places)
    n_clutter = int(choices.integers(s.clutter[0], s.clutter[1] + 1))
    clutter = placed_clutter(s, n_clutter, objects, choices, places)
    motion = pick(choices, config.poses.motion)
    target = np.stack([thing.box for thing in objects])
    middle = (target[:, 0].min(axis=0) + target[:, 1].max(axis=0)) / 2
    return SceneDraw(
        scene=scene,
        noise_seed=int(noise.integers(2**31)),
        arrangement=arrangement,
        objects=tuple(_object(thing) for thing in objects),
        left_out=n_objects + n_clutter - len(objects) - len(clutter),
        clutter=tuple(_clutter(thing) for thing in clutter),
        table=pick(choices, s.tables),
        lamps=pick(choices, s.lamps),
        room=bool(choices.random() < s.room),
        profile=pick(choices, camera.profiles),
        laser_mw=round(log_uniform(choices, camera.laser_mw), 1),
        exposure_us=drawn_exposure(camera, config.seed, scene),
        motion=motion,
        views=draw_views(config, scene, motion, middle, [thing.box for thing in (*objects, *clutter)], views),
    )


def _object(thing: Placed) -> ObjectDraw:
    return ObjectDraw(
        object_id=thing.object.number,
        object=thing.object.name,
        material=thing.material,
        resting=thing.resting,
        T_world_model=matrix(thing.T_world_model),
    )


def _clutter(thing: Clutter) -> ClutterDraw:
    return ClutterDraw(
        shape=thing.shape, size_m=thing.size, material=thing.material, T_world_model=matrix(thing.T_world_model)
    )


def draw_views(
    config: DatasetConfig,
    scene: int,
    motion: str,
    middle: Float[np.ndarray, "3"],
    boxes: Sequence[Float[np.ndarray, "2 3"]],
    rng: np.random.Generator,
) -> tuple[ViewDraw, ...]:
    """The poses of a scene. middle: of what is looked at [m]. boxes: of all that the camera must keep away from [m]."""
    n = config.poses.per_scene
    if motion == "hemisphere":
        places = [_place(config.poses, rng) for _ in range(n)]
    else:
        first, last = (_place(config.poses, rng) for _ in range(2))
        last[0] = first[0] + rng.uniform(*TRAJECTORY_SPAN_DEG) * rng.choice([-1, 1])
        places = [first + (last - first) * k / max(n - 1, 1) for k in range(n)]
    mount = np.array([0.0, 0.0, 0.0, config.camera.roll_deg, 0.0, 0.0, 0.0])
    return tuple(_view(place + mount, middle, boxes) for place in places[: config.views_of(scene)])


def _place(poses: Views, rng: np.random.Generator) -> Float[np.ndarray, "7"]:
    """Azimuth, elevation, distance, roll, aim, to a printable number of digits [deg, m]."""
    low, high = np.sin(np.radians(poses.elevation_deg))
    place = [
        rng.uniform(0, 360),
        np.degrees(np.arcsin(rng.uniform(low, high))),
        rng.uniform(*poses.distance_m),
        rng.uniform(-1, 1) * poses.roll_deg,
        *rng.uniform(-1, 1, 3) * poses.aim_m,
    ]
    return np.round(place, 4)


def _view(
    place: Float[np.ndarray, "7"], middle: Float[np.ndarray, "3"], boxes: Sequence[Float[np.ndarray, "2 3"]]
) -> ViewDraw:
    """The pose, moved back until it is clear of everything."""
    azimuth, elevation, distance, roll, *aim = place.tolist()
    level, up = np.cos(np.radians(elevation)), np.sin(np.radians(elevation))
    outward = np.array([level * np.cos(np.radians(azimuth)), level * np.sin(np.radians(azimuth)), up])
    target = middle + aim
    while any(_distance(target + distance * outward, box) < CAMERA_CLEARANCE for box in boxes):
        distance += STEP_BACK
    pose = rolled(look_at(target + distance * outward, target), roll)
    return ViewDraw(
        azimuth_deg=azimuth % 360,
        elevation_deg=elevation,
        distance_m=distance,
        roll_deg=roll,
        aim_m=(aim[0], aim[1], aim[2]),
        T_world_cam=matrix(pose),
    )


def _distance(point: Float[np.ndarray, "3"], box: Float[np.ndarray, "2 3"]) -> float:
    """Of a point from a box, 0 inside it [m]."""
    return float(np.linalg.norm(np.maximum(np.maximum(box[0] - point, point - box[1]), 0)))


def matrix(pose: RigidTransform) -> Matrix:
    """As it is recorded."""
    return tuple(tuple(row) for row in pose.as_matrix().tolist())
