"""What the pixels of an imager see of a scene, as its optics and the laser's speckle need it: depth and smoothness."""

from collections.abc import Sequence
from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Float, Float32, UInt8
from scipy.spatial.transform import RigidTransform

from materials.coat import seen_reflectance
from materials.fresnel import normal_reflectance
from materials.material import Material, RoughConductor, RoughPlastic
from render.imager.seen_surfaces import SeenSurfaces
from render.imager.surface_speckle import coherent_share, specular_share, surface_height
from render.world.mitsuba_scene import NO_BODY
from render.world.surface import SurfaceMap

LEAST_SHARE = 1e-3
"""Coherent share of a surface's light below which it counts as rough (choice: a thousandth of the contrast)."""


def seen_surfaces(
    surface: SurfaceMap,
    materials: Sequence[Material],
    T_world_imager: RigidTransform,
    projector: Float[np.ndarray, "3"],
) -> SeenSurfaces:
    """What an imager's optics see. materials: of the scene's bodies; projector: its place in the world [m]."""
    axis = T_world_imager.rotation.as_matrix()[:, 2].astype(np.float32)
    eye = T_world_imager.translation.astype(np.float32)
    inverse_depth = np.zeros(surface.body.shape, np.float32)
    _invert_depths(surface.body, surface.position, eye, axis, inverse_depth)
    alpha, gloss = np.ones(NO_BODY + 1, np.float32), np.zeros(NO_BODY + 1, np.float32)
    for body, material in enumerate(materials):
        alpha[body], gloss[body] = glossy_part(material)
    height = surface_height(alpha).astype(np.float32)
    share = np.zeros(surface.body.size, np.float32)
    smooth = np.flatnonzero(np.take(gloss > 0, surface.body))
    if len(smooth):
        points, normal = (np.take(a.reshape(-1, 3), smooth, axis=0) for a in (surface.position, surface.normal))
        to_projector, to_imager = (_directions(points, place) for place in (projector.astype(np.float32), eye))
        body = np.take(surface.body, smooth)
        share[smooth] = gloss[body] * specular_share(to_projector, to_imager, normal, alpha[body], height[body])
    return SeenSurfaces(inverse_depth, share.reshape(surface.body.shape))


def glossy_part(material: Material) -> tuple[float, float]:
    """GGX roughness across the lay of what mirrors, and its share of the light in the middle of the highlight.

    The share is 0 for surfaces too rough to send any light coherently, and for measured ones, whose roughness is not
    known. Of a coat over a base it is that at normal incidence, GGX's peak F / (4 pi alpha^2) beside the base's albedo,
    as it is seen, over pi. Oxides lie on metals that are rough by far.
    """
    if isinstance(material, RoughConductor):
        alpha, gloss = max(material.alpha_u, material.alpha_v), 1 - material.oxide_share
    elif isinstance(material, RoughPlastic):
        alpha = material.alpha
        coat = normal_reflectance(material.n) / (4 * alpha**2)
        gloss = coat / (coat + seen_reflectance(material.n, material.reflectance))
    else:
        return 1.0, 0.0
    kept = coherent_share(surface_height(np.array([alpha])), np.ones(1))[0]
    return alpha, gloss if kept > LEAST_SHARE else 0.0


@no_type_check
@numba.njit(nogil=True, cache=True)
def _invert_depths(
    body: UInt8[np.ndarray, "h w"],
    position: Float32[np.ndarray, "h w 3"],
    eye: Float32[np.ndarray, "3"],
    axis: Float32[np.ndarray, "3"],
    out: Float32[np.ndarray, "h w"],
) -> None:
    """One over the way along the optical axis, where there is anything."""
    for v in range(out.shape[0]):
        for u in range(out.shape[1]):
            if body[v, u] != NO_BODY:
                depth = np.float32(0)
                for k in range(3):
                    depth += (position[v, u, k] - eye[k]) * axis[k]
                out[v, u] = np.float32(1) / depth


def _directions(points: Float32[np.ndarray, "p 3"], place: Float32[np.ndarray, "3"]) -> Float32[np.ndarray, "p 3"]:
    """Unit vectors from the points to a place."""
    away = place - points
    return away / np.linalg.norm(away, axis=1, keepdims=True)
