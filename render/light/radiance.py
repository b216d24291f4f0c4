"""Radiance of the projector's and of the ambient light at every pixel of an imager, as two separate layers.

Pixels that see Lambertian surfaces only need few samples: a handful of positions for the dots, while the light of lamps
and other surfaces is smooth and comes from `render.light.smooth`. Pixels that see anything glossy get whole light
paths, which end where they meet smooth light that is known already.
No denoiser: it would invent or erase dots.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from jaxtyping import Bool, Float32, Int
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render.light.first_surface import FirstSurface, StereoView
from render.light.paths import trace_paths
from render.light.projector import ProjectorLight
from render.light.sampling import SampleSet, Sampling, sample_means
from render.light.smooth import SmoothLight, smooth_light
from render.world import backend
from render.world.mitsuba_scene import LoadedScene

PATHS_PER_LAUNCH = 4_000_000
"""Light paths in one kernel launch, which bounds memory (about 200 B a path)."""


@dataclass(frozen=True, eq=False)
class StoppedPaths:
    """What the pixels that see anything glossy got by the time their paths had left the first surface."""

    pixels: Int[np.ndarray, "p"]
    """Flat indices."""
    layers: Float32[np.ndarray, "2 p"]
    """Of the projector's and of the ambient light [W m^-2 sr^-1]."""


@dataclass(frozen=True, eq=False)
class RadianceLayers:
    """One imager's radiance image, apart by source, so that laser power and lamps scale without a new rendering.

    Transport is linear: the image is projector * power / reference power + ambient. Pixels are boxes; lens, speckle and
    noise are the imager's. Left out is light that metal throws onto matte surfaces (`render.light.paths`).
    """

    projector: Float32[np.ndarray, "h w"]
    """At the laser power that the projector light was made with [W m^-2 sr^-1]."""
    ambient: Float32[np.ndarray, "h w"]
    """From lamps and environment [W m^-2 sr^-1]."""
    stopped: StoppedPaths | None = None
    """Of the same paths; None = not known."""

    def with_ambient_scaled(self, by: float) -> "RadianceLayers":
        """The same under lamps of another radiance."""
        scale = np.float32(by)
        if self.stopped is None:
            return RadianceLayers(self.projector, self.ambient * scale)
        projector, ambient = self.stopped.layers
        stopped = StoppedPaths(self.stopped.pixels, np.stack([projector, ambient * scale]))
        return RadianceLayers(self.projector, self.ambient * scale, stopped)


def render_layers(
    world: LoadedScene,
    light: ProjectorLight,
    intrinsics: Intrinsics,
    T_world_imager: RigidTransform,
    sampling: Sampling,
    seed: int = 0,
) -> RadianceLayers:
    """Render both layers as an ideal imager with box-shaped pixels sees them; one seed, one image."""
    return _render(world, FirstSurface(world, light, intrinsics, T_world_imager), sampling, seed, None)[0]


def render_stereo(
    world: LoadedScene, view: StereoView, sampling: Sampling, seed: int = 0
) -> tuple[RadianceLayers, RadianceLayers]:
    """Both imagers' layers. What the left one knows of the smooth light is looked up for the right one.

    view: of this scene, or of another one of the same geometry.
    """
    left, smooth = _render(world, view.left, sampling, seed, None)
    return left, _render(world, view.right, sampling, seed, smooth)[0]


def stop_at_first_surface(
    world: LoadedScene,
    view: StereoView,
    sampling: Sampling,
    rendered: tuple[RadianceLayers, RadianceLayers],
    seed: int = 0,
) -> tuple[RadianceLayers, RadianceLayers]:
    """Both imagers' layers without mirror images and mutual light: with what surfaces get straight from projector,
    lamps and surroundings alone.

    rendered: by `render_stereo` with the same arguments, which is the caller's word; its glossy paths are used again.
    ValueError for layers that carry none.
    """
    direct, known, images = replace(sampling, max_depth=1), None, []
    for first, layers in zip((view.left, view.right), rendered, strict=True):
        if layers.stopped is None:
            raise ValueError("layers without stopped paths; pass what render_stereo returned")
        radiance, _, known = _of_lambertian(world, first, direct, seed, known)
        radiance.reshape(2, -1)[:, layers.stopped.pixels] = layers.stopped.layers
        images.append(RadianceLayers(radiance[0], radiance[1]))
    return images[0], images[1]


def _render(
    world: LoadedScene, first: FirstSurface, sampling: Sampling, seed: int, known: SmoothLight | None
) -> tuple[RadianceLayers, SmoothLight | None]:
    layers, glossy, smooth = _of_lambertian(world, first, sampling, seed, known)
    pixels = np.flatnonzero(glossy)
    whole = partial(_whole_paths, world, first, smooth, sampling, seed)
    paths, variance = whole(pixels, sampling.glossy_paths)
    noisiest = np.sort(np.argsort(-variance, kind="stable")[: round(sampling.refined_share * len(pixels))])
    if len(noisiest):
        paths[:, noisiest], _ = whole(pixels[noisiest], sampling.refined_paths)
    layers.reshape(2, -1)[:, pixels] = paths[:2]
    return RadianceLayers(layers[0], layers[1], StoppedPaths(pixels, paths[2:])), smooth


def _of_lambertian(
    world: LoadedScene, first: FirstSurface, sampling: Sampling, seed: int, known: SmoothLight | None
) -> tuple[Float32[np.ndarray, "2 h w"], Bool[np.ndarray, "h w"], SmoothLight | None]:
    """Both layers of the pixels that see Lambertian surfaces alone, which pixels see others, and the smooth light."""
    if sampling.whole_paths_everywhere:
        return np.zeros((2, *first.shape), np.float32), np.ones(first.shape, bool), None
    dots = first.dots(sampling.subpixels, seed)
    from_projector, glossy = dots.on(world)
    smooth = smooth_light(world, first, sampling, seed, known)
    return np.stack([from_projector, dots.lamps_seen]) + smooth.layers, glossy, smooth


def _whole_paths(
    world: LoadedScene,
    first: FirstSurface,
    smooth: SmoothLight | None,
    sampling: Sampling,
    seed: int,
    pixels: Int[np.ndarray, "p"],
    n: int,
) -> tuple[Float32[np.ndarray, "4 p"], Float32[np.ndarray, "p"]]:
    """Both layers at the given pixels (flat indices) by n full paths each, both of the same paths if they stop at the
    first surface, and the variance of each pixel's full paths."""
    mi = backend.mitsuba()
    import drjit as dr

    samples = SampleSet.sobol(n, sampling.max_depth, sampling.rotated, seed)
    moments = np.zeros((5, len(pixels)), np.float32)
    step, width = max(PATHS_PER_LAUNCH // n, 1), first.shape[1]
    for start in range(0, len(pixels), step):
        chosen = mi.UInt32(pixels[start : start + step].astype(np.uint32))
        index = dr.arange(mi.UInt32, dr.width(chosen) * n)
        pixel, sample = dr.gather(mi.UInt32, chosen, index // n), index % n
        row = pixel // dr.opaque(mi.UInt32, width)
        u = mi.Float(pixel - row * width) + samples.uniform(sample, pixel, 0) - 0.5
        v = mi.Float(row) + samples.uniform(sample, pixel, 1) - 0.5
        light = trace_paths(
            world,
            first.light,
            first.imager.ray(u, v),
            pixel,
            sample,
            samples,
            sampling.max_depth,
            filtered=sampling.filtered,
            smooth=smooth.met if smooth else None,
        )
        values = [light.projector, light.lamps, light.projector_stopped, light.lamps_stopped]
        moments[:, start : start + step] = sample_means([*values, dr.square(light.projector + light.lamps)], n)
    return moments[:4], moments[4] - np.square(moments[:2].sum(axis=0))
