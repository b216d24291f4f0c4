"""Light paths from an imager through the scene: what the projector and the lamps add at every vertex.

Projector and ambient light are carried side by side along the same path, since transport is linear. At each vertex the
projector (a point) and one point on every lamp are connected; the path then follows a sample of the BSDF. Metal's BSDF
samples that hit a lamp are weighted against the lamp connections by the power heuristic (Veach 1997, ch. 9).

Two choices keep Monte-Carlo error below the imager's noise at few samples:
- every pixel uses the *same* low-discrepancy sample set, so error varies over the image as slowly as the scene does,
  instead of appearing as noise between neighbours that a census transform would see;
- behind a glossy vertex, the dots are looked up blurred to the footprint of one sample (as texture filtering by ray
  differentials does: Igehy 1999), so that N samples of a lobe stand for the whole lobe and not for N dots.

Left out: light that metal throws onto a Lambertian surface (caustics). Paths from the camera find it too rarely, and
what they find of it is blotches.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform
from scipy.stats import qmc

from franbv.frames import Intrinsics
from render import backend
from render.dot_pattern import BLUR_LEVELS, FIELD_MARGIN, HALF_FIELD, DotPattern
from render.mitsuba_scene import FIRST_LAMP, LoadedScene

DIMENSIONS_PIXEL = 2
"""Sample dimensions: position in the pixel."""
DIMENSIONS_VERTEX = 5
"""Sample dimensions per vertex: BSDF direction (2), point on a lamp (2), BSDF component (1). The direction comes first,
since a Sobol' set is most even in its first dimensions."""
FOOTPRINT_SIGMA = 0.5
"""Blur of the dots behind a glossy vertex, in units of the distance between samples (choice: the usual width of a
Gaussian reconstruction filter)."""


@dataclass(frozen=True, eq=False)
class ProjectorLight:
    """The dot projector as a point light with a pattern, on the device."""

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
        """The projector at a pose, upload included."""
        mi = backend.mitsuba()
        import drjit as dr

        rotation = T_world_projector.rotation.as_matrix().T
        light = cls(
            mi.Texture2f(mi.TensorXf(pattern.sharp[..., None]), wrap_mode=dr.WrapMode.Clamp),
            mi.Texture3f(mi.TensorXf(pattern.blurred[..., None]), wrap_mode=dr.WrapMode.Clamp),
            pattern.sigma,
            mi.Float(mean),
            mi.Point3f(*T_world_projector.translation.tolist()),
            mi.Matrix3f(rotation.tolist()),
        )
        # Opaque, so that every pose runs the same compiled kernel.
        dr.make_opaque(light.mean, light.position, light.world_to_projector)
        return light

    def moved(self, T_world_projector: RigidTransform, mean: float) -> "ProjectorLight":
        """The same pattern at another pose, without a new upload."""
        mi = backend.mitsuba()
        import drjit as dr

        rotation = T_world_projector.rotation.as_matrix().T
        light = ProjectorLight(
            self.sharp,
            self.blurred,
            self.sigma,
            mi.Float(mean),
            mi.Point3f(*T_world_projector.translation.tolist()),
            mi.Matrix3f(rotation.tolist()),
        )
        dr.make_opaque(light.mean, light.position, light.world_to_projector)
        return light

    def white_wall_radiance(self, direction: Any, footprint: Any, active: Any) -> tuple[Any, Any]:
        """s [W m^-2 sr^-1] towards `direction` (world, from the projector), and the cosine to the projector's axis.

        footprint: standard deviation of the blur in the plane at unit distance, 0 = sharp dots and a hard field edge.
        """
        mi = backend.mitsuba()
        import drjit as dr

        local = self.world_to_projector @ direction
        ahead = active & (local.z > 1e-3)
        scale = dr.rcp(dr.select(ahead, local.z, 1.0))
        half_x, half_y = HALF_FIELD
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


def _blur_level(blur: Any) -> Any:
    """Index of the blurred copy, fractional; blur in units of a sharp dot's sigma. Copy l is blurred by 2^(l - 1)."""
    import drjit as dr

    return dr.select(blur < 1, blur, 1 + dr.log2(dr.maximum(blur, 1)))


@dataclass(frozen=True, eq=False)
class SampleSet:
    """A scrambled Sobol' set that every pixel shares, or that every pixel shifts at random (`rotated`)."""

    n: int
    """Samples per pixel, a power of two."""
    table: Any
    dimensions: int
    rotated: bool

    @classmethod
    def sobol(cls, n: int, max_depth: int, rotated: bool = False, seed: int = 0) -> "SampleSet":
        """n points for paths of up to `max_depth` vertices; `seed` picks the scrambling."""
        mi = backend.mitsuba()
        dimensions = DIMENSIONS_PIXEL + DIMENSIONS_VERTEX * (max_depth + 1)
        points = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed)).random(n)
        return cls(n, mi.Float(np.clip(points, 0, 1 - 1e-6).astype(np.float32).ravel()), dimensions, rotated)

    def uniform(self, sample: Any, pixel: Any, dimension: Any, active: Any = True) -> Any:
        """Coordinate `dimension` of the sample, in [0, 1)."""
        mi = backend.mitsuba()
        import drjit as dr

        value = dr.gather(mi.Float, self.table, sample * self.dimensions + dimension, active)
        if self.rotated:
            value += mi.sample_tea_float32(pixel, dimension + 1)
            value -= dr.floor(value)
        return dr.minimum(value, np.float32(1 - 6e-8))


@dataclass(frozen=True, eq=False)
class Imager:
    """One imager's pose and intrinsics on the device."""

    origin: Any
    rotation: Any
    calibration: Any
    """(fx, fy, cx, cy), opaque."""

    @classmethod
    def at(cls, T_world_imager: RigidTransform, intrinsics: Intrinsics) -> "Imager":
        """Upload a pose."""
        mi = backend.mitsuba()
        import drjit as dr

        imager = cls(
            mi.Point3f(*T_world_imager.translation.tolist()),
            mi.Matrix3f(T_world_imager.rotation.as_matrix().tolist()),
            tuple(mi.Float(x) for x in (intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy)),
        )
        dr.make_opaque(imager.origin, imager.rotation, *imager.calibration)
        return imager

    def ray(self, u: Any, v: Any) -> Any:
        """World rays through pixel coordinates (u, v); pixel centres at integers."""
        mi = backend.mitsuba()
        import drjit as dr

        fx, fy, cx, cy = self.calibration
        return mi.Ray3f(self.origin, dr.normalize(self.rotation @ mi.Vector3f((u - cx) / fx, (v - cy) / fy, 1)))


def trace_paths(
    world: LoadedScene,
    light: ProjectorLight,
    ray: Any,
    pixel: Any,
    sample: Any,
    samples: SampleSet,
    max_depth: int,
    *,
    first_vertex: int = 0,
    filtered: bool = True,
    projector_shadows: bool = True,
) -> tuple[Any, Any]:
    """Radiance along `ray` from the projector and from the lamps [W m^-2 sr^-1], one value a path.

    max_depth: surface vertices of a path at the most. first_vertex: number of the vertex that `ray` meets, > 0 where
    the path's earlier vertices are the caller's and Lambertian: then lamps met directly count nothing (the caller
    connected them) and dots are looked up with the footprint of a cosine lobe's sample.
    projector_shadows: whether anything stands in the projector's light.
    """
    mi = backend.mitsuba()
    import drjit as dr

    scene, n = world.scene, dr.width(pixel)

    def vertex(ray, from_projector, from_lamps, beta, active, i, pdf, diffused, spread):
        si = scene.ray_intersect(ray, mi.RayFlags.All, coherent=i == 0, active=active)
        hit = active & si.is_valid()
        body = world.body(si)
        arriving = light_met(world, si, ray, body, pdf, i, diffused)
        from_lamps += dr.select(active, beta * arriving, 0)
        glossy = world.is_glossy(body)
        scattering = hit & (i < max_depth) & (body < FIRST_LAMP)
        connected = scattering & ~(diffused & glossy)

        # Where light may come from: the projector, one point on each lamp.
        dimension = DIMENSIONS_PIXEL + DIMENSIONS_VERTEX * i
        u = [samples.uniform(sample, pixel, dimension + k, active) for k in range(DIMENSIONS_VERTEX)]
        to_projector = light.position - si.p
        distance2 = dr.maximum(dr.squared_norm(to_projector), 1e-9)
        towards = to_projector * dr.rsqrt(distance2)
        links = [lamp.connection(si.p, u[2], u[3]) for lamp in world.lamps]
        directions = [si.to_local(towards), *(si.to_local(direction) for _, direction, _ in links)]
        values, onwards, bsdf_pdf, weight = _scatter(
            si, directions, u[4], mi.Point2f(u[0], u[1]), connected, scattering
        )

        footprint = _footprint(si, ray, towards, distance2, spread) if filtered else mi.Float(0)
        f_cos, _ = values[0]
        s, cos_axis = light.white_wall_radiance(-towards, footprint, connected)
        lit = connected & (f_cos > 0) & (s > 0)
        if projector_shadows:
            lit &= ~scene.ray_test(si.spawn_ray_to(light.position), coherent=i == 0, active=lit)
        # White-wall radiance s at 1 m means irradiance pi s / z^2 with z = r cos, on a surface that faces the axis.
        irradiance = dr.pi * s / (dr.maximum(cos_axis**3, 1e-6) * distance2)
        from_projector += dr.select(lit, beta * f_cos * irradiance, 0)

        for lamp, (place, _, density), (f_cos, f_pdf) in zip(world.lamps, links, values[1:], strict=True):
            lit = connected & (f_cos > 0) & (density > 0)
            lit &= ~scene.ray_test(si.spawn_ray_to(place), coherent=i == 0, active=lit)
            weight_over_density = density / (dr.square(density) + dr.select(glossy, dr.square(f_pdf), 0))
            from_lamps += dr.select(lit, beta * f_cos * lamp.radiance * weight_over_density, 0)

        beta = beta * weight
        i += 1
        active = scattering & (bsdf_pdf > 0) & (beta > 0)
        spread = spread + dr.rcp(samples.n * dr.maximum(bsdf_pdf, 1e-6))
        return (
            si.spawn_ray(si.to_world(onwards)), from_projector, from_lamps, beta, active, i,
            bsdf_pdf, diffused | ~glossy, spread,
        )  # fmt: skip

    state = (
        ray,
        dr.zeros(mi.Float, n),
        dr.zeros(mi.Float, n),
        dr.full(mi.Float, 1, n),
        dr.full(mi.Bool, True, n),
        dr.full(mi.UInt32, first_vertex, n),
        dr.zeros(mi.Float, n),
        dr.full(mi.Bool, first_vertex > 0, n),
        dr.full(mi.Float, np.pi / samples.n if first_vertex else 0, n),
    )
    final = dr.while_loop(state, lambda *s: s[4], vertex)
    return final[1], final[2]


def light_met(world: LoadedScene, si: Any, ray: Any, body: Any, pdf: Any, i: Any, diffused: Any) -> Any:
    """Radiance that a ray brings from a lamp it meets or from outside the scene.

    pdf: density of the ray's direction over solid angle; lamps met behind a glossy vertex are weighted by the power
    heuristic, behind a Lambertian one they count nothing, since they were connected there with full weight.
    """
    import drjit as dr

    radiance = dr.select(si.is_valid(), 0, world.ambient)
    for k, lamp in enumerate(world.lamps):
        cosine = -dr.dot(ray.d, lamp.normal)
        density = dr.square(si.t) / dr.maximum(cosine * lamp.area, 1e-9)
        weight = dr.select(i == 0, 1, dr.select(diffused, 0, dr.square(pdf) / (dr.square(pdf) + dr.square(density))))
        radiance += dr.select((body == FIRST_LAMP + k) & (cosine > 0), weight * lamp.radiance, 0)
    return radiance


def _scatter(
    si: Any, directions: list[Any], u: Any, v: Any, connected: Any, scattering: Any
) -> tuple[list[tuple[Any, Any]], Any, Any, Any]:
    """All that a vertex asks of its BSDF, in one dynamic call.

    Returns (value times cosine, density) for each local direction of light, and a sampled direction with its density
    and its weight.
    """
    mi = backend.mitsuba()
    import drjit as dr

    context = mi.BSDFContext()

    def ask(bsdf, si, directions, u, v, connected, scattering):
        pairs = [bsdf.eval_pdf(context, si, wo, connected) for wo in directions]
        sampled, weight = bsdf.sample(context, si, u, v, scattering)
        return [(value.x, pdf) for value, pdf in pairs], sampled.wo, sampled.pdf, weight.x

    return dr.dispatch(si.bsdf(), ask, si, directions, u, v, connected, scattering)


def _footprint(si: Any, ray: Any, towards: Any, distance2: Any, spread: Any) -> Any:
    """Blur of the dots for a path whose samples lie `spread` [sr] apart, in the plane at 1 m before the projector."""
    import drjit as dr

    cos_here = dr.maximum(dr.abs(dr.dot(si.n, towards)), 1e-3)
    cos_path = dr.maximum(dr.abs(dr.dot(si.n, ray.d)), 1e-2)
    area = spread * dr.square(si.t) / cos_path
    return dr.select(si.is_valid(), FOOTPRINT_SIGMA * dr.sqrt(area * cos_here / distance2), 0)
