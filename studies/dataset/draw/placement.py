"""Where things stand: single parts, piles of parts at rest, and clutter around them that touches nothing."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.pile import HALF_SIDE, Pile
from scenes.primitives import box, cylinder, sphere
from scenes.scene import Mesh
from scenes.stable_poses import StablePose
from studies.dataset.config import DatasetConfig, Surroundings
from studies.dataset.draw.objects import PoolObject
from studies.dataset.draw.weighted_draw import drawn_material, log_uniform, pick

TRIES = 40
"""Places that are tried for one thing before it is left out (choice: a third of the tries succeed)."""
CLUTTER_REACH = HALF_SIDE - 0.05
"""Clutter stands within this of the table's middle, along x and y [m] (choice: on the table, near its edge)."""
CLUTTER_FACETS = 96
"""Around round clutter (choice: 0.03 mm off a circle of 30 mm radius)."""


@dataclass(frozen=True, eq=False)
class Placed:
    """An object at rest."""

    object: PoolObject
    material: str
    resting: str
    T_world_model: RigidTransform

    @property
    def box(self) -> Float[np.ndarray, "2 3"]:
        """Its axis-aligned bounding box [m]."""
        points = self.T_world_model.apply(self.object.mesh.vertices)
        return np.stack([points.min(axis=0), points.max(axis=0)])


@dataclass(frozen=True, eq=False)
class Clutter:
    """Another thing on the table."""

    shape: str
    size: tuple[float, float, float]
    material: str
    T_world_model: RigidTransform

    @property
    def box(self) -> Float[np.ndarray, "2 3"]:
        """An axis-aligned box around it whichever way it is turned [m]."""
        centre, reach = self.T_world_model.translation, np.array([np.hypot(*self.size[:2])] * 2 + [self.size[2]]) / 2
        return np.stack([centre - reach, centre + reach])


def clutter_mesh(shape: str, size: tuple[float, float, float]) -> Mesh:
    """A box, upright cylinder or ball of these sides, centred [m]."""
    if shape == "box":
        return box(size)
    return (
        cylinder(size[0] / 2, size[2], CLUTTER_FACETS) if shape == "cylinder" else sphere(size[0] / 2, CLUTTER_FACETS)
    )


def placed_objects(
    config: DatasetConfig, pool: Sequence[PoolObject], count: int, rng: np.random.Generator, places: np.random.Generator
) -> list[Placed]:
    """`count` objects drawn from the pool; a single one stands about in the middle, several are piled up.

    Where none of several stays, too thin or too wide for a pile, the first one is placed like a single one.
    """
    by_name = {o.name: o for o in pool}
    drawn = [
        (by_name[pick(rng, {o.name: o.weight for o in pool})], drawn_material(rng, config.materials))
        for _ in range(count)
    ]
    if count == 1:
        return [_single(config, *drawn[0], places)]
    pile = Pile()
    placed = [_piled(pile, thing, material, config.objects.spread_m, places) for thing, material in drawn]
    return [thing for thing in placed if thing is not None] or [_single(config, *drawn[0], places)]


def _single(config: DatasetConfig, thing: PoolObject, material: str, rng: np.random.Generator) -> Placed:
    upright = rng.random() < config.objects.upright or not thing.stable
    resting, turn = ("upright", Rotation.identity()) if upright else _drawn_pose(thing, rng)
    x, y = rng.uniform(-1, 1, 2) * config.objects.offset_m
    return Placed(thing, material, resting, _at_rest(thing, turn, rng.uniform(0, 360), x, y, 0.0))


def _drawn_pose(thing: PoolObject, rng: np.random.Generator) -> tuple[str, Rotation]:
    poses: tuple[StablePose, ...] = thing.stable
    chances = np.array([pose.chance for pose in poses])
    number = int(rng.choice(len(poses), p=chances / chances.sum()))
    return f"stable pose {number + 1} of {len(poses)}", poses[number].rotation


def _piled(pile: Pile, thing: PoolObject, material: str, spread: float, rng: np.random.Generator) -> Placed | None:
    """Let it down where it stays; every fourth try aims farther out, where the table is free."""
    for attempt in range(TRIES):
        resting, turn = _drawn_pose(thing, rng) if thing.stable else ("upright", Rotation.identity())
        x, y = rng.normal(0, spread * (1 + attempt // 4), 2)
        pose = _at_rest(thing, turn, rng.uniform(0, 360), x, y, 0.0)
        height = pile.resting_height(thing.samples, pose, thing.centre)
        if height is not None:
            return Placed(thing, material, resting, RigidTransform.from_translation([0, 0, height]) * pose)
    return None


def _at_rest(thing: PoolObject, turn: Rotation, yaw_deg: float, x: float, y: float, z: float) -> RigidTransform:
    """The pose with the lowest point at height z."""
    rotation = Rotation.from_euler("z", yaw_deg, degrees=True) * turn
    lowest = rotation.apply(thing.mesh.vertices)[:, 2].min()
    return RigidTransform.from_components([x, y, z - lowest], rotation)


def placed_clutter(
    config: Surroundings, count: int, objects: Sequence[Placed], rng: np.random.Generator, places: np.random.Generator
) -> list[Clutter]:
    """Up to `count` things on the table whose boxes overlap no other box."""
    taken, placed = [thing.box for thing in objects], []
    for _ in range(count):
        shape, material = pick(rng, config.clutter_shapes), pick(rng, config.clutter_materials)
        a, b, c = (round(log_uniform(rng, config.clutter_size_m), 4) for _ in range(3))
        size = {"box": (a, b, c), "cylinder": (a, a, c)}.get(shape, (a, a, a))
        for _ in range(TRIES):
            x, y = places.uniform(-CLUTTER_REACH, CLUTTER_REACH, 2)
            turn = Rotation.from_euler("z", places.uniform(0, 360), degrees=True)
            thing = Clutter(shape, size, material, RigidTransform.from_components([x, y, size[2] / 2], turn))
            if not any(_overlap(thing.box, other) for other in taken):
                taken.append(thing.box)
                placed.append(thing)
                break
    return placed


def _overlap(a: Float[np.ndarray, "2 3"], b: Float[np.ndarray, "2 3"]) -> bool:
    return bool(np.all((a[0] < b[1]) & (b[0] < a[1])))
