"""Light paths from an imager through the scene: what the projector and the lamps add at every vertex.

Projector and ambient light are carried side by side along the same path, each with the reflectances of its own band. At
each vertex the projector and one point on a lamp are connected; the path then follows a sample of the BSDF. Metal's
BSDF samples that hit a lamp are weighted against the lamp connections by the power heuristic (Veach 1997, ch. 9). Paths
end after a few vertices, sooner once one was Lambertian; what the last one would still get by way of others comes from
radiosity between patches (`render.world.radiosity`), so that no light is cut off.

Two choices keep Monte-Carlo error below the imager's noise at few samples:
- every pixel uses the *same* low-discrepancy sample set, so error varies over the image as slowly as the scene does,
  instead of appearing as noise between neighbours that a census transform would see;
- behind a glossy vertex, the dots are looked up blurred to the footprint of one sample (as texture filtering by ray
  differentials does: Igehy 1999), so that N samples of a lobe stand for the whole lobe and not for N dots.

Light that a sharp lobe throws onto a Lambertian surface (caustics) is found too rarely by such paths, and what is found
is blotches: it comes from the other end, `render.light.caustics`, and is looked up here.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from render.light.lamp_light import chosen_lamp, light_met
from render.light.polarisation import Polarisation
from render.light.projector import ProjectorLight, dots_footprint, fall_off
from render.light.sampling import DIMENSIONS_PIXEL, DIMENSIONS_VERTEX, SampleSet, Sampling
from render.light.scatter import Scattered, scatter
from render.light.seen import SeenLight
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.radiosity import Closing
from render.world.reflectances import NEEDLE
from render.world.scene_geometry import FIRST_LAMP

BEHIND_DIFFUSE = 1
"""Vertices that a path from a glossy surface has behind its first Lambertian one before radiosity closes it. Choice: as
mirrored light then comes from three surfaces one after another, as that of a pixel that sees a Lambertian one does."""


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
    beta: tuple[Any, Any]
    """What the light of the next vertex still counts, at 850 nm and in the lamps' band."""
    active: Any
    vertex: Any
    """Number of the vertex that the ray meets, from 0."""
    pdf: Any
    """Density of the ray's direction over solid angle [1/sr]."""
    left: Any
    """Vertices that it may still have."""
    lamps_known: Any
    """What lamps the ray meets is counted already: by a connection from a Lambertian vertex, or as a caustic."""
    diffused: Any
    """Some vertex was Lambertian."""
    photons_found: Any
    """The last Lambertian vertex was where photons are counted, so that caustics there are known."""
    spread: Any
    """Solid angle between the samples of the lobes so far [sr]."""
    rows: Any = ()
    """`StokesRows`: what the next vertex's light counts by its polarisation; empty where that is left out."""


def trace_paths(
    world: LoadedScene,
    light: ProjectorLight,
    ray: Any,
    pixel: Any,
    sample: Any,
    samples: SampleSet,
    sampling: Sampling,
    *,
    first_vertex: int = 0,
    seen: SeenLight | None = None,
    closing: Closing | None = None,
    films: Polarisation | None = None,
) -> PathLight:
    """Radiance along `ray` from the projector and from the lamps.

    sampling: how far paths go, and whether caustics are left to photons. first_vertex: number of the vertex that `ray`
    meets, > 0 where the path's earlier vertices are the caller's and Lambertian: then lamps met directly count nothing
    (the caller connected them) and dots are looked up with the footprint of a cosine lobe's sample.
    seen: what is known already of the light on Lambertian surfaces, the dots' own light left out. A path that meets
    such a place takes it from there, and ends if all of it is known. closing: what paths that end at
    `Sampling.max_depth` would have brought from there on; None = nothing. films: polarisers, if light is polarised.
    """
    mi = backend.mitsuba()
    import drjit as dr

    n = dr.width(pixel)
    if world.reflectances.has_others:
        _ = world.reflectances.bsdfs
    tracer = _Tracer(world, light, pixel, sample, samples, sampling, seen, closing, films)
    yes, behind_lambertian = dr.full(mi.Bool, True, n), dr.full(mi.Bool, first_vertex > 0, n)
    start = _Path(
        ray,
        PathLight(*(dr.zeros(mi.Float, n) for _ in range(4))),
        (dr.full(mi.Float, 1, n), dr.full(mi.Float, 1, n)),
        yes,
        dr.full(mi.UInt32, first_vertex, n),
        dr.zeros(mi.Float, n),
        dr.full(mi.UInt32, sampling.max_depth - first_vertex, n),
        lamps_known=behind_lambertian,
        diffused=mi.Bool(behind_lambertian),
        photons_found=mi.Bool(behind_lambertian),
        spread=dr.full(mi.Float, np.pi / samples.n if first_vertex else 0, n),
        rows=() if films is None else films.forgotten(ray.d) if first_vertex else films.through_film(ray.d),
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
    scattering: Any
    """Paths that have met a surface and may have this vertex."""
    connected: Any
    """Those of them that are connected to projector and lamps: all but those whose way is a caustic's."""
    photons_count: Any
    """Whether photons that land here are counted: where the light of seen places is known, at those alone."""
    known: Any
    """Those whose further light is known, so that they end here."""
    stopped: Any
    """What of it came straight from lamps and from outside the scene [W m^-2 sr^-1]."""


@dataclass(frozen=True, eq=False)
class _Tracer:
    """The arguments of `trace_paths`, and what happens at every vertex."""

    world: LoadedScene
    light: ProjectorLight
    pixel: Any
    sample: Any
    samples: SampleSet
    sampling: Sampling
    seen: SeenLight | None
    closing: Closing | None
    films: Polarisation | None

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
        directions = [here.si.to_local(direction) for _, direction, _ in links]
        going_on = here.scattering & ~here.known
        lobes = scatter(
            here.si,
            self.world.reflectances,
            here.body,
            here.si.to_local(towards),
            directions,
            u[4],
            mi.Point2f(u[0], u[1]),
            here.connected,
            going_on,
        )
        rows = path.rows
        if self.films is not None:
            lobes, rows = self.films.polarised(rows, here.si, here.body, towards, [link[1] for link in links], lobes)
        from_projector = path.beta[0] * self._projector_light(here, path, lobes.to_projector, towards, distance2)
        from_lamps = path.beta[1] * self._lamp_light(here, links, lobes.to_lamps, u[5], i)
        met = path.light
        met.projector += from_projector
        met.lamps += from_lamps
        met.projector_stopped += dr.select(i == 0, from_projector, 0)
        met.lamps_stopped += dr.select(i == 0, from_lamps + here.stopped, 0)
        return self._continued(path, here, lobes, rows, going_on)

    def _continued(self, path: _Path, here: _Vertex, lobes: Scattered, rows: Any, going_on: Any) -> _Path:
        """The paths with the rays that were drawn; what those that end here leave out is added to their light."""
        mi = backend.mitsuba()
        import drjit as dr

        met = path.light
        beta = (path.beta[0] * lobes.weight[0], path.beta[1] * lobes.weight[1])
        left = path.left - dr.select(here.scattering, 1, 0)
        if self.closing is not None:
            left = dr.select(path.diffused | here.glossy, left, dr.minimum(left, BEHIND_DIFFUSE))
        # After the last vertex a path may still meet what was not connected: a lamp seen in metal, the surroundings.
        useful = (left > 0) | (here.glossy & here.connected) if self._closed else mi.Bool(True)
        active = going_on & (lobes.pdf > 0) & (dr.maximum(*beta) > 0) & useful
        if self.closing is not None:
            rest = self.closing.at(here.si, going_on & (left == 0))
            met.projector += beta[0] * rest[0]
            met.lamps += beta[1] * rest[1]
        spread = path.spread + dr.rcp(self.samples.n * dr.maximum(lobes.pdf, 1e-6))
        onwards = here.si.spawn_ray(here.si.to_world(lobes.onwards))
        diffused = path.diffused | ~here.glossy
        photons_found = dr.select(here.glossy, path.photons_found, here.photons_count)
        lamps_known = ~here.glossy | ~here.connected
        return _Path(
            onwards,
            met,
            beta,
            active,
            path.vertex + 1,
            lobes.pdf,
            left,
            lamps_known,
            diffused,
            photons_found,
            spread,
            rows,
        )

    @property
    def _closed(self) -> bool:
        """No light comes from outside the scene."""
        return self.world.source.ambient_radiance == 0

    def _arrive(self, path: _Path) -> _Vertex:
        """The paths' next vertex. What their rays bring is added to their light."""
        mi = backend.mitsuba()
        import drjit as dr

        i, met, surfaces = path.vertex, path.light, self.world.reflectances
        si = self.world.scene.ray_intersect(path.ray, mi.RayFlags.All, coherent=i == 0, active=path.active)
        body = self.world.body(si)
        films = self.films and (self.films, path.rows)
        arriving = light_met(self.world, si, path.ray, body, path.pdf, i, path.lamps_known, films)
        met.lamps += dr.select(path.active, path.beta[1] * arriving, 0)
        # A path that stopped at vertex 0 has seen in it the lamps that its ray meets next.
        met.lamps_stopped = dr.select(i <= 1, met.lamps, met.lamps_stopped)
        glossy = self.world.is_glossy(body)
        scattering = path.active & si.is_valid() & (path.left > 0) & (body < FIRST_LAMP)
        known, stopped, photons_count = mi.Bool(False), mi.Float(0), mi.Bool(True)
        if self.seen is not None:
            normal = dr.mulsign(si.sh_frame.n, -dr.dot(si.n, path.ray.d))
            there, light = self.seen.at(si.p, normal, body, scattering & ~glossy)
            albedo = [dr.gather(mi.Float, a, body, there) for a in surfaces.albedo]
            met.projector += dr.select(there, path.beta[0] * albedo[0] * light.projector, 0)
            met.lamps += dr.select(there, path.beta[1] * albedo[1] * (light.lamps + light.ambient), 0)
            # In open surroundings most of the light that comes by way of anything comes from outside.
            straight = light.lamps if self._closed else light.lamps + light.ambient
            stopped = dr.select(there, path.beta[1] * albedo[1] * straight, 0)
            known = there if self.seen.complete else known
            photons_count = there
        connected = scattering
        if self.sampling.photons:
            sharp = dr.gather(mi.UInt32, surfaces.sharp, body, scattering)
            connected = scattering & ~((path.photons_found & (sharp > 0)) | (path.diffused & (sharp == NEEDLE)))
        return _Vertex(si, body, glossy, scattering, connected, photons_count, known, stopped)

    def _projector_light(self, here: _Vertex, path: _Path, f_cos: Any, towards: Any, distance2: Any) -> Any:
        """What the projector's dots send on along the path from here [W m^-2 sr^-1]."""
        mi = backend.mitsuba()
        import drjit as dr

        footprint = mi.Float(0)
        if self.sampling.filtered:
            footprint = dots_footprint(here.si, path.ray, towards, distance2, path.spread)
        s, cos_axis = self.light.white_wall_radiance(-towards, footprint, here.connected)
        lit = here.connected & (f_cos > 0) & (s > 0)
        ray = here.si.spawn_ray_to(self.light.position)
        lit &= ~self.world.scene.ray_test(ray, coherent=path.vertex == 0, active=lit)
        return dr.select(lit, f_cos * dr.pi * s / fall_off(cos_axis, distance2), 0)

    def _lamp_light(self, here: _Vertex, links: list[Any], values: list[tuple[Any, Any]], u: Any, i: Any) -> Any:
        """What the lamps send on along the path from here, beyond what is known [W m^-2 sr^-1]."""
        import drjit as dr

        place, arriving = chosen_lamp(self.world, links, values, here.glossy, u)
        lit = here.connected & ~here.known & (arriving > 0)
        lit &= ~self.world.scene.ray_test(here.si.spawn_ray_to(place), coherent=i == 0, active=lit)
        return dr.select(lit, arriving, 0)
