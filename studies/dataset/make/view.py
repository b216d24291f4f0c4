"""One labelled view: rendered, exposed, matched, labelled, and turned into the images of `layers`."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, UInt8, UInt16
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.sensing import median_depth
from render.d435i import Measurement, SimulatedD435i
from render.labels.causes import Cause
from render.labels.labels import Labels, label_frame
from render.labels.twin import measure_twin
from render.world.mitsuba_scene import LoadedScene
from render.world.scene_geometry import NO_BODY
from render.world.surface import surface_map
from render.world.truth import Truth
from studies.dataset.draw.built_scene import BuiltScene, material_class, roughness
from studies.dataset.format.layers import NOTHING_16
from studies.store.images import MM, millimetres

Stage = Callable[[str], AbstractContextManager[None]]
"""Times what is done in it under a name."""


NO_BOX = (-1, -1, -1, -1)
"""Of what is not seen, as BOP writes it."""


@dataclass(frozen=True, eq=False)
class Silhouette:
    """An object as if it were alone."""

    mask: Bool[np.ndarray, "h w"]
    """Inside the image."""
    box: tuple[int, int, int, int]
    """x, y, width, height, beyond the image too [px]; all -1 where nothing of it is seen, as BOP has it."""
    pixels: int
    """Of the whole silhouette, beyond the image too."""


@dataclass(frozen=True, eq=False)
class LabelledView:
    """What one pose gives."""

    images: dict[str, np.ndarray]
    """By layer."""
    frames: UInt16[np.ndarray, "n h w"]
    """Depth of the single frames [mm]."""
    silhouettes: tuple[Silhouette, ...]
    """Of each object."""
    visible: tuple[Bool[np.ndarray, "h w"], ...]
    """Pixels that see each object."""
    exposure_us: float
    gain: float


@dataclass(frozen=True, eq=False)
class LoneObject:
    """An object of the scene without all else."""

    world: LoadedScene
    """In its model frame."""
    T_world_model: RigidTransform


@dataclass(frozen=True, eq=False)
class Cameras:
    """The same camera before a scene, before its matte twin, and for each object alone."""

    built: BuiltScene
    real: SimulatedD435i
    twin: SimulatedD435i
    objects: tuple[LoneObject, ...]


def labelled_view(cameras: Cameras, pose: RigidTransform, n_frames: int, stage: Stage) -> LabelledView:
    """Measure and label one pose."""
    real = cameras.real
    with stage("truth"):
        truth = real.truth(pose)
    with stage("rendering"):
        layers = real.render(pose)
    with stage("exposing and matching"):
        measurement = real.expose(pose, *layers, n_frames)
    with stage("matte twin"):
        twin = measure_twin(real, pose, n_frames, truth, cameras.twin)
    with stage("labels"):
        labels = label_frame(real, pose, measurement, twin, truth)
    owner = np.full(NO_BODY + 1, -1)
    owner[: len(cameras.built.owner)] = cameras.built.owner
    visible = tuple(owner[truth.body] == number for number in range(len(cameras.objects)))
    with stage("masks"):
        silhouettes = tuple(
            object_silhouette(thing.world, real.rig.intrinsics, thing.T_world_model.inv() * pose, seen)
            for thing, seen in zip(cameras.objects, visible, strict=True)
        )
    images = measured_images(measurement) | true_images(truth, cameras.built, pose) | label_images(labels)
    frames = np.stack([millimetres(depth) for depth in measurement.depths])
    if n_frames > 1:
        images["missing_frames"] = np.count_nonzero(frames == 0, axis=0).astype(np.uint8)
    imager = measurement.imager
    return LabelledView(images, frames, silhouettes, visible, imager.exposure_us, imager.gain)


def measured_images(measurement: Measurement) -> dict[str, np.ndarray]:
    """What the camera saw: the first infrared pair, the burst's median depth."""
    return {
        "gray": measurement.lefts[0],
        "gray_right": measurement.rights[0],
        "depth": millimetres(median_depth(measurement.depths)),
        "depth_decimated": millimetres(measurement.burst.median_depth()),
    }


def true_images(truth: Truth, built: BuiltScene, pose: RigidTransform) -> dict[str, np.ndarray]:
    """What is there."""
    there, bodies = truth.depth > 0, built.scene.bodies
    classes, rough = np.zeros(NO_BODY + 1, np.uint8), np.full((NO_BODY + 1, 2), NOTHING_16, np.uint16)
    classes[: len(bodies)] = [material_class(body.material, built.user) for body in bodies]
    for number, body in enumerate(bodies):
        alphas = roughness(body.material)
        if alphas is not None:
            rough[number] = np.rint(np.array(alphas) * 1e4)
    return {
        "depth_true": np.where(truth.depth < 6.5, np.rint(truth.depth * (10 * MM)), 0).astype(np.uint16),
        "normal": normal_image(truth.normal_world, there, pose),
        "incidence": np.where(there, np.rint(np.degrees(np.nan_to_num(truth.incidence)) * 100), NOTHING_16).astype(
            np.uint16
        ),
        "body": np.where(there, truth.body + 1, 0).astype(np.uint8),
        "material": classes[truth.body],
        "roughness_u": rough[truth.body, 0],
        "roughness_v": rough[truth.body, 1],
    }


def normal_image(
    normal_world: Float32[np.ndarray, "h w 3"], there: Bool[np.ndarray, "h w"], pose: RigidTransform
) -> UInt16[np.ndarray, "h w 3"]:
    """Normals in the camera frame, 16 bits a component."""
    normal = normal_world @ pose.rotation.as_matrix().astype(np.float32)
    return np.where(there[..., None], np.rint((normal + 1) * 32767), NOTHING_16).astype(np.uint16)


def label_images(labels: Labels) -> dict[str, UInt8[np.ndarray, "..."]]:
    """Why depth is missing, and where it is false."""
    maps = {}
    for suffix, cause, is_false, reflection in (
        ("", labels.cause, labels.false_depth, labels.false_by_reflection),
        ("_decimated", labels.cause_decimated, labels.false_decimated, labels.false_by_reflection_decimated),
    ):
        kinds = [np.uint8(Cause.FALSE_DEPTH_REFLECTION), np.uint8(Cause.FALSE_DEPTH_OTHER)]
        maps[f"cause{suffix}"] = cause
        maps[f"false_depth{suffix}"] = np.select([reflection, is_false], kinds, np.uint8(0))
    return maps


def object_silhouette(
    world: LoadedScene, intrinsics: Intrinsics, pose: RigidTransform, visible: Bool[np.ndarray, "h w"]
) -> Silhouette:
    """Shoot the pixels' centre rays at the object alone, on a canvas of three images' width and height, where it
    reaches beyond the image too (as BOP counts)."""
    left, top, width, height = canvas_window(world, intrinsics, pose)
    if width == 0 or height == 0:
        return Silhouette(np.zeros_like(visible), NO_BOX, 0)
    seen = surface_map(world, intrinsics.cropped(left, top, width, height), pose).body != NO_BODY
    rows = slice(*np.clip([top, top + height], 0, intrinsics.height).tolist())
    columns = slice(*np.clip([left, left + width], 0, intrinsics.width).tolist())
    inside = np.s_[rows.start - top : rows.stop - top, columns.start - left : columns.stop - left]
    seen[inside] |= visible[rows, columns]  # a ray along an edge may hit in one scene and miss in the other
    mask = np.zeros_like(visible)
    mask[rows, columns] = seen[inside]
    x, y, w, h = bounding_box(seen)
    box = (x + left, y + top, w, h) if visible.any() else NO_BOX
    return Silhouette(mask, box, int(np.count_nonzero(seen)))


def canvas_window(world: LoadedScene, intrinsics: Intrinsics, pose: RigidTransform) -> tuple[int, int, int, int]:
    """Left, top, width and height of the part of the canvas that the object can be seen in, a pixel around it included
    [px of the image].

    All of it where the object reaches behind the camera.
    """
    k = intrinsics
    points = pose.inv().apply(np.concatenate([body.mesh.vertices for body in world.source.bodies]))
    low, high = np.array([-k.width, -k.height]), np.array([2 * k.width, 2 * k.height])
    if np.all(points[:, 2] > 1e-3):
        uv = points[:, :2] / points[:, 2:] * [k.fx, k.fy] + [k.cx, k.cy]
        ends = np.clip([np.floor(uv.min(axis=0)) - 1, np.ceil(uv.max(axis=0)) + 2], low, high)
        low, high = ends.astype(int)
    left, top, right, bottom = (int(x) for x in (*low, *high))
    return left, top, right - left, bottom - top


def bounding_box(mask: Bool[np.ndarray, "h w"]) -> tuple[int, int, int, int]:
    """x, y, width, height of a mask [px]; all -1 where it is empty, as BOP writes it."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if not len(rows):
        return NO_BOX
    return int(columns[0]), int(rows[0]), int(columns[-1] - columns[0] + 1), int(rows[-1] - rows[0] + 1)
