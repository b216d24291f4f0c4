"""Light paths from an imager through the scene: what the projector and the lamps add at every vertex.

Projector and ambient light are carried side by side along the same path, since transport is linear. At each vertex the
projector (a point) and one point on a lamp are connected; the path then follows a sample of the BSDF. Metal's BSDF
samples that hit a lamp are weighted against the lamp connections by the power heuristic (Veach 1997, ch. 9).

Two choices keep Monte-Carlo error below the imager's noise at few samples:
- every pixel uses the *same* low-discrepancy sample set, so error varies over the image as slowly as the scene does,
  instead of appearing as noise between neighbours that a census transform would see;
- behind a glossy vertex, the dots are looked up blurred to the footprint of one sample (as texture filtering by ray
  differentials does: Igehy 1999), so that N samples of a lobe stand for the whole lobe and not for N dots.

Left out: light that metal throws onto a Lambertian surface (caustics). Paths from the camera find it too rarely, and
what they find of it is blotches.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render import backend
from render.mitsuba_scene import FIRST_LAMP, LoadedScene
from render.projector_light import ProjectorLight, fall_off
from render.sampling import DIMENSIONS_PIXEL, DIMENSIONS_VERTEX, SampleSet

FOOTPRINT_SIGMA = 0.5
"""Blur of the dots behind a glossy vertex, in units of the distance between samples (choice: the usual width of a
Gaussian reconstruction filter)."""


SmoothRadiance = Callable[[Any, Any, Any, Any], tuple[Any, Any]]
"""Of interactions, rays, bodies and which are asked: where it is known, and there a Vector3f [W m^-2 sr^-1]: the
radiance of the projector's light and of the ambient light that came by way of other surfaces, and that of the lamps'
own light."""


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

    def project(self, p: Any) -> tuple[Any, Any, Any]:
        """Pixel coordinates (u, v) and Z-depth [m] of world points; (u, v) mean nothing where the depth is not > 0."""
        import drjit as dr

        fx, fy, cx, cy = self.calibration
        local = self.rotation.T @ (p - self.origin)
        scale = dr.rcp(dr.select(local.z > 0, local.z, 1))
        return fx * local.x * scale + cx, fy * local.y * scale + cy, local.z


@dataclass
class PathLight:
    """What light paths bring, one value a path [W m^-2 sr^-1]."""

    projector: Any
    lamps: Any
    projector_stopped: Any
    """The same from paths that stop at the first surface: what that gets straight from the projector."""
    lamps_stopped: Any
    """Likewise straight from lamps and from outside the scene."""


@dataclass
class _Path:
    """Where paths are, and what they have brought so far."""

    ray: Any
    light: PathLight
    beta: Any
    """What the light of the next vertex still counts."""
    active: Any
    vertex: Any
    """Number of the vertex that the ray meets, from 0."""
    pdf: Any
    """Density of the ray's direction over solid angle [1/sr]."""
    diffused: Any
    """A vertex was Lambertian."""
    spread: Any
    """Solid angle between the samples of the lobes so far [sr]."""


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
    smooth: SmoothRadiance | None = None,
) -> PathLight:
    """Radiance along `ray` from the projector and from the lamps.

    max_depth: surface vertices of a path at the most. first_vertex: number of the vertex that `ray` meets, > 0 where
    the path's earlier vertices are the caller's and Lambertian: then lamps met directly count nothing (the caller
    connected them) and dots are looked up with the footprint of a cosine lobe's sample.
    smooth: what is known already of the light that Lambertian surfaces send out, the dots' own light left out. A path
    that meets such a place takes it from there and ends.
    """
    mi = backend.mitsuba()
    import drjit as dr

    scene, n, closed = world.scene, dr.width(pixel), world.source.ambient_radiance == 0

    def vertex(path: _Path) -> tuple[_Path]:
        ray, met, beta, i = path.ray, path.light, path.beta, path.vertex
        si = scene.ray_intersect(ray, mi.RayFlags.All, coherent=i == 0, active=path.active)
        hit = path.active & si.is_valid()
        body = world.body(si)
        arriving = light_met(world, si, ray, body, path.pdf, i, path.diffused)
        met.lamps += dr.select(path.active, beta * arriving, 0)
        # A path that stopped at vertex 0 has seen in it the lamps that its ray meets next.
        met.lamps_stopped = dr.select(i <= 1, met.lamps, met.lamps_stopped)
        glossy, albedo = world.is_glossy(body), dr.gather(mi.Float, world.albedo_of_body, body, path.active)
        scattering = hit & (i < max_depth) & (body < FIRST_LAMP)
        connected = scattering & ~(path.diffused & glossy)
        known, stopped = mi.Bool(False), mi.Float(0)
        if smooth is not None:
            known, reflected = smooth(si, ray, body, scattering & ~glossy)
            met.projector += dr.select(known, beta * reflected.x, 0)
            met.lamps += dr.select(known, beta * (reflected.y + reflected.z), 0)
            # In open surroundings most of the light that comes by way of anything comes from outside.
            stopped = dr.select(known, beta * (reflected.z if closed else reflected.y + reflected.z), 0)

        # Where light may come from: the projector, one point on each lamp.
        dimension = DIMENSIONS_PIXEL + DIMENSIONS_VERTEX * i
        u = [samples.uniform(sample, pixel, dimension + k, path.active) for k in range(DIMENSIONS_VERTEX)]
        towards, distance2 = light.connection(si.p)
        links = [lamp.connection(si.p, u[2], u[3]) for lamp in world.lamps]
        directions = [si.to_local(towards), *(si.to_local(direction) for _, direction, _ in links)]
        values, onwards, pdf, weight = _scatter(
            si, world.bsdf(body), directions, u[4], mi.Point2f(u[0], u[1]), connected, scattering & ~known, albedo
        )

        footprint = _footprint(si, ray, towards, distance2, path.spread) if filtered else mi.Float(0)
        f_cos, _ = values[0]
        s, cos_axis = light.white_wall_radiance(-towards, footprint, connected)
        lit = connected & (f_cos > 0) & (s > 0)
        lit &= ~scene.ray_test(si.spawn_ray_to(light.position), coherent=i == 0, active=lit)
        irradiance = dr.pi * s / fall_off(cos_axis, distance2)
        from_projector = dr.select(lit, beta * f_cos * irradiance, 0)

        place, arriving = _chosen_lamp(world, links, values[1:], glossy, u[5])
        lit = connected & ~known & (arriving > 0)
        lit &= ~scene.ray_test(si.spawn_ray_to(place), coherent=i == 0, active=lit)
        from_lamps = dr.select(lit, beta * arriving, 0)

        met.projector += from_projector
        met.lamps += from_lamps
        met.projector_stopped += dr.select(i == 0, from_projector, 0)
        met.lamps_stopped += dr.select(i == 0, from_lamps + stopped, 0)
        diffused = path.diffused | ~glossy
        # After the last vertex a path may still meet what was not connected: a lamp seen in metal, the surroundings.
        useful = (i + 1 < max_depth) | ~diffused if closed else mi.Bool(True)
        beta = beta * weight
        active = scattering & ~known & (pdf > 0) & (beta > 0) & useful
        spread = path.spread + dr.rcp(samples.n * dr.maximum(pdf, 1e-6))
        return (_Path(si.spawn_ray(si.to_world(onwards)), met, beta, active, i + 1, pdf, diffused, spread),)

    start = _Path(
        ray,
        PathLight(*(dr.zeros(mi.Float, n) for _ in range(4))),
        dr.full(mi.Float, 1, n),
        dr.full(mi.Bool, True, n),
        dr.full(mi.UInt32, first_vertex, n),
        dr.zeros(mi.Float, n),
        dr.full(mi.Bool, first_vertex > 0, n),
        dr.full(mi.Float, np.pi / samples.n if first_vertex else 0, n),
    )
    (end,) = dr.while_loop((start,), lambda path: path.active, vertex)
    return end.light


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


def _chosen_lamp(
    world: LoadedScene, links: list[Any], values: list[tuple[Any, Any]], glossy: Any, u: Any
) -> tuple[Any, Any]:
    """A point on one of the lamps and what all of them bring if nothing hides it.

    One is drawn in proportion to what it brings unhidden (resampled importance sampling: Talbot et al. 2005), so that
    one shadow ray serves all lamps and only their visibility is left to chance.
    """
    mi = backend.mitsuba()
    import drjit as dr

    place, total, bounds = mi.Point3f(0), mi.Float(0), []
    for lamp, (_, _, density), (f_cos, f_pdf) in zip(world.lamps, links, values, strict=True):
        weight_over_density = density / (dr.square(density) + dr.select(glossy, dr.square(f_pdf), 0))
        bounds.append(total)
        total = total + dr.select((f_cos > 0) & (density > 0), f_cos * lamp.radiance * weight_over_density, 0)
    for bound, (candidate, _, _) in zip(bounds, links, strict=True):
        place = dr.select(u * total >= bound, candidate, place)
    return place, total


def _scatter(
    si: Any, bsdf: Any, directions: list[Any], u: Any, v: Any, connected: Any, scattering: Any, albedo: Any
) -> tuple[list[tuple[Any, Any]], Any, Any, Any]:
    """All that a vertex asks of its surface: one dynamic call for the glossy ones, a formula for the Lambertian ones.

    Surfaces look alike from both sides (user meshes may be open or turned). bsdf: null where they are Lambertian.
    albedo: of the Lambertian surfaces, 0 = glossy. Returns (value times cosine, density) for each local direction of
    light, and a sampled local direction with its density and its weight.
    """
    mi = backend.mitsuba()
    import drjit as dr

    def turned(w):
        return mi.Vector3f(w.x, w.y, dr.mulsign(w.z, side))

    def ask(bsdf, si, directions, u, v, connected, scattering):
        pairs = [bsdf.eval_pdf(context, si, wo, connected) for wo in directions]
        sampled, weight = bsdf.sample(context, si, u, v, scattering)
        return [(value.x, pdf) for value, pdf in pairs], sampled.wo, sampled.pdf, weight.x

    context, side, matte = mi.BSDFContext(), mi.Float(si.wi.z), albedo > 0
    upper = mi.SurfaceInteraction3f(si)
    upper.wi = turned(si.wi)
    directions = [turned(direction) for direction in directions]
    glossy = dr.dispatch(bsdf, ask, upper, directions, u, v, connected & ~matte, scattering & ~matte)
    lobes = [dr.inv_pi * dr.maximum(direction.z, 0) for direction in directions]
    upwards = mi.warp.square_to_cosine_hemisphere(v)
    values = [
        (dr.select(matte, albedo * lobe, value), dr.select(matte, lobe, pdf))
        for lobe, (value, pdf) in zip(lobes, glossy[0], strict=True)
    ]
    onwards = turned(dr.select(matte, upwards, glossy[1]))
    return values, onwards, dr.select(matte, dr.inv_pi * upwards.z, glossy[2]), dr.select(matte, albedo, glossy[3])


def _footprint(si: Any, ray: Any, towards: Any, distance2: Any, spread: Any) -> Any:
    """Blur of the dots for a path whose samples lie `spread` [sr] apart, in the plane at 1 m before the projector."""
    import drjit as dr

    cos_here = dr.maximum(dr.abs(dr.dot(si.n, towards)), 1e-3)
    cos_path = dr.maximum(dr.abs(dr.dot(si.n, ray.d)), 1e-2)
    area = spread * dr.square(si.t) / cos_path
    return dr.select(si.is_valid(), FOOTPRINT_SIGMA * dr.sqrt(area * cos_here / distance2), 0)
