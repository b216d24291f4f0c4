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

from render.light.projector import ProjectorLight, fall_off
from render.light.sampling import DIMENSIONS_PIXEL, DIMENSIONS_VERTEX, SampleSet
from render.light.scatter import scatter
from render.world import backend
from render.world.mitsuba_scene import FIRST_LAMP, LoadedScene

FOOTPRINT_SIGMA = 0.5
"""Blur of the dots behind a glossy vertex, in units of the distance between samples (choice: the usual width of a
Gaussian reconstruction filter)."""


SmoothRadiance = Callable[[Any, Any, Any, Any], tuple[Any, Any]]
"""Of interactions, rays, bodies and which are asked: where it is known, and there a Vector3f [W m^-2 sr^-1]: the
radiance of the projector's light and of the ambient light that came by way of other surfaces, and that of the lamps'
own light."""


@dataclass
class PathLight:
    """What light paths bring, one value a path [W m^-2 sr^-1]; Dr.Jit Floats.

    `projector` and `lamps` hold the light of whole paths, the latter with what comes from outside the scene.
    """

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

    n = dr.width(pixel)
    tracer = _Tracer(world, world.bsdf_of_body, light, pixel, sample, samples, max_depth, filtered, smooth)
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
    (end,) = dr.while_loop((start,), lambda path: path.active, lambda path: (tracer.next_vertex(path),))
    return end.light


@dataclass(frozen=True, eq=False)
class _Vertex:
    """Where paths have arrived."""

    si: Any
    body: Any
    """As `LoadedScene.body` counts."""
    glossy: Any
    albedo: Any
    """Of Lambertian surfaces, 0 for others."""
    scattering: Any
    """Paths that have met a surface and may have this vertex."""
    connected: Any
    """Those of them that are connected to the projector."""
    known: Any
    """Those whose further light is known, so that they end here."""
    stopped: Any
    """What of it came straight from lamps and from outside the scene [W m^-2 sr^-1]."""


@dataclass(frozen=True, eq=False)
class _Tracer:
    """The arguments of `trace_paths`, and what happens at every vertex."""

    world: LoadedScene
    bsdfs: Any
    """`LoadedScene.bsdf_of_body`."""
    light: ProjectorLight
    pixel: Any
    sample: Any
    samples: SampleSet
    max_depth: int
    filtered: bool
    smooth: SmoothRadiance | None

    def next_vertex(self, path: _Path) -> _Path:
        """Shoot the paths' rays; connect where they arrive to the lights; draw how they go on."""
        mi = backend.mitsuba()
        import drjit as dr

        here, i = self._arrive(path), path.vertex
        dimension = DIMENSIONS_PIXEL + DIMENSIONS_VERTEX * i
        u = [
            self.samples.uniform(self.sample, self.pixel, dimension + k, path.active) for k in range(DIMENSIONS_VERTEX)
        ]
        # Where light may come from: the projector, one point on each lamp.
        towards, distance2 = self.light.connection(here.si.p)
        links = [lamp.connection(here.si.p, u[2], u[3]) for lamp in self.world.lamps]
        directions = [here.si.to_local(w) for w in (towards, *(direction for _, direction, _ in links))]
        bsdf, going_on = dr.gather(mi.BSDFPtr, self.bsdfs, here.body), here.scattering & ~here.known
        values, onwards, pdf, weight = scatter(
            here.si, bsdf, here.albedo, directions, here.connected, u[4], mi.Point2f(u[0], u[1]), going_on
        )

        from_projector = path.beta * self._projector_light(here, path, values[0][0], towards, distance2)
        from_lamps = path.beta * self._lamp_light(here, links, values[1:], u[5], i)
        met = path.light
        met.projector += from_projector
        met.lamps += from_lamps
        met.projector_stopped += dr.select(i == 0, from_projector, 0)
        met.lamps_stopped += dr.select(i == 0, from_lamps + here.stopped, 0)

        diffused, beta = path.diffused | ~here.glossy, path.beta * weight
        # After the last vertex a path may still meet what was not connected: a lamp seen in metal, the surroundings.
        useful = (i + 1 < self.max_depth) | ~diffused if self._closed else mi.Bool(True)
        active = going_on & (pdf > 0) & (beta > 0) & useful
        spread = path.spread + dr.rcp(self.samples.n * dr.maximum(pdf, 1e-6))
        return _Path(here.si.spawn_ray(here.si.to_world(onwards)), met, beta, active, i + 1, pdf, diffused, spread)

    @property
    def _closed(self) -> bool:
        """No light comes from outside the scene."""
        return self.world.source.ambient_radiance == 0

    def _arrive(self, path: _Path) -> _Vertex:
        """The paths' next vertex. What their rays bring is added to their light."""
        mi = backend.mitsuba()
        import drjit as dr

        i, met = path.vertex, path.light
        si = self.world.scene.ray_intersect(path.ray, mi.RayFlags.All, coherent=i == 0, active=path.active)
        body = self.world.body(si)
        arriving = light_met(self.world, si, path.ray, body, path.pdf, i, path.diffused)
        met.lamps += dr.select(path.active, path.beta * arriving, 0)
        # A path that stopped at vertex 0 has seen in it the lamps that its ray meets next.
        met.lamps_stopped = dr.select(i <= 1, met.lamps, met.lamps_stopped)
        glossy = self.world.is_glossy(body)
        scattering = path.active & si.is_valid() & (i < self.max_depth) & (body < FIRST_LAMP)
        known, stopped = mi.Bool(False), mi.Float(0)
        if self.smooth is not None:
            known, reflected = self.smooth(si, path.ray, body, scattering & ~glossy)
            met.projector += dr.select(known, path.beta * reflected.x, 0)
            met.lamps += dr.select(known, path.beta * (reflected.y + reflected.z), 0)
            # In open surroundings most of the light that comes by way of anything comes from outside.
            straight = reflected.z if self._closed else reflected.y + reflected.z
            stopped = dr.select(known, path.beta * straight, 0)
        albedo = dr.gather(mi.Float, self.world.albedo_of_body, body, path.active)
        return _Vertex(si, body, glossy, albedo, scattering, scattering & ~(path.diffused & glossy), known, stopped)

    def _projector_light(self, here: _Vertex, path: _Path, f_cos: Any, towards: Any, distance2: Any) -> Any:
        """What the projector's dots send on along the path from here [W m^-2 sr^-1]."""
        mi = backend.mitsuba()
        import drjit as dr

        footprint = mi.Float(0)
        if self.filtered:
            footprint = _footprint(here.si, path.ray, towards, distance2, path.spread)
        s, cos_axis = self.light.white_wall_radiance(-towards, footprint, here.connected)
        lit = here.connected & (f_cos > 0) & (s > 0)
        ray = here.si.spawn_ray_to(self.light.position)
        lit &= ~self.world.scene.ray_test(ray, coherent=path.vertex == 0, active=lit)
        return dr.select(lit, f_cos * dr.pi * s / fall_off(cos_axis, distance2), 0)

    def _lamp_light(self, here: _Vertex, links: list[Any], values: list[tuple[Any, Any]], u: Any, i: Any) -> Any:
        """What the lamps send on along the path from here, beyond what is known [W m^-2 sr^-1]."""
        import drjit as dr

        place, arriving = _chosen_lamp(self.world, links, values, here.glossy, u)
        lit = here.connected & ~here.known & (arriving > 0)
        lit &= ~self.world.scene.ray_test(here.si.spawn_ray_to(place), coherent=i == 0, active=lit)
        return dr.select(lit, arriving, 0)


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


def _footprint(si: Any, ray: Any, towards: Any, distance2: Any, spread: Any) -> Any:
    """Blur of the dots for a path whose samples lie `spread` [sr] apart, in the plane at 1 m before the projector."""
    import drjit as dr

    cos_here = dr.maximum(dr.abs(dr.dot(si.n, towards)), 1e-3)
    cos_path = dr.maximum(dr.abs(dr.dot(si.n, ray.d)), 1e-2)
    area = spread * dr.square(si.t) / cos_path
    return dr.select(si.is_valid(), FOOTPRINT_SIGMA * dr.sqrt(area * cos_here / distance2), 0)
