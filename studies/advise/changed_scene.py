"""The scene as remedies change it: the part sprayed or tilted, the nearest lamps moved or behind a diffuser."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from materials.catalog import matte_twin
from scenes.reference_points import part_box
from scenes.scene import Body, Lamp, Mesh, Scene
from studies.advise.setup import LampsName

SWING_DEG = 90.0
"""By which the nearest lamps are swung about the vertical through the part's middle [deg] (choice: as far as an arm
reaches, and four panels in a square come to stand elsewhere)."""
DIFFUSER_SIDES = 2.0
"""Sides of a diffuser in sides of the lamp [-] (choice: a soft box of four times the area); it spreads all of the light
evenly, so that the radiance falls to a quarter."""
AS_NEAR = 1.1
"""Lamps up to so many times as far as the nearest one count as nearest [-] (choice: panels of one grid)."""


def changed_scene(scene: Scene, sprayed: bool, tilt_deg: float, lamps: LampsName) -> Scene:
    """The scene with these changes; the same object where there are none."""
    if sprayed:
        scene = scene.with_materials(lambda body: matte_twin(body.material) if body.is_part else body.material)
    if tilt_deg:
        scene = replace(scene, bodies=_tilted(scene, tilt_deg))
    if lamps != "own":
        near = nearest_lamps(scene)
        change = _swung if lamps == "moved" else _diffused
        middle = part_box(scene).mean(axis=0)
        scene = replace(scene, lamps=tuple(change(x, middle) if x in near else x for x in scene.lamps))
    return scene


def nearest_lamps(scene: Scene) -> tuple[Lamp, ...]:
    """Those that stand about as near to the part as the nearest one."""
    middle = part_box(scene).mean(axis=0)
    away = [float(np.linalg.norm(lamp.T_world_lamp.translation - middle)) for lamp in scene.lamps]
    return tuple(lamp for lamp, far in zip(scene.lamps, away, strict=True) if far <= AS_NEAR * min(away))


def _swung(lamp: Lamp, middle: np.ndarray) -> Lamp:
    axis = np.array([middle[0], middle[1], 0.0])
    turn = RigidTransform.from_rotation(Rotation.from_euler("z", SWING_DEG, degrees=True))
    swing = RigidTransform.from_translation(axis) * turn * RigidTransform.from_translation(-axis)
    return replace(lamp, T_world_lamp=swing * lamp.T_world_lamp)


def _diffused(lamp: Lamp, middle: np.ndarray) -> Lamp:
    sides = {"width": lamp.width * DIFFUSER_SIDES, "height": lamp.height * DIFFUSER_SIDES}
    return replace(lamp, **sides, radiance=lamp.radiance / DIFFUSER_SIDES**2)


def _tilted(scene: Scene, tilt_deg: float) -> tuple[Body, ...]:
    """All bodies, the part's turned about the world's x through the part's middle and set down as deep as it stood."""
    box = part_box(scene)
    turn = Rotation.from_euler("x", tilt_deg, degrees=True)
    middle = box.mean(axis=0)

    def turned(mesh: Mesh, lift: float = 0.0) -> Mesh:
        vertices = turn.apply(mesh.vertices - middle) + middle + [0.0, 0.0, lift]
        return replace(mesh, vertices=vertices, normals=None if mesh.normals is None else turn.apply(mesh.normals))

    lift = float(box[0, 2] - min(turned(body.mesh).vertices[:, 2].min() for body in scene.part_bodies))
    return tuple(replace(b, mesh=turned(b.mesh, lift)) if b.is_part else b for b in scene.bodies)
