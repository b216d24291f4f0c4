"""Light that varies slowly over a Lambertian surface: what lamps bring, and what comes by way of other surfaces.

It is computed at every n-th pixel and interpolated within each surface (the idea of irradiance caching: Ward,
Rubinstein and Clear 1988). It looks alike from everywhere, so what one imager knows of it serves the other imager too,
and the light paths that come from metal to a place that the imager sees.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32

from render.light.first_surface import FirstSurface
from render.light.paths import trace_paths
from render.light.projector import ProjectorLight
from render.light.sampling import SampleSet, Sampling, sample_means
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.pixel_rays import Imager
from render.world.surface import SAME_SURFACE_COSINE, SurfaceMap

REACH_PX = 4.0
"""How far from the point behind a pixel's centre that pixel's light is good for [px at the point's depth]. Choice: half
the diagonal of a pixel, on surfaces that are seen at up to 80 deg from their normal."""


@dataclass(frozen=True, eq=False)
class SmoothLight:
    """Radiance of the Lambertian surfaces that one imager sees, the light of the dots themselves left out.

    It is taken as the same in all directions and as varying slowly within a surface: computed at every n-th pixel and
    interpolated (irradiance caching: Ward, Rubinstein and Clear 1988). Edges of lamp shadows are as coarse as that. 0
    on all other surfaces.
    """

    imager: Imager
    surface: SurfaceMap
    lamps: Float32[np.ndarray, "1 h w"]
    """Of the lamps, without detours [W m^-2 sr^-1]."""
    indirect: Float32[np.ndarray, "2 h w"]
    """By way of other surfaces: the projector's light, and the lamps' and surroundings' [W m^-2 sr^-1]."""

    @property
    def layers(self) -> Float32[np.ndarray, "2 h w"]:
        """Of the projector's and of the ambient light [W m^-2 sr^-1]."""
        return np.stack([self.indirect[0], self.indirect[1] + self.lamps[0]])

    @cached_property
    def _device(self) -> tuple[Any, Any, Any, Any]:
        """Position, normal, body and (lamps, indirect of the projector, indirect ambient) of each pixel."""
        mi = backend.mitsuba()
        import drjit as dr

        channels = np.concatenate([self.lamps, self.indirect]).reshape(3, -1)
        arrays = (
            mi.Float(self.surface.position.ravel()),
            mi.Float(self.surface.normal.ravel()),
            mi.UInt32(self.surface.body.ravel().astype(np.uint32)),
            mi.Float(np.ascontiguousarray(channels.T).ravel()),
        )
        dr.eval(arrays)
        return arrays

    def at(self, position: Any, normal: Any, body: Any, active: Any) -> tuple[Any, Any]:
        """Where the imager sees these points (Bool), and there lamps, indirect projector and indirect ambient light."""
        mi = backend.mitsuba()
        import drjit as dr

        positions, normals, bodies, channels = self._device
        height, width = self.surface.body.shape
        u, v, z = self.imager.project(position)
        column, row = mi.Int32(dr.round(u)), mi.Int32(dr.round(v))
        seen = active & (z > 0) & (column >= 0) & (column < width) & (row >= 0) & (row < height)
        pixel = mi.UInt32(row * width + column)
        seen &= dr.gather(mi.UInt32, bodies, pixel, seen) == body
        offset = dr.gather(mi.Point3f, positions, pixel, seen) - position
        seen &= dr.squared_norm(offset) < dr.square(REACH_PX * z / self.imager.calibration[0])
        seen &= dr.dot(dr.gather(mi.Normal3f, normals, pixel, seen), normal) > SAME_SURFACE_COSINE
        return seen, dr.gather(mi.Vector3f, channels, pixel, seen)

    def met(self, si: Any, ray: Any, body: Any, active: Any) -> tuple[Any, Any]:
        """`light_paths.SmoothRadiance` of where rays meet a place that the imager sees."""
        mi = backend.mitsuba()
        import drjit as dr

        normal = dr.mulsign(si.sh_frame.n, -dr.dot(si.n, ray.d))
        seen, radiance = self.at(si.p, normal, body, active)
        return seen, mi.Vector3f(radiance.y, radiance.z, radiance.x)

    def lamps_at(self, points: SurfaceMap) -> tuple[Bool[np.ndarray, "p"], Float32[np.ndarray, "p"]]:
        """Where the imager sees the points of another map (flattened), and there the lamps' light."""
        mi = backend.mitsuba()
        import drjit as dr

        position, normal = (
            mi.Point3f(np.ascontiguousarray(a.reshape(-1, 3).T)) for a in (points.position, points.normal)
        )
        body = mi.UInt32(points.body.ravel().astype(np.uint32))
        seen, radiance = self.at(position, mi.Normal3f(normal), body, mi.Bool(True))
        dr.eval(seen, radiance.x)
        return seen.numpy().astype(bool), radiance.x.numpy()


def smooth_light(
    world: LoadedScene, first: FirstSurface, sampling: Sampling, seed: int, known: SmoothLight | None = None
) -> SmoothLight:
    """Compute it for all that an imager sees, by the same sampling as `known`, what another imager knows of it.

    Only the lamps' light is taken from there: interpolated twice, the far coarser indirect light would lose.
    """
    lamps = _light_of_lamps(world, first, sampling, seed, known)
    if sampling.max_depth < 2 and world.source.ambient_radiance == 0:  # one vertex, and nothing outside to shine
        by_others = np.zeros((2, *first.shape), np.float32)
    else:
        coarse = first.surface.every(sampling.indirect_stride_px)
        wanted = np.flatnonzero(world.albedo_of_body.numpy()[coarse.body.ravel()] > 0)
        fields = np.zeros((2, coarse.body.size), np.float32)
        if len(wanted):
            fields[:, wanted] = _indirect_light(world, first.light, coarse.points(wanted), sampling, seed)
        by_others = first.surface.interpolated(fields.reshape(2, *coarse.body.shape), sampling.indirect_stride_px)
    return SmoothLight(first.imager, first.surface, lamps, by_others)


def _light_of_lamps(
    world: LoadedScene, first: FirstSurface, sampling: Sampling, seed: int, known: SmoothLight | None
) -> Float32[np.ndarray, "1 h w"]:
    """At every pixel from that of one pixel in some.

    Taken over where it was computed for another scene of this geometry and the body's albedo is the same, looked up
    where the other imager knows it, else computed.
    """
    coarse = first.surface.every(sampling.lamp_stride_px)
    albedo = world.albedo_of_body.numpy()[coarse.body.ravel()]
    light, wanted = np.zeros(albedo.shape, np.float32), albedo > 0
    how = (sampling.lamp_stride_px, sampling.lamp_points, seed)
    if how in first.lamp_light:
        albedo_before, light_before = first.lamp_light[how]
        same = wanted & (albedo == albedo_before)
        light[same] = light_before[same]
        wanted &= ~same
    if known is not None and wanted.any():
        seen, lamps = known.lamps_at(coarse)
        seen &= wanted
        light[seen] = lamps[seen]
        wanted &= ~seen
    numbers = np.flatnonzero(wanted)
    if len(numbers):
        light[numbers] = _lamp_light(world, coarse.points(numbers), sampling, seed)[0]
    first.lamp_light[how] = albedo, light
    return first.surface.interpolated(light.reshape(1, *coarse.body.shape), sampling.lamp_stride_px)


def _lamp_light(world: LoadedScene, points: SurfaceMap, sampling: Sampling, seed: int) -> Float32[np.ndarray, "1 p"]:
    """Light of the lamps after one Lambertian reflection."""
    mi = backend.mitsuba()
    import drjit as dr

    n = sampling.lamp_points
    samples = SampleSet.sobol(n, 1, seed=seed)
    si, point, sample, albedo = _samples_at(world, points, n)
    radiance = dr.zeros(mi.Float, dr.width(point))
    for lamp in world.lamps:
        place, direction, density = lamp.connection(si.p, *(samples.uniform(sample, point, d) for d in range(2)))
        cosine = dr.dot(si.n, direction)
        lit = (cosine > 0) & (density > 0)
        lit &= ~world.scene.ray_test(si.spawn_ray_to(place), coherent=True, active=lit)
        radiance += dr.select(lit, albedo * dr.inv_pi * cosine * lamp.radiance / density, 0)
    return sample_means([radiance], n)


def _indirect_light(
    world: LoadedScene, light: ProjectorLight, points: SurfaceMap, sampling: Sampling, seed: int
) -> Float32[np.ndarray, "2 p"]:
    """Light from the surroundings or by way of other surfaces after one more, Lambertian, reflection; both layers."""
    mi = backend.mitsuba()

    n = sampling.indirect_directions
    samples = SampleSet.sobol(n, sampling.max_depth, seed=seed)
    si, point, sample, albedo = _samples_at(world, points, n)
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
        sampling.max_depth,
        first_vertex=1,
        filtered=sampling.filtered,
    )
    return sample_means([paths.projector * albedo, paths.lamps * albedo], n)


def _samples_at(world: LoadedScene, points: SurfaceMap, n: int) -> tuple[Any, Any, Any, Any]:
    """Interactions at the points, n consecutive ones for each, with the indices of point and sample, and albedo."""
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
    body = dr.gather(mi.UInt32, mi.UInt32(points.body.ravel().astype(np.uint32)), point)
    return si, point, sample, dr.gather(mi.Float, world.albedo_of_body, body)
