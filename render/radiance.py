"""Radiance of the projector's and of the ambient light at every pixel of an imager, as two separate layers.

Pixels that see Lambertian surfaces only need few samples: a handful of positions for the dots, while the light of lamps
and other surfaces, which varies slowly over a surface, is computed at every n-th pixel and interpolated within the
surface (the idea of irradiance caching: Ward, Rubinstein and Clear 1988). Pixels that see anything glossy get whole
light paths.
No denoiser: it would invent or erase dots.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Int
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render import backend
from render.light_paths import Imager, SampleSet, light_met, trace_paths
from render.mitsuba_scene import LoadedScene
from render.projector_light import ProjectorLight
from render.surface import SurfaceMap, surface_map

PATHS_PER_LAUNCH = 4_000_000
"""Light paths in one kernel launch, which bounds memory (about 200 B a path)."""


@dataclass(frozen=True)
class Sampling:
    """How many samples are spent where. The defaults are checked against 1024 samples a pixel in `tests/physics`."""

    subpixels: int = 4
    """Positions in a pixel that sees Lambertian surfaces only."""
    lamp_points: int = 16
    """Points on every lamp that light a Lambertian surface."""
    lamp_stride_px: int = 2
    """Distance of the pixels at which that light is computed."""
    glossy_paths: int = 32
    """Paths of a pixel that sees a glossy surface, at first."""
    refined_share: float = 0.25
    """Share of those pixels, the noisiest, that are computed again."""
    refined_paths: int = 128
    """Paths of a pixel that is computed again."""
    indirect_directions: int = 128
    """Directions gathered per interpolation point of the indirect light on Lambertian surfaces."""
    indirect_stride_px: int = 16
    """Distance of these interpolation points."""
    max_depth: int = 3
    """Surface vertices of a path: 1 = direct light only, 3 = two bounces more."""
    filtered: bool = True
    """Look dots behind a glossy vertex up with the footprint of a sample."""
    projector_shadows: bool = True
    """Let things stand in the projector's light. False lifts all its shadows, to see what they cost."""
    whole_paths_everywhere: bool = False
    """Treat every pixel as glossy: the reference."""
    rotated: bool = False
    """Shift every pixel's samples at random instead of sharing them: the reference."""

    def reference(self, paths: int) -> "Sampling":
        """Plain path tracing with independent pixels and sharp dots, to check the defaults against."""
        return replace(
            self, glossy_paths=paths, refined_share=0.0, filtered=False, whole_paths_everywhere=True, rotated=True
        )


@dataclass(frozen=True, eq=False)
class RadianceLayers:
    """One imager's radiance image, apart by source, so that laser power and lamps scale without a new rendering."""

    projector: Float32[np.ndarray, "h w"]
    """At the laser power that the projector light was made with [W m^-2 sr^-1]."""
    ambient: Float32[np.ndarray, "h w"]
    """From lamps and environment [W m^-2 sr^-1]."""


def render_layers(
    world: LoadedScene,
    light: ProjectorLight,
    intrinsics: Intrinsics,
    T_world_imager: RigidTransform,
    sampling: Sampling,
    seed: int = 0,
) -> RadianceLayers:
    """Render both layers as an ideal imager with box-shaped pixels sees them; one seed, one image."""
    imager = Imager.at(T_world_imager, intrinsics)
    shape = (intrinsics.height, intrinsics.width)
    if sampling.whole_paths_everywhere:
        layers, glossy = np.zeros((2, *shape), np.float32), np.ones(shape, bool)
    else:
        layers, glossy = _sharp_light(world, light, imager, shape, sampling, seed)
        surface = surface_map(world, intrinsics, T_world_imager)
        layers[1] += _lamp_light(world, surface, sampling, seed)
        layers += _indirect_light(world, light, surface, sampling, seed)
    pixels, flat = np.flatnonzero(glossy), layers.reshape(2, -1)
    flat[:, pixels], variance = _whole_paths(
        world, light, imager, intrinsics.width, pixels, sampling, sampling.glossy_paths, seed
    )
    noisiest = np.sort(pixels[np.argsort(-variance, kind="stable")[: round(sampling.refined_share * len(pixels))]])
    flat[:, noisiest], _ = _whole_paths(
        world, light, imager, intrinsics.width, noisiest, sampling, sampling.refined_paths, seed
    )
    return RadianceLayers(layers[0], layers[1])


def _sharp_light(
    world: LoadedScene, light: ProjectorLight, imager: Imager, shape: tuple[int, int], sampling: Sampling, seed: int
) -> tuple[Float32[np.ndarray, "2 h w"], Bool[np.ndarray, "h w"]]:
    """The dots on Lambertian surfaces and the lamps that are seen themselves; and which pixels see a glossy surface."""
    mi = backend.mitsuba()
    import drjit as dr

    scene, n = world.scene, sampling.subpixels
    samples = SampleSet.sobol(n, 1, seed=seed)
    index = dr.arange(mi.UInt32, shape[0] * shape[1] * n)
    pixel, sample = index // n, index % n
    row = pixel // shape[1]
    u, v = (samples.uniform(sample, pixel, d) - 0.5 for d in range(2))
    ray = imager.ray(mi.Float(pixel - row * shape[1]) + u, mi.Float(row) + v)
    si = scene.ray_intersect(ray, mi.RayFlags.All, coherent=True)
    body = world.body(si)
    glossy = world.is_glossy(body)
    albedo = dr.gather(mi.Float, world.albedo_of_body, body)

    to_projector = light.position - si.p
    distance2 = dr.maximum(dr.squared_norm(to_projector), 1e-9)
    towards = to_projector * dr.rsqrt(distance2)
    cosine = dr.dot(si.sh_frame.n, towards) * -dr.sign(dr.dot(si.sh_frame.n, ray.d))
    lit = si.is_valid() & (albedo > 0) & (cosine > 0)
    s, cos_axis = light.white_wall_radiance(-towards, mi.Float(0), lit)
    lit &= s > 0
    if sampling.projector_shadows:
        lit &= ~scene.ray_test(si.spawn_ray_to(light.position), coherent=True, active=lit)
    # White-wall radiance s at 1 m means irradiance pi s / z^2 with z = r cos; the Lambertian lobe is albedo / pi.
    from_projector = dr.select(lit, albedo * cosine * s / (dr.maximum(cos_axis**3, 1e-6) * distance2), 0)
    lamps_seen = light_met(world, si, ray, body, mi.Float(0), mi.UInt32(0), mi.Bool(False))

    means = _pixel_means([from_projector, lamps_seen, dr.select(glossy, mi.Float(1), mi.Float(0))], n)
    return means[:2].reshape(2, *shape), means[2].reshape(shape) > 0


def _whole_paths(
    world: LoadedScene,
    light: ProjectorLight,
    imager: Imager,
    width: int,
    pixels: Int[np.ndarray, "p"],
    sampling: Sampling,
    n: int,
    seed: int,
) -> tuple[Float32[np.ndarray, "2 p"], Float32[np.ndarray, "p"]]:
    """Both layers at the given pixels (flat indices) by n full paths each, and the variance of each pixel's paths."""
    mi = backend.mitsuba()
    import drjit as dr

    samples = SampleSet.sobol(n, sampling.max_depth, sampling.rotated, seed)
    moments = np.zeros((3, len(pixels)), np.float32)
    step = max(PATHS_PER_LAUNCH // n, 1)
    for start in range(0, len(pixels), step):
        chosen = mi.UInt32(pixels[start : start + step].astype(np.uint32))
        index = dr.arange(mi.UInt32, dr.width(chosen) * n)
        pixel, sample = dr.gather(mi.UInt32, chosen, index // n), index % n
        row = pixel // dr.opaque(mi.UInt32, width)
        u = mi.Float(pixel - row * width) + samples.uniform(sample, pixel, 0) - 0.5
        v = mi.Float(row) + samples.uniform(sample, pixel, 1) - 0.5
        paths = trace_paths(
            world,
            light,
            imager.ray(u, v),
            pixel,
            sample,
            samples,
            sampling.max_depth,
            filtered=sampling.filtered,
            projector_shadows=sampling.projector_shadows,
        )
        moments[:, start : start + step] = _pixel_means([*paths, dr.square(paths[0] + paths[1])], n)
    layers = moments[:2]
    return layers, moments[2] - np.square(layers.sum(axis=0))


def _lamp_light(world: LoadedScene, surface: SurfaceMap, sampling: Sampling, seed: int) -> Float32[np.ndarray, "h w"]:
    """Light of the lamps after one Lambertian reflection."""
    mi = backend.mitsuba()
    import drjit as dr

    n = sampling.lamp_points
    coarse = surface.every(sampling.lamp_stride_px)
    samples = SampleSet.sobol(n, 1, seed=seed)
    si, point, sample, albedo = _points_on(world, coarse, n)
    radiance = dr.zeros(mi.Float, dr.width(point))
    for lamp in world.lamps:
        place, direction, density = lamp.connection(si.p, *(samples.uniform(sample, point, d) for d in range(2)))
        cosine = dr.dot(si.n, direction)
        lit = (albedo > 0) & (cosine > 0) & (density > 0)
        lit &= ~world.scene.ray_test(si.spawn_ray_to(place), coherent=True, active=lit)
        radiance += dr.select(lit, albedo * dr.inv_pi * cosine * lamp.radiance / density, 0)
    field = _pixel_means([radiance], n).reshape(1, *coarse.body.shape)
    return coarse.interpolated(field, surface, sampling.lamp_stride_px)[0]


def _indirect_light(
    world: LoadedScene, light: ProjectorLight, surface: SurfaceMap, sampling: Sampling, seed: int
) -> Float32[np.ndarray, "2 h w"]:
    """Light that reaches Lambertian surfaces from the surroundings or by way of other surfaces, both layers."""
    mi = backend.mitsuba()

    n = sampling.indirect_directions
    coarse = surface.every(sampling.indirect_stride_px)
    samples = SampleSet.sobol(n, sampling.max_depth, seed=seed)
    si, point, sample, albedo = _points_on(world, coarse, n)
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
        projector_shadows=sampling.projector_shadows,
    )
    fields = _pixel_means([layer * albedo for layer in paths], n).reshape(2, *coarse.body.shape)
    return coarse.interpolated(fields, surface, sampling.indirect_stride_px)


def _points_on(world: LoadedScene, coarse: SurfaceMap, n: int) -> tuple[Any, Any, Any, Any]:
    """Interactions at the map's points, n consecutive ones for each, with the indices of point and sample, and albedo.

    The albedo is 0 where there is no Lambertian surface.
    """
    mi = backend.mitsuba()
    import drjit as dr

    index = dr.arange(mi.UInt32, coarse.body.size * n)
    point, sample = index // n, index % n
    position, normal = (
        [dr.gather(mi.Float, mi.Float(np.ascontiguousarray(a[..., k].ravel())), point) for k in range(3)]
        for a in (coarse.position, coarse.normal)
    )
    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(index))
    si.t, si.p, si.n = mi.Float(1), mi.Point3f(*position), mi.Normal3f(*normal)
    body = dr.gather(mi.UInt32, mi.UInt32(coarse.body.ravel().astype(np.uint32)), point)
    return si, point, sample, dr.gather(mi.Float, world.albedo_of_body, body)


def _pixel_means(values: Sequence[Any], n: int) -> Float32[np.ndarray, "c pixels"]:
    """Means over each pixel's n consecutive samples."""
    import drjit as dr

    # One kernel for all of them first: each block sum would otherwise trace the paths again.
    dr.eval(values)
    sums = [dr.block_sum(value, n) for value in values]
    dr.eval(sums)
    return np.stack([s.numpy() for s in sums]) / np.float32(n)
