"""One view under check: its images read, held against each other, and what is counted of them counted again."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool
from scipy.spatial.transform import RigidTransform

from render.d435i import SensorSettings
from render.world.rig import Rig
from studies.dataset.check.depth import decimation_faults, frame_faults, pair_faults
from studies.dataset.check.draw import difference
from studies.dataset.check.geometry import cause_faults, place_faults
from studies.dataset.check.images import Images, LayerFault, view_faults
from studies.dataset.check.masks import read_silhouettes, silhouette_fault
from studies.dataset.config import DatasetConfig
from studies.dataset.draw.built_scene import BuiltScene
from studies.dataset.draw.draw import SceneDraw
from studies.dataset.format.folders import STATISTICS
from studies.dataset.format.layers import FRAMES, Layer
from studies.dataset.format.layers import layers as layers_of
from studies.dataset.format.reader import read_layer
from studies.dataset.format.statistics import counts
from studies.dataset.make import bop
from studies.dataset.make.view import LabelledView

INFO = "scene_gt_info.json"


@dataclass(frozen=True, eq=False)
class SceneSaid:
    """What a scene's files say of all of its views."""

    folder: Path
    config: DatasetConfig
    draw: SceneDraw
    bodies: list[dict[str, Any]]
    """Of `scene.json`."""
    built: BuiltScene | None
    """As the configuration gives it; None where it cannot be drawn again."""

    @property
    def sensor(self) -> SensorSettings:
        """The camera at the drawn profile."""
        return self.config.camera.sensor(self.draw.profile)

    @property
    def rig(self) -> Rig:
        """Of the drawn profile."""
        return self.sensor.rig


@dataclass(frozen=True, eq=False)
class ViewSaid:
    """What a scene's files say of one view."""

    number: int
    info: list[dict[str, Any]]
    statistics: list[list[int]]


def read_images(scene: SceneSaid, number: int) -> dict[str, np.ndarray]:
    """All layers of a view; ValueError naming the file that is of another size or type."""
    return {layer.folder: _read(scene, layer, f"{number:06d}") for layer in layers_of(scene.config.n_frames)}


def read_frames(scene: SceneSaid, number: int, depth: np.ndarray) -> np.ndarray | None:
    """Single depth frames [mm], (n, h, w); of one-frame views the depth itself, None where they are not kept."""
    if scene.config.n_frames == 1:
        return depth[None]
    if not scene.config.keep_frames:
        return None
    names = (f"{number:06d}_{place:06d}" for place in range(scene.config.n_frames))
    return np.stack([_read(scene, FRAMES, name) for name in names])


def _read(scene: SceneSaid, layer: Layer, name: str) -> np.ndarray:
    k, factor = scene.rig.intrinsics, scene.config.camera.decimation if layer.decimated else 1
    place = f"{layer.folder}/{name}.png"
    image = read_layer(scene.folder / place, layer)
    if image.shape[:2] != (k.height // factor, k.width // factor):
        raise ValueError(f"{place}: is {image.shape[1]}x{image.shape[0]} pixels")
    return image


def check_view(scene: SceneSaid, view: ViewSaid) -> tuple[list[tuple[str, str]], list[dict[str, Any]]]:
    """Files of a view with what is wrong with them, and the COCO annotations that its masks give."""
    images = read_images(scene, view.number)
    faults = [(f"{layer}/{view.number:06d}.png", what) for layer, what in image_faults(scene, view.number, images)]
    owner = np.array([-1, *(entry["object"] for entry in scene.bodies)])[images["body"]]
    visible = tuple(owner == place for place in range(len(scene.draw.objects)))
    more, annotations = mask_faults(scene, view, images["depth"], visible)
    if counts(images, owner >= 0) != view.statistics:
        more.append((STATISTICS, "the counts are not those of the images"))
    return faults + more, annotations


def image_faults(scene: SceneSaid, number: int, images: Images) -> Iterator[LayerFault]:
    """What the images say against each other, the pose and the bodies."""
    rig, config = scene.rig, scene.config
    faults = list(view_faults(images, scene.bodies, config.materials.of_user, rig, config.n_frames))
    yield from faults
    frames = read_frames(scene, number, images["depth"])
    if frames is not None:
        yield from frame_faults(images, frames)
    yield from pair_faults(
        images, frames, config.n_frames, config.camera.sensor(scene.draw.profile).stereo_matcher, rig
    )
    yield from decimation_faults(images, frames, config.camera.decimation, rig)
    yield from cause_faults(images, rig)
    if scene.built is not None:
        pose = RigidTransform.from_matrix(np.array(scene.draw.views[number].T_world_cam))
        yield from place_faults(images, scene.built.scene.bodies, pose, rig)


def mask_faults(
    scene: SceneSaid, view: ViewSaid, depth: np.ndarray, visible: tuple[Bool[np.ndarray, "h w"], ...]
) -> tuple[list[tuple[str, str]], list[dict[str, Any]]]:
    """What is wrong with masks and their counts, and the annotations that they give."""
    silhouettes, faults = read_silhouettes(scene.folder, view.number, visible, view.info)
    if scene.built is not None:
        pose = RigidTransform.from_matrix(np.array(scene.draw.views[view.number].T_world_cam))
        for place, silhouette in enumerate(silhouettes):
            points = scene.built.object_vertices(place)
            if what := silhouette_fault(silhouette, bool(visible[place].any()), points, pose, scene.rig.intrinsics):
                faults.append((INFO, f"object {place}: {what}"))
    again = LabelledView(
        {"depth": depth}, np.zeros((0, *depth.shape), np.uint16), tuple(silhouettes), visible, 0.0, 0.0
    )
    if what := difference(view.info, bop.info_entries(again), "objects"):
        faults.append((INFO, what))
    return faults, bop.coco_annotations(scene.draw, view.number, again)
