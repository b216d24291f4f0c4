"""The pool of objects that scenes are drawn from: our parts and CAD files, each in a frame of its own.

The model frame is BOP's: z up as designed, origin in the middle of the bounding box.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from materials.input_error import InputError
from materials.user_materials import UserMaterials
from render.world.scene_geometry import FIRST_LAMP
from scenes.part_materials import part_materials
from scenes.parts import part_bodies
from scenes.pile import surface_samples
from scenes.primitives import moved
from scenes.scene import Body, Mesh, Scene
from scenes.stable_poses import StablePose, centre_of_mass, stable_poses
from scenes.surroundings import room
from scenes.user_mesh import load_user_part
from studies.base.atomic_file import file_digest
from studies.dataset.config import DatasetConfig, UserCad

MOST_POOLS = 4
"""Kept in a process (choice: one is in use at a time)."""


@dataclass(frozen=True, eq=False)
class PoolObject:
    """One object, at rest in its model frame [m]."""

    number: int
    """BOP's obj_id, from 1."""
    name: str
    weight: float
    """How often it is drawn, relative to the others."""
    bodies: tuple[Body, ...]
    digest: str = ""
    """Hash of a CAD file's content."""
    notices: tuple[str, ...] = ()
    """What was mended in a CAD file."""

    @cached_property
    def mesh(self) -> Mesh:
        """All bodies as one mesh."""
        return self.scene.part_mesh()

    @cached_property
    def centre(self) -> Float[np.ndarray, "3"]:
        """Of its mass [m]."""
        return centre_of_mass(self.mesh)

    @cached_property
    def stable(self) -> tuple[StablePose, ...]:
        """The ways in which it can lie."""
        return stable_poses(self.mesh)

    @property
    def scene(self) -> Scene:
        """Nothing but the object, in its model frame."""
        return Scene(self.name, self.bodies, (), 0.0)

    @cached_property
    def samples(self) -> Float[np.ndarray, "n 3"]:
        """Of its surface, for piles [m]."""
        return surface_samples(self.mesh)


@lru_cache(MOST_POOLS)
def _cached_pool(config: str, digests: tuple[str | None, ...]) -> tuple[PoolObject, ...]:
    del digests  # a file that was changed is loaded again
    return _pool(DatasetConfig.model_validate_json(config))


def object_pool(config: DatasetConfig) -> tuple[PoolObject, ...]:
    """All objects of the configuration, loaded once a process; InputError for a CAD file that cannot be used."""
    files = (entry.file for entry in config.objects.cad)
    return _cached_pool(config.model_dump_json(), tuple(file_digest(f) if f.is_file() else None for f in files))


def check_body_count(config: DatasetConfig, pool: tuple[PoolObject, ...]) -> None:
    """InputError where a scene could hold more bodies than can be told apart."""
    most_objects = config.objects.pile_parts[1] if config.objects.arrangement.get("pile") else 1
    largest = max((thing for thing in pool if thing.weight), key=lambda thing: len(thing.bodies))
    around = config.surroundings.clutter[1] + 1 + len(room())
    if most_objects * len(largest.bodies) + around > FIRST_LAMP:
        raise InputError(
            f"{largest.name}: {most_objects} of its {len(largest.bodies)} bodies and {around} around are more than "
            f"{FIRST_LAMP}; lower objects.pile_parts, or join bodies of one material"
        )


def _pool(config: DatasetConfig) -> tuple[PoolObject, ...]:
    parts = [
        PoolObject(number, name, weight, _centred(part_bodies(name)))
        for number, (name, weight) in enumerate(sorted(config.objects.parts.items()), start=1)
    ]
    cad = [
        _from_file(number, entry, config.materials.of_user)
        for number, entry in enumerate(config.objects.cad, start=len(parts) + 1)
    ]
    return (*parts, *cad)


def _from_file(number: int, entry: UserCad, user: UserMaterials) -> PoolObject:
    part = load_user_part(entry.file, entry.units, part_materials(entry.material, user), entry.up)
    return PoolObject(
        number, entry.file.name, entry.weight, _centred(part.bodies), file_digest(entry.file), part.notices
    )


def _centred(bodies: tuple[Body, ...]) -> tuple[Body, ...]:
    points = np.concatenate([body.mesh.vertices for body in bodies])
    middle = RigidTransform.from_translation(-(points.min(axis=0) + points.max(axis=0)) / 2)
    return tuple(replace(body, mesh=moved(body.mesh, middle)) for body in bodies)
