"""The dot projector on the device: a point light whose intensity follows the dot pattern."""

from dataclasses import dataclass, replace
from typing import Any

from scipy.spatial.transform import RigidTransform

from render.light.pattern import BLUR_LEVELS, FIELD_MARGIN, DotPattern
from render.world import backend

FOOTPRINT_SIGMA = 0.5
"""Blur of the dots behind a glossy vertex, in units of the distance between samples (choice: the usual width of a
Gaussian reconstruction filter)."""


@dataclass(frozen=True, eq=False)
class ProjectorLight:
    """The dot projector as a point light with a pattern, on the device.

    A white wall at 1 m across the axis would have the radiance s = mean * pattern; a surface at distance r and angle a
    to the axis that faces the projector is lit with pi s / (r^2 cos^3 a). `sharp` and `blurred` are the textures of a
    `DotPattern` and `sigma` its dots' width, `position` is in the world [m]. A point has no aperture: its shadows have
    sharp edges.
    """

    half_field: tuple[float, float]
    """Tangents of the half field angles."""
    sharp: Any
    blurred: Any
    sigma: float
    mean: Any
    """Mean of s over the field, with s the radiance of a white wall at 1 m [W m^-2 sr^-1]."""
    position: Any
    world_to_projector: Any
    """Rotation (3, 3)."""

    @classmethod
    def at(cls, T_world_projector: RigidTransform, pattern: DotPattern, mean: float) -> "ProjectorLight":
        """The projector at a pose, upload of the pattern included."""
        mi = backend.mitsuba()
        import drjit as dr

        sharp = mi.Texture2f(mi.TensorXf(pattern.sharp[..., None]), wrap_mode=dr.WrapMode.Clamp)
        blurred = mi.Texture3f(mi.TensorXf(pattern.blurred[..., None]), wrap_mode=dr.WrapMode.Clamp)
        unplaced = cls(pattern.half_field, sharp, blurred, pattern.sigma, mi.Float(0), mi.Point3f(0), mi.Matrix3f(1))
        return unplaced.moved(T_world_projector, mean)

    def moved(self, T_world_projector: RigidTransform, mean: float) -> "ProjectorLight":
        """The same pattern at another pose, without a new upload."""
        mi = backend.mitsuba()
        import drjit as dr

        light = replace(
            self,
            mean=mi.Float(mean),
            position=mi.Point3f(*T_world_projector.translation.tolist()),
            world_to_projector=mi.Matrix3f(T_world_projector.rotation.as_matrix().T.tolist()),
        )
        # Opaque, so that every pose runs the same compiled kernel.
        dr.make_opaque(light.mean, light.position, light.world_to_projector)
        return light

    def connection(self, p: Any) -> tuple[Any, Any]:
        """Unit vectors from points to the projector, and the squared distances [m^2]."""
        import drjit as dr

        way = self.position - p
        distance2 = dr.maximum(dr.squared_norm(way), 1e-9)
        return way * dr.rsqrt(distance2), distance2

    def white_wall_radiance(self, direction: Any, footprint: Any, active: Any) -> tuple[Any, Any]:
        """s [W m^-2 sr^-1] towards `direction` (world, from the projector), and the cosine to the projector's axis.

        footprint: standard deviation of the blur in the plane at unit distance, 0 = sharp dots and a hard field edge.
        """
        mi = backend.mitsuba()
        import drjit as dr

        local = self.world_to_projector @ direction
        ahead = active & (local.z > 1e-3)
        scale = dr.rcp(dr.select(ahead, local.z, 1.0))
        half_x, half_y = self.half_field
        uv = mi.Point2f(local.x * scale / (2 * half_x) + 0.5, local.y * scale / (2 * half_y) + 0.5)
        in_field = ahead & (uv.x > 0) & (uv.x < 1) & (uv.y > 0) & (uv.y < 1)
        is_sharp = footprint <= 0
        level = dr.clip(_blur_level(footprint / self.sigma), 0, BLUR_LEVELS - 1)
        margin = 1 + FIELD_MARGIN
        uv_wide = mi.Point2f((uv.x - 0.5) / margin + 0.5, (uv.y - 0.5) / margin + 0.5)
        w = (level + 0.5) / BLUR_LEVELS
        near_field = ahead & (uv_wide.x > 0) & (uv_wide.x < 1) & (uv_wide.y > 0) & (uv_wide.y < 1)
        blurred = self.blurred.eval(mi.Point3f(uv_wide.x, uv_wide.y, w), near_field & ~is_sharp)[0]
        sharp = dr.select(in_field, self.sharp.eval(uv, in_field & is_sharp)[0], 0.0)
        return self.mean * dr.select(is_sharp, sharp, dr.select(near_field, blurred, 0.0)), local.z


def fall_off(cos_axis: Any, distance2: Any) -> Any:
    """r^2 cos^3 of places at this angle to the projector's axis [m^2]: the divisor of a white wall's radiance at 1 m.

    That radiance s means irradiance pi s / (r cos)^2 on a surface across the axis; one that faces the projector gets
    1 / cos times as much.
    """
    import drjit as dr

    return dr.maximum(cos_axis**3, 1e-6) * distance2


def dots_footprint(si: Any, ray: Any, towards: Any, distance2: Any, spread: Any) -> Any:
    """Blur of the dots for a path whose samples lie `spread` [sr] apart, in the plane at 1 m before the projector."""
    import drjit as dr

    cos_here = dr.maximum(dr.abs(dr.dot(si.n, towards)), 1e-3)
    cos_path = dr.maximum(dr.abs(dr.dot(si.n, ray.d)), 1e-2)
    area = spread * dr.square(si.t) / cos_path
    return dr.select(si.is_valid(), FOOTPRINT_SIGMA * dr.sqrt(area * cos_here / distance2), 0)


def _blur_level(blur: Any) -> Any:
    """Index of the blurred copy, fractional; blur in units of a sharp dot's sigma. Copy l is blurred by 2^(l - 1)."""
    import drjit as dr

    return dr.select(blur < 1, blur, 1 + dr.log2(dr.maximum(blur, 1)))
