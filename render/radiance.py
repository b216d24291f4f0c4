"""Radiance of the projector's and of the ambient light at every pixel of an imager, as two separate layers.

Pixels that see Lambertian surfaces only need few samples: a handful of positions for the dots, while the light of lamps
and other surfaces is smooth and comes from `render.smooth_light`. Pixels that see anything glossy get whole light
paths, which end where they meet smooth light that is known already.
No denoiser: it would invent or erase dots.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from jaxtyping import Bool, Float32, Int
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render import backend
from render.light_paths import Imager, light_met, trace_paths
from render.mitsuba_scene import LoadedScene
from render.projector_light import ProjectorLight
from render.sampling import SampleSet, Sampling, sample_means
from render.smooth_light import SmoothLight, smooth_light
from render.surface import surface_map

PATHS_PER_LAUNCH = 4_000_000
"""Light paths in one kernel launch, which bounds memory (about 200 B a path)."""


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
    return _render(world, light, intrinsics, T_world_imager, sampling, seed, None)[0]


def render_stereo(
    world: LoadedScene,
    light: ProjectorLight,
    intrinsics: Intrinsics,
    Ts_world_imager: tuple[RigidTransform, RigidTransform],
    sampling: Sampling,
    seed: int = 0,
) -> tuple[RadianceLayers, RadianceLayers]:
    """Both imagers' layers. What the left one knows of the smooth light is looked up for the right one."""
    first, second = Ts_world_imager
    left, smooth = _render(world, light, intrinsics, first, sampling, seed, None)
    return left, _render(world, light, intrinsics, second, sampling, seed, smooth)[0]


def _render(
    world: LoadedScene,
    light: ProjectorLight,
    intrinsics: Intrinsics,
    T_world_imager: RigidTransform,
    sampling: Sampling,
    seed: int,
    known: SmoothLight | None,
) -> tuple[RadianceLayers, SmoothLight | None]:
    imager = Imager.at(T_world_imager, intrinsics)
    shape = (intrinsics.height, intrinsics.width)
    if sampling.whole_paths_everywhere:
        layers, glossy, smooth = np.zeros((2, *shape), np.float32), np.ones(shape, bool), None
    else:
        layers, glossy = _sharp_light(world, light, imager, shape, sampling, seed)
        surface = surface_map(world, intrinsics, T_world_imager)
        smooth = smooth_light(world, light, surface, imager, sampling, seed, known)
        layers += smooth.layers
    pixels, flat = np.flatnonzero(glossy), layers.reshape(2, -1)
    whole = partial(_whole_paths, world, light, imager, intrinsics.width, smooth, sampling, seed)
    flat[:, pixels], variance = whole(pixels, sampling.glossy_paths)
    noisiest = np.sort(pixels[np.argsort(-variance, kind="stable")[: round(sampling.refined_share * len(pixels))]])
    flat[:, noisiest], _ = whole(noisiest, sampling.refined_paths)
    return RadianceLayers(layers[0], layers[1]), smooth


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

    means = sample_means([from_projector, lamps_seen, dr.select(glossy, mi.Float(1), mi.Float(0))], n)
    return means[:2].reshape(2, *shape), means[2].reshape(shape) > 0


def _whole_paths(
    world: LoadedScene,
    light: ProjectorLight,
    imager: Imager,
    width: int,
    smooth: SmoothLight | None,
    sampling: Sampling,
    seed: int,
    pixels: Int[np.ndarray, "p"],
    n: int,
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
            smooth=smooth.met if smooth else None,
        )
        moments[:, start : start + step] = sample_means([*paths, dr.square(paths[0] + paths[1])], n)
    layers = moments[:2]
    return layers, moments[2] - np.square(layers.sum(axis=0))
