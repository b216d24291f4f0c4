"""Light after many reflections: what paths that end after a few vertices would still have brought.

Radiosity between the patches of a scene (C. Goral et al., SIGGRAPH 1984): every patch sends out the same radiance all
over, but for what it gets straight from the sources, which is taken where rays from the other patches meet it: parts
of a floor that furniture hides are dark and unseen. So what patches get by way of others is X = F rho X + G rho + s, as
irradiance over pi, with form factors F, the direct light G that they see, and s from outside the scene. Metals count as
diffuse here, with their hemispherical reflectance: it is the third vertex of a path that is asked.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from materials.bands import in_band
from materials.coat import seen_reflectance
from materials.fresnel import hemispherical_reflectance
from materials.lights import Band
from materials.material import Material, Matte, RoughConductor, RoughPlastic
from render.world import backend
from render.world.scene_geometry import SceneGeometry
from scenes.scene import Scene

MEASURED_REFLECTANCE = 0.5
"""Hemispherical reflectance that a measured file counts with (choice: half way; it concerns the third vertex alone)."""
MOST_REFLECTANCE = 0.98
"""So that the series ends in a scene of white walls without a way out."""


@dataclass(frozen=True, eq=False)
class Closing:
    """X of every patch, for the projector's light from one pose and for the ambient light; Dr.Jit lookups."""

    geometry: SceneGeometry
    projector: Any
    """Irradiance over pi by way of other surfaces [W m^-2 sr^-1]."""
    ambient: Any
    """The same of lamps and surroundings, and what comes from outside."""

    def at(self, si: Any, active: Any) -> tuple[Any, Any]:
        """X of the projector's and of the ambient light at interactions."""
        mi = backend.mitsuba()
        import drjit as dr

        patch = self.geometry.patch(si)
        asked = active & si.is_valid()
        return dr.gather(mi.Float, self.projector, patch, asked), dr.gather(mi.Float, self.ambient, patch, asked)


class Radiosity:
    """Of one scene: made once, asked for every pose of the projector."""

    def __init__(self, geometry: SceneGeometry, materials: Sequence[Material], scene: Scene) -> None:
        """materials: of the bodies."""
        self._geometry = geometry
        bands = (Band.PROJECTOR, scene.lamp_band)
        by_body = np.array([[_hemispherical(in_band(m, band)) for m in materials] for band in bands]).reshape(2, -1)
        body = geometry.patches.body
        is_body = body < len(materials)
        rho = by_body[:, np.where(is_body, body, 0)] * is_body if len(materials) else np.zeros((2, len(body)))
        self._rho, views = rho, geometry.views
        self._series = [np.linalg.inv(np.eye(len(body)) - views.form_factors * band) for band in rho]
        ambient = self._series[1] @ (views.by_lamps @ rho[1] + views.outside * scene.ambient_radiance)
        self._ambient = ambient.astype(np.float32)

    def closing(self, by_projector: Float[np.ndarray, "n n"]) -> Closing:
        """by_projector: `PatchViews.seen` of the irradiance over pi straight from the projector [W m^-2 sr^-1]."""
        mi = backend.mitsuba()
        projector = (self._series[0] @ (by_projector @ self._rho[0])).astype(np.float32)
        return Closing(self._geometry, mi.Float(projector), mi.Float(self._ambient))


def _hemispherical(material: Material) -> float:
    """Reflectance under equal light from everywhere [-], about."""
    match material:
        case Matte(reflectance=reflectance):
            value = reflectance
        case RoughConductor(n=n, k=k, oxide_share=share, oxide_reflectance=oxide):
            value = (1 - share) * hemispherical_reflectance(n, k) + share * oxide
        case RoughPlastic(n=n, reflectance=base):
            value = hemispherical_reflectance(n) + seen_reflectance(n, base)
        case _:
            value = MEASURED_REFLECTANCE
    return min(value, MOST_REFLECTANCE)
