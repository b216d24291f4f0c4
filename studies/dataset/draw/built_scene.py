"""A drawn scene as one that can be rendered: objects first, then clutter, table and room."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from materials.catalog import finish_names, material, material_names, metal_names
from materials.material import Material, RoughConductor, RoughPlastic
from materials.user_materials import NO_USER_MATERIALS, UserMaterials
from render.d435i import SensorSettings
from render.imager.settings import ImagerSettings
from scenes.build import scene_on_table
from scenes.primitives import moved
from scenes.scene import Body, Scene
from studies.dataset.config import DatasetConfig
from studies.dataset.draw.draw import SceneDraw
from studies.dataset.draw.objects import PoolObject
from studies.dataset.draw.placement import clutter_mesh

BUILT_IN_CLASSES = (
    *(f"{metal}:{finish}" for metal in metal_names() for finish in finish_names(metal)),
    *material_names()[len(metal_names()) :],
)
"""Every metal with every finish, and every non-metal."""


@dataclass(frozen=True, eq=False)
class BuiltScene:
    """The scene and which of its bodies belong to which object."""

    scene: Scene
    owner: tuple[int, ...]
    """Of each body: the number of its object in the draw, -1 = clutter, table, room."""
    user: UserMaterials = NO_USER_MATERIALS
    """What its materials may be beside the built-in ones."""

    def object_vertices(self, number: int) -> Float[np.ndarray, "n 3"]:
        """Corners of one object, in the world [m]."""
        bodies = zip(self.scene.bodies, self.owner, strict=True)
        return np.concatenate([body.mesh.vertices for body, owner in bodies if owner == number])


def build_scene(draw: SceneDraw, pool: Sequence[PoolObject], user: UserMaterials = NO_USER_MATERIALS) -> BuiltScene:
    """The scene that was drawn."""
    by_number = {thing.number: thing for thing in pool}
    bodies: list[Body] = []
    owner: list[int] = []
    for number, thing in enumerate(draw.objects):
        pose = RigidTransform.from_matrix(np.array(thing.T_world_model))
        whole = None if thing.material == "own" else material(thing.material, user)
        for body in by_number[thing.object_id].bodies:
            made_of = whole or body.material
            bodies.append(replace(body, name=f"{number} {body.name}", mesh=moved(body.mesh, pose), material=made_of))
            owner.append(number)
    for number, thing in enumerate(draw.clutter):
        pose = RigidTransform.from_matrix(np.array(thing.T_world_model))
        mesh = moved(clutter_mesh(thing.shape, thing.size_m), pose)
        bodies.append(Body(f"clutter {number}", mesh, material(thing.material, user), is_part=False))
        owner.append(-1)
    scene = scene_on_table(f"scene {draw.scene}", tuple(bodies), draw.lamps, material(draw.table, user), draw.room)
    return BuiltScene(scene, (*owner, *[-1] * (len(scene.bodies) - len(owner))), user)


def sensor_settings(config: DatasetConfig, draw: SceneDraw) -> SensorSettings:
    """The camera of a drawn scene."""
    imager = ImagerSettings(laser_power_mw=draw.laser_mw)
    if draw.exposure_us is not None:
        imager = imager.model_copy(update={"exposure_us": draw.exposure_us})
    camera = config.camera.sensor(draw.profile)
    return camera.model_copy(update={"imager": imager, "auto_exposure": draw.exposure_us is None})


def material_classes(user: UserMaterials = NO_USER_MATERIALS) -> tuple[str, ...]:
    """What the numbers in a material map mean, from 1: the built-in classes, then those of the user's materials."""
    own_metals = metal_names(user)[len(metal_names()) :]
    others = (name for name in material_names(user) if name not in material_names() and name not in own_metals)
    own = (f"{metal}:{finish}" for metal in own_metals for finish in finish_names(metal, user))
    return (*BUILT_IN_CLASSES, *own, *others)


def material_class(made_of: Material, user: UserMaterials = NO_USER_MATERIALS) -> int:
    """Number of a material in a material map."""
    return material_classes(user).index(made_of.name.partition("@")[0]) + 1


def roughness(made_of: Material) -> tuple[float, float] | None:
    """GGX alpha along and across the lay; None for a surface that has none, a matte one."""
    if isinstance(made_of, RoughConductor):
        return made_of.alpha_u, made_of.alpha_v
    return (made_of.alpha, made_of.alpha) if isinstance(made_of, RoughPlastic) else None
