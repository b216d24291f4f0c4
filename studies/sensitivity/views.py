"""A case under each of its lights: measured, and labelled with the reasons for missing and false depth."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from render.d435i import Measurement, SimulatedD435i
from render.labels.labels import Labels, label_frame
from render.light.radiance import RadianceLayers
from render.world.truth import Truth
from scenes.scene import Lamp, Scene
from studies.sensitivity.cases import LitCase, SceneOf, look_camera, look_pose, look_scene
from studies.sensitivity.preset import Light
from studies.sensitivity.twins import stored_twin

LayerPair = tuple[RadianceLayers, RadianceLayers]


@dataclass(frozen=True, eq=False)
class LitView:
    """A burst under one light."""

    light: Light
    camera: SimulatedD435i
    measurement: Measurement
    truth: Truth
    labels: Labels


def lit_views(config: LitCase, twins: Path, scene_of: SceneOf = look_scene) -> Iterator[LitView]:
    """The case under each light in turn. The pose is rendered anew only for lamps that stand elsewhere.

    twins: folder of the matte twins.
    """
    first_scene = scene_of(config, config.material, config.lights[0])
    pose = look_pose(config, first_scene)
    first: LayerPair | None = None
    truth: Truth | None = None
    for light, twin in zip(config.lights, config.twins, strict=True):
        scene = scene_of(config, config.material, light)
        camera = look_camera(config, scene, light, config.glossy_paths)
        layers = _layers(camera, pose, first, ambient_scale(first_scene, scene))
        first = first or layers
        truth = truth or camera.truth(pose)
        measurement = camera.expose(pose, *layers, config.n_frames)
        labels = label_frame(camera, pose, measurement, stored_twin(twins, twin, scene_of), truth)
        yield LitView(light, camera, measurement, truth, labels)


def _layers(camera: SimulatedD435i, pose: RigidTransform, first: LayerPair | None, scale: float | None) -> LayerPair:
    if first is None or scale is None:
        return camera.render(pose)
    left, right = first
    return left.with_ambient_scaled(scale), right.with_ambient_scaled(scale)


def ambient_scale(before: Scene, after: Scene) -> float | None:
    """What the ambient layer of a scene must be multiplied by to be that of the same scene under other lamps.

    Light transport is linear, so this holds where the lamps differ in radiance alone or are off; None elsewhere.
    """
    if not before.lamps or before.ambient_radiance or after.ambient_radiance:
        return None
    if not after.lamps:
        return 0.0
    ratio = after.lamps[0].radiance / before.lamps[0].radiance
    if len(before.lamps) != len(after.lamps):
        return None
    alike = all(_alike(a, b, ratio) for a, b in zip(before.lamps, after.lamps, strict=True))
    return ratio if alike else None


def _alike(before: Lamp, after: Lamp, ratio: float) -> bool:
    same_place = np.allclose(before.T_world_lamp.as_matrix(), after.T_world_lamp.as_matrix())
    same_size = np.allclose([before.width, before.height], [after.width, after.height])
    return bool(same_place and same_size and np.isclose(after.radiance, ratio * before.radiance))
