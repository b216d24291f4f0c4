"""The true surface behind missing depth, in elements of one full-resolution pixel each.

A pixel at Z-depth Z, whose ray (x, y, 1) meets the surface at incidence theta, stands for an area of
Z^2 / (fx fy |ray| cos theta): its solid angle is 1 / (fx fy |ray|^3), at the distance Z |ray|.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import label
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render.d435i import SimulatedD435i
from render.labels.causes import is_of
from render.labels.labels import Labels
from render.labels.outcome import blocks
from render.world.truth import Truth

LEAST_COSINE = 0.02
"""Incidence is taken as 88.9 deg at the most, where an element's area would grow without bound (choice)."""


@dataclass(frozen=True, eq=False)
class Surface:
    """A piece of true surface as one view sees it."""

    points: Float[np.ndarray, "n 3"]
    """World frame [m]."""
    normals: Float[np.ndarray, "n 3"]
    """Unit normals towards that view."""
    areas: Float[np.ndarray, "n"]
    """[m^2]"""

    @property
    def area(self) -> float:
        """[m^2]"""
        return float(self.areas.sum())

    @property
    def centre(self) -> Float[np.ndarray, "3"]:
        """Mean of the points by area [m]."""
        return self.areas @ self.points / self.area

    def only(self, chosen: Bool[np.ndarray, "n"] | Int[np.ndarray, "m"]) -> "Surface":
        """Some of its elements."""
        return Surface(self.points[chosen], self.normals[chosen], self.areas[chosen])


def visible_surface(truth: Truth, intrinsics: Intrinsics, T_world_cam: RigidTransform) -> Surface:
    """All pixels, row by row; elements where nothing is have no area. intrinsics: of the full resolution."""
    rays, depth = intrinsics.pixel_directions(), truth.depth.astype(float)
    areas = pixel_areas(depth, np.nan_to_num(truth.incidence.astype(float)), intrinsics, LEAST_COSINE)
    points = T_world_cam.apply((rays * depth[..., None]).reshape(-1, 3))
    return Surface(points, truth.normal_world.reshape(-1, 3).astype(float), areas.ravel())


def pixel_areas(
    depth: Float[np.ndarray, "h w"], incidence: Float[np.ndarray, "h w"], intrinsics: Intrinsics, least_cosine: float
) -> Float[np.ndarray, "h w"]:
    """Surface behind each pixel [m^2] by the formula at the head of the module; NaN where the incidence [rad] is."""
    cosine = np.maximum(np.cos(incidence), least_cosine)
    length = np.linalg.norm(intrinsics.pixel_directions(), axis=-1)
    return depth**2 / (length * intrinsics.fx * intrinsics.fy * cosine)


def block_pixels(camera: SimulatedD435i) -> Int[np.ndarray, "h_d w_d n"]:
    """Flat indices of the full-resolution pixels behind each decimated one."""
    k = camera.rig.intrinsics
    return blocks(np.arange(k.width * k.height).reshape(k.height, k.width), camera)


def reflective_holes(labels: Labels) -> Bool[np.ndarray, "h_d w_d"]:
    """Decimated pixels that have no depth because of reflection: what the detector is to find."""
    return is_of(labels.cause_decimated, "reflection")


def missing_patches(camera: SimulatedD435i, labels: Labels) -> tuple[Int[np.ndarray, "_"], ...]:
    """Flat full-resolution pixels of each connected reflective hole, the one with most pixels first.

    Decimated pixels are connected over sides and corners; of each only the source pixels count that are themselves lost
    to reflection.
    """
    components = np.zeros(labels.cause_decimated.shape, np.int32)
    label(reflective_holes(labels), structure=np.ones((3, 3)), output=components)
    sources, lost = block_pixels(camera), is_of(labels.cause, "reflection").ravel()
    patches = [sources[components == k].ravel() for k in range(1, components.max() + 1)]
    return tuple(sorted((patch[lost[patch]] for patch in patches), key=len, reverse=True))
