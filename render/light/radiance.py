"""Radiance of the projector's and of the ambient light at every pixel of an imager, as two separate layers.

Pixels that see Lambertian surfaces only need few samples: a handful of positions for the dots, while the light of lamps
and other surfaces is smooth and comes from `render.light.smooth`. Pixels that see anything glossy get whole light
paths, which end where they meet smooth light that is known already.
No denoiser: it would invent or erase dots.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float32, Int
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render.imager.polarisers import Polarisers
from render.light.caustics import Photons, caustics, from_lamps, from_projector
from render.light.edges import reflected
from render.light.first_surface import FirstSurface, StereoView
from render.light.paths import trace_paths
from render.light.polarisation import Polarisation
from render.light.projector import ProjectorLight
from render.light.sampling import SampleSet, Sampling, sample_means
from render.light.seen import SeenLight
from render.light.smooth import smooth_light
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.radiosity import Closing

PATHS_PER_LAUNCH = 4_000_000
"""Light paths in one kernel launch, which bounds memory (about 200 B a path)."""
CAUSTIC_BLUR_PX = (0.7, 4.0)
"""To which caustics of the dots and of lamps are smoothed [px]. Choices: about as much as lens and rectification blur,
and less than an edge of a lamp's shadow is wide."""
LAMP_SHARE = 8
"""Of the projector's photons, the lamps get one in so many (choice: their caustics are as soft as lamps are wide)."""


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
    noise are the imager's.
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
    polarisers: Polarisers | None = None,
) -> RadianceLayers:
    """Render both layers as an ideal imager with box-shaped pixels sees them, behind its polarisers; one seed, one
    image."""
    first = FirstSurface(world, light, intrinsics, T_world_imager)
    return _Renderer.at(world, first, sampling, seed, polarisers).render(first)[0]


def render_stereo(
    world: LoadedScene, view: StereoView, sampling: Sampling, seed: int = 0, polarisers: Polarisers | None = None
) -> tuple[RadianceLayers, RadianceLayers]:
    """Both imagers' layers, behind polarisers if there are any.

    view: of this scene, or of another one of the same geometry.
    """
    renderer = _Renderer.at(world, view.left, sampling, seed, polarisers)
    left, seen = renderer.render(view.left)
    right, _ = renderer.render(view.right, seen)
    return left, right


def stop_at_first_surface(
    world: LoadedScene,
    view: StereoView,
    sampling: Sampling,
    rendered: tuple[RadianceLayers, RadianceLayers],
    seed: int = 0,
    polarisers: Polarisers | None = None,
) -> tuple[RadianceLayers, RadianceLayers]:
    """Both imagers' layers without mirror images and mutual light: with what surfaces get straight from projector,
    lamps and surroundings alone.

    rendered: by `render_stereo` with the same arguments, which is the caller's word; its glossy paths are used again.
    ValueError for layers that carry none.
    """
    direct = _Renderer.at(world, view.left, replace(sampling, max_depth=1), seed, polarisers)
    images, seen = [], None
    for first, layers in zip((view.left, view.right), rendered, strict=True):
        if layers.stopped is None:
            raise ValueError("layers without stopped paths; pass what render_stereo returned")
        radiance, _, seen = direct.of_lambertian(first, seen)
        radiance.reshape(2, -1)[:, layers.stopped.pixels] = layers.stopped.layers
        images.append(RadianceLayers(radiance[0], radiance[1]))
    return images[0], images[1]


@dataclass(frozen=True, eq=False)
class _Renderer:
    """One scene under one projector, and what both imagers share."""

    world: LoadedScene
    sampling: Sampling
    seed: int
    closing: Closing | None
    """What paths that end at `Sampling.max_depth` leave out; nothing where only direct light is wanted."""
    photons: tuple[Photons | None, Photons | None]
    """Of the projector's and of the lamps' light."""
    films: Polarisation | None
    """Polarisers, which look the same way from both imagers."""

    @classmethod
    def at(
        cls,
        world: LoadedScene,
        first: FirstSurface,
        sampling: Sampling,
        seed: int,
        polarisers: Polarisers | None = None,
    ) -> "_Renderer":
        """first: of either imager."""
        films = None
        if polarisers is not None and polarisers.any_film:
            films = Polarisation.of(polarisers, world, first.light, first.T_world_imager)
        further, view = sampling.max_depth > 1, first.projector_view
        closing = world.radiosity.closing(view.seen_by_patches) if sampling.closing and further else None
        most = sampling.photons if further else 0
        photons = from_projector(world, view, most, seed), from_lamps(world, most // LAMP_SHARE, seed)
        return cls(world, sampling, seed, closing, photons, films)

    def render(self, first: FirstSurface, other: SeenLight | None = None) -> tuple[RadianceLayers, SeenLight | None]:
        """One imager's layers, and the smooth light that it sees. other: that of another imager."""
        sampling = self.sampling
        layers, glossy, smooth = self.of_lambertian(first, other)
        pixels = np.flatnonzero(glossy)
        few, many = sampling.glossy_paths, sampling.refined_paths
        moments = self._whole_paths(first, smooth, pixels, 0, few)
        variance = moments[4] - np.square(moments[:2].sum(axis=0))
        paths = moments[:4]
        noisiest = np.sort(np.argsort(-variance, kind="stable")[: round(sampling.refined_share * len(pixels))])
        if len(noisiest) and many > few:
            # A Sobol' set begins with the smaller one: its paths are there already.
            further = self._whole_paths(first, smooth, pixels[noisiest], few, many)[:4]
            paths[:, noisiest] += np.float32(1 - few / many) * (further - paths[:, noisiest])
        layers.reshape(2, -1)[:, pixels] = paths[:2]
        return RadianceLayers(layers[0], layers[1], StoppedPaths(pixels, paths[2:])), smooth

    def of_lambertian(
        self, first: FirstSurface, other: SeenLight | None = None
    ) -> tuple[Float32[np.ndarray, "2 h w"], Bool[np.ndarray, "h w"], SeenLight | None]:
        """Both layers of the pixels that see Lambertian surfaces alone, which pixels see others, and the smooth
        light. other: as in `smooth_light`."""
        world, sampling = self.world, self.sampling
        if sampling.whole_paths_everywhere:
            return np.zeros((2, *first.shape), np.float32), np.ones(first.shape, bool), None
        dots = first.dots(sampling.subpixels, self.seed)
        from_projector, glossy = dots.on(world)
        thrown = [caustics(photons, first, blur) for photons, blur in zip(self.photons, CAUSTIC_BLUR_PX, strict=True)]
        smooth = smooth_light(world, first, sampling, self.seed, np.stack(thrown), self.closing, other, self.films)
        light = np.stack([smooth.projector, smooth.lamps + smooth.ambient])
        albedo = np.stack([lookup.numpy() for lookup in world.reflectances.albedo])
        layers = reflected(light, albedo, first.surface.body, dots.bodies)
        layers = layers + np.stack([from_projector, dots.lamps_seen])
        if self.films is not None:
            layers *= np.array(self.films.passed, np.float32)[:, None, None]
        return layers, glossy, smooth

    def _whole_paths(
        self, first: FirstSurface, smooth: SeenLight | None, pixels: Int[np.ndarray, "p"], start: int, end: int
    ) -> Float32[np.ndarray, "5 p"]:
        """Both layers at the given pixels (flat indices) by full paths, means of the samples `start` to `end` of a set
        of `end`; both of the same paths if they stop at the first surface; and the mean square of the full paths'
        light."""
        mi = backend.mitsuba()
        import drjit as dr

        sampling = self.sampling
        if sampling.max_depth > 1:
            sampling = replace(sampling, max_depth=sampling.max_depth + sampling.glossy_vertices)
        samples, n = SampleSet.sobol(end, sampling.max_depth, sampling.rotated, self.seed), end - start
        moments = np.zeros((5, len(pixels)), np.float32)
        step, width = max(PATHS_PER_LAUNCH // n, 1), first.shape[1]
        for place in range(0, len(pixels), step):
            chosen = mi.UInt32(pixels[place : place + step].astype(np.uint32))
            index = dr.arange(mi.UInt32, dr.width(chosen) * n)
            pixel, sample = dr.gather(mi.UInt32, chosen, index // n), start + index % n
            row = pixel // dr.opaque(mi.UInt32, width)
            u = mi.Float(pixel - row * width) + samples.uniform(sample, pixel, 0) - 0.5
            v = mi.Float(row) + samples.uniform(sample, pixel, 1) - 0.5
            ray = first.imager.ray(u, v)
            light = trace_paths(
                *(self.world, first.light, ray, pixel, sample, samples, sampling),
                seen=smooth,
                closing=self.closing,
                films=self.films,
            )
            values = [light.projector, light.lamps, light.projector_stopped, light.lamps_stopped]
            if self.films is not None:
                values = [value * share for value, share in zip(values, 2 * self.films.passed, strict=True)]
            moments[:, place : place + step] = sample_means([*values, dr.square(values[0] + values[1])], n)
        return moments
