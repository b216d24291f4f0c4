"""What is really behind each pixel of the left image: depth, normal, incidence angle, body, visibility."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, UInt8
from scipy.spatial.transform import RigidTransform

from franbv.frames import project
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.rig import Rig
from render.world.scene_geometry import FIRST_LAMP, NO_BODY
from render.world.surface import SurfaceMap
from scenes.scene import Scene


@dataclass(frozen=True, eq=False)
class Truth:
    """Exact maps along the left imager's pixel-centre rays.

    No lens blur and no mean over the pixel: at an edge it tells one of the two surfaces. A mirror counts as the surface
    that it is, not as what is seen in it.
    """

    depth: Float32[np.ndarray, "h w"]
    """Z-depth [m], 0 = nothing there."""
    normal_world: Float32[np.ndarray, "h w 3"]
    """Unit normal turned towards the imager, 0 = nothing there."""
    incidence: Float32[np.ndarray, "h w"]
    """Angle between normal and view ray [rad], NaN = nothing there."""
    body: UInt8[np.ndarray, "h w"]
    """Index into the scene's bodies; from `mitsuba_scene.FIRST_LAMP` on a lamp or nothing."""
    in_right_image: Bool[np.ndarray, "h w"]
    """Whether the point falls on the right imager's pixels, hidden or not."""
    visible_from_right: Bool[np.ndarray, "h w"]
    """Whether the point falls on the right imager's pixels and nothing hides it from there."""
    visible_from_projector: Bool[np.ndarray, "h w"]
    """Whether nothing hides the point from the projector."""


def looks_at_part(truth: Truth, scene: Scene) -> Bool[np.ndarray, "h w"]:
    """Pixels that look at a body of the part. scene: the one that the truth was found in."""
    is_part = np.zeros(NO_BODY + 1, bool)
    is_part[: len(scene.bodies)] = [body.is_part for body in scene.bodies]
    return is_part[truth.body]


def measure_truth(world: LoadedScene, rig: Rig, T_world_cam: RigidTransform, surface: SurfaceMap) -> Truth:
    """The truth for a rig whose left imager stands at `T_world_cam` and sees this surface."""
    hit = surface.body < FIRST_LAMP
    shape = hit.shape
    points = surface.position.reshape(-1, 3).T.astype(float)
    depth = np.where(hit, _in_frame(points, T_world_cam)[2].reshape(shape), 0).astype(np.float32)

    view = T_world_cam.translation - surface.position
    distance = np.maximum(np.linalg.norm(view, axis=-1), 1e-9)
    cosine = np.einsum("hwk,hwk->hw", view, surface.normal) / distance
    incidence = np.where(hit, np.arccos(np.clip(cosine, -1, 1)), np.nan).astype(np.float32)

    in_right = hit & _in_image(points, rig, rig.right_imager(T_world_cam)).reshape(shape)
    return Truth(
        depth,
        surface.normal,
        incidence,
        surface.body,
        in_right,
        in_right & _reached(world, surface, rig.right_imager(T_world_cam).translation),
        hit & _reached(world, surface, rig.projector(T_world_cam).translation),
    )


def _in_frame(points_world: Float[np.ndarray, "3 n"], T_world_frame: RigidTransform) -> Float[np.ndarray, "3 n"]:
    """Points in another frame [m]; several times as fast as `RigidTransform.apply`."""
    x, y, z = points_world - T_world_frame.translation[:, None]
    return np.stack([a * x + b * y + c * z for a, b, c in T_world_frame.rotation.as_matrix().T])


def _in_image(
    points_world: Float[np.ndarray, "3 n"], rig: Rig, T_world_imager: RigidTransform
) -> Bool[np.ndarray, "n"]:
    """Whether points fall on the imager's pixels."""
    k = rig.intrinsics
    u, v = project(_in_frame(points_world, T_world_imager).T, k).T
    with np.errstate(invalid="ignore"):
        return (u >= -0.5) & (u < k.width - 0.5) & (v >= -0.5) & (v < k.height - 0.5)


def _reached(world: LoadedScene, surface: SurfaceMap, place: np.ndarray) -> Bool[np.ndarray, "h w"]:
    """Which of the map's points see `place` (3,) from the side that the imager sees."""
    mi = backend.mitsuba()
    import drjit as dr

    points, normals = (np.ascontiguousarray(a.reshape(-1, 3).T) for a in (surface.position, surface.normal))
    si = dr.zeros(mi.SurfaceInteraction3f, points.shape[1])
    si.t, si.p, si.n = mi.Float(1), mi.Point3f(points), mi.Normal3f(normals)
    target = mi.Point3f(*np.asarray(place, float).tolist())
    facing = dr.dot(si.n, target - si.p) > 0
    hidden = world.scene.ray_test(si.spawn_ray_to(target), active=facing)
    return (facing & ~hidden).numpy().reshape(surface.body.shape)
