"""Light that varies slowly over a Lambertian surface: what lamps bring, and what comes by way of other surfaces.

Irradiance is computed at few pixels and interpolated within each surface (`render.world.interpolation`); each pixel's
own albedo makes radiance of it. It looks alike from everywhere, so it also serves the light paths that come from metal
to a place that the imager sees, and the other imager.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from jaxtyping import Float32

from render.light.first_surface import FirstSurface
from render.light.paths import trace_paths
from render.light.polarisation import Polarisation
from render.light.projector import ProjectorLight
from render.light.sampling import SampleSet, Sampling, sample_means
from render.light.seen import SeenLight, SeenSurface
from render.world import backend
from render.world.interpolation import interpolated
from render.world.mitsuba_scene import LoadedScene
from render.world.radiosity import Closing
from render.world.scene_geometry import FIRST_LAMP
from render.world.surface import SurfaceMap

LAMP_STEEPEST = 0.1
"""Differences of the lamps' light around a pixel, as a share of it, above which the second grid is asked (choice:
bilinear interpolation is then right to some 2 %; edges of lamps' shadows are as coarse as that grid)."""
INDIRECT_STEEPEST = 0.1
"""The same of indirect light, as a share of all light there (choice: some 1 % of all light, about one grey value)."""


def smooth_light(
    world: LoadedScene,
    first: FirstSurface,
    sampling: Sampling,
    seed: int,
    caustics: Float32[np.ndarray, "2 h w"],
    closing: Closing | None,
    other: SeenLight | None = None,
    films: Polarisation | None = None,
) -> SeenLight:
    """Compute it for all that an imager sees.

    caustics: of the projector's and of the lamps' light on what it sees, irradiance over pi [W m^-2 sr^-1]. closing:
    what the paths leave out. other: of another imager at the same moment, from which is taken what that one sees.
    films: polarisers, as in `trace_paths`.
    """
    lamps = light_of_lamps(world, first, sampling, seed, other)
    by_others = np.zeros((2, *first.shape), np.float32)
    if sampling.max_depth > 1 or world.source.ambient_radiance > 0:
        wanted = world.reflectances.is_lambertian[first.surface.body]
        seen = SeenLight(first.seen_surface, caustics, by_others, by_others[0], complete=False)

        def gathered(points: SurfaceMap, stride: int) -> Float32[np.ndarray, "2 p"]:
            widest = stride == sampling.indirect_strides_px[0]
            n = sampling.indirect_directions if widest else sampling.fine_directions
            return _indirect_light(world, first.light, points, n, sampling, seed, seen, closing, films)

        known = None if other is None else (other.where, other.by_others)
        beside = np.stack([first.dots_unhidden, lamps])
        by_others = interpolated(
            first.surface,
            wanted,
            _grids(sampling.indirect_strides_px, INDIRECT_STEEPEST),
            lambda points, stride: _unless_known(known, points, lambda rest: gathered(rest, stride)),
            beside,
        )
    return SeenLight(first.seen_surface, caustics, by_others, lamps, complete=True)


def light_of_lamps(
    world: LoadedScene, first: FirstSurface, sampling: Sampling, seed: int, other: SeenLight | None = None
) -> Float32[np.ndarray, "h w"]:
    """Irradiance over pi at every pixel; one map for all scenes of this geometry. other: as in `smooth_light`."""
    how = (sampling.lamp_strides_px, sampling.lamp_points, seed)
    if how not in first.lamp_light:
        wanted, beside = first.surface.body < FIRST_LAMP, np.zeros((1, *first.shape), np.float32)
        grids = _grids(sampling.lamp_strides_px, LAMP_STEEPEST)
        known = None if other is None else (other.where, other.lamps[None])

        def lit(points: SurfaceMap, _: int) -> Float32[np.ndarray, "1 p"]:
            return _unless_known(known, points, lambda rest: _lamp_light(world, rest, sampling, seed))

        first.lamp_light[how] = interpolated(first.surface, wanted, grids, lit, beside)[0]
    return first.lamp_light[how]


def _unless_known(
    known: tuple[SeenSurface, Float32[np.ndarray, "c h w"]] | None,
    points: SurfaceMap,
    values_at: Callable[[SurfaceMap], Float32[np.ndarray, "c q"]],
) -> Float32[np.ndarray, "c p"]:
    """Values at points: those of a map where its imager sees them, else computed."""
    if known is None:
        return values_at(points)
    where, values = known
    pixel, seen = where.among(points)
    found = values.reshape(len(values), -1)[:, pixel]
    rest = np.flatnonzero(~seen)
    if len(rest):
        found[:, rest] = values_at(points.points(rest))
    return found


def _grids(strides: Sequence[int], steepest: float) -> list[tuple[int, float]]:
    """All but the last two are left where light is steep, those only where a pixel has no point of its own."""
    return [(stride, steepest if k < len(strides) - 2 else np.inf) for k, stride in enumerate(strides)]


def _lamp_light(world: LoadedScene, points: SurfaceMap, sampling: Sampling, seed: int) -> Float32[np.ndarray, "1 p"]:
    """Irradiance over pi that the lamps give."""
    mi = backend.mitsuba()
    import drjit as dr

    n = sampling.lamp_points
    samples = SampleSet.sobol(n, 1, seed=seed)
    si, point, sample = _samples_at(points, n)
    radiance = dr.zeros(mi.Float, dr.width(point))
    for lamp in world.lamps:
        place, direction, density = lamp.connection(si.p, *(samples.uniform(sample, point, d) for d in range(2)))
        cosine = dr.dot(si.n, direction)
        lit = (cosine > 0) & (density > 0)
        lit &= ~world.scene.ray_test(si.spawn_ray_to(place), coherent=True, active=lit)
        radiance += dr.select(lit, dr.inv_pi * cosine * lamp.radiance / density, 0)
    return sample_means([radiance], n)


def _indirect_light(
    world: LoadedScene,
    light: ProjectorLight,
    points: SurfaceMap,
    n: int,
    sampling: Sampling,
    seed: int,
    seen: SeenLight,
    closing: Closing | None,
    films: Polarisation | None,
) -> Float32[np.ndarray, "2 p"]:
    """Irradiance over pi from the surroundings or by way of other surfaces, by n directions; both layers."""
    mi = backend.mitsuba()

    samples = SampleSet.sobol(n, sampling.max_depth, seed=seed)
    si, point, sample = _samples_at(points, n)
    lobe = mi.warp.square_to_cosine_hemisphere(
        mi.Point2f(samples.uniform(sample, point, 0), samples.uniform(sample, point, 1))
    )
    paths = trace_paths(
        world,
        light,
        si.spawn_ray(mi.Frame3f(si.n).to_world(lobe)),
        point,
        sample,
        samples,
        sampling,
        first_vertex=1,
        seen=seen,
        closing=closing,
        films=films,
    )
    return sample_means([paths.projector, paths.lamps], n)


def _samples_at(points: SurfaceMap, n: int) -> tuple[Any, Any, Any]:
    """Interactions at the points, n consecutive ones for each, with the indices of point and sample."""
    mi = backend.mitsuba()
    import drjit as dr

    index = dr.arange(mi.UInt32, points.body.size * n)
    point, sample = index // n, index % n
    position, normal = (
        [dr.gather(mi.Float, mi.Float(np.ascontiguousarray(a[..., k].ravel())), point) for k in range(3)]
        for a in (points.position, points.normal)
    )
    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(index))
    si.t, si.p, si.n = mi.Float(1), mi.Point3f(*position), mi.Normal3f(*normal)
    return si, point, sample
