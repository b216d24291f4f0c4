"""Samples: how many are spent where, and the low-discrepancy sets that they are."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from jaxtyping import Float32
from scipy.stats import qmc

from render.world import backend

DIMENSIONS_PIXEL = 2
"""Sample dimensions: position in the pixel."""
REFERENCE_DEPTH = 12
"""Vertices of a reference's paths: what is left is 0.6^12, a quarter of a percent of a bright room's light."""
DIMENSIONS_VERTEX = 6
"""Sample dimensions per vertex: BSDF direction (2), point on lamps (2), BSDF component, lamp. The direction comes
first, since a Sobol' set is most even in its first dimensions."""


@dataclass(frozen=True)
class Sampling:
    """How many samples are spent where. `make bench` prints how far the defaults are from 1024 samples a pixel.

    They trade time for error alone, but for `max_depth` without `closing`, which cuts light off, and `filtered`, which
    blurs mirrored dots.
    """

    subpixels: int = 4
    """Positions in a pixel that sees Lambertian surfaces only."""
    lamp_points: int = 16
    """Points on every lamp that light a Lambertian surface."""
    lamp_strides_px: tuple[int, ...] = (4, 2, 1)
    """Distances of the pixels at which that light is computed: the first on even ground, the second where it is steep,
    finer ones on small surfaces and beside others."""
    glossy_paths: int = 32
    """Paths of a pixel that sees a glossy surface, at first."""
    refined_share: float = 0.125
    """Share of those pixels, the noisiest, that get more."""
    refined_paths: int = 128
    """Paths of such a pixel, those from before among them."""
    indirect_directions: int = 128
    """Directions gathered per interpolation point of the indirect light on Lambertian surfaces."""
    fine_directions: int = 64
    """The same on the finer grids, whose points serve few pixels each."""
    indirect_strides_px: tuple[int, ...] = (16, 8, 4, 1)
    """Distances of these interpolation points: wide grids on even ground, finer ones where light is steep, on
    small surfaces and beside others."""
    photons: int = 2**18
    """Most photons by which dots are found that sharp lobes throw onto Lambertian surfaces; 0 = paths find them."""
    max_depth: int = 3
    """Surface vertices of a path: 1 = direct light only, 3 = two bounces more."""
    glossy_vertices: int = 2
    """Further ones of paths from pixels that see a glossy surface, unless there is direct light only: between metals
    light goes back and forth, while paths end soon behind a Lambertian surface (`render.light.paths`)."""
    closing: bool = True
    """Add what paths that end there leave out (`render.world.radiosity`)."""
    filtered: bool = True
    """Look dots behind a glossy vertex up with the footprint of a sample."""
    whole_paths_everywhere: bool = False
    """Treat every pixel as glossy: the reference."""
    rotated: bool = False
    """Shift every pixel's samples at random instead of sharing them: the reference."""

    def reference(self, paths: int) -> "Sampling":
        """Plain path tracing with independent pixels and sharp dots, to check the defaults against."""
        return replace(
            self,
            glossy_paths=paths,
            refined_share=0.0,
            max_depth=REFERENCE_DEPTH,
            closing=False,
            photons=0,
            filtered=False,
            whole_paths_everywhere=True,
            rotated=True,
        )


@dataclass(frozen=True, eq=False)
class SampleSet:
    """A scrambled Sobol' set that every pixel shares, or that every pixel shifts at random (`rotated`).

    `table` (Dr.Jit Float) holds the n points one after the other, `dimensions` coordinates each.
    """

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
        return cls(n, mi.Float(_sobol_points(n, dimensions, seed).ravel()), dimensions, rotated)

    def uniform(self, sample: Any, pixel: Any, dimension: Any, active: Any = True) -> Any:
        """Coordinate `dimension` of the sample, in [0, 1)."""
        mi = backend.mitsuba()
        import drjit as dr

        value = dr.gather(mi.Float, self.table, sample * self.dimensions + dimension, active)
        if self.rotated:
            value += mi.sample_tea_float32(pixel, dimension + 1)
            value -= dr.floor(value)
        return dr.minimum(value, np.float32(1 - 6e-8))


@lru_cache(maxsize=32)
def _sobol_points(n: int, dimensions: int, seed: int) -> Float32[np.ndarray, "n d"]:
    """In [0, 1); kept, since drawing the scrambling takes longer than many a kernel."""
    points = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed)).random(n)
    points = np.clip(points, 0, 1 - 1e-6).astype(np.float32)
    points.setflags(write=False)
    return points


def sample_means(values: Sequence[Any], n: int) -> Float32[np.ndarray, "c pixels"]:
    """Means over each pixel's n consecutive samples."""
    import drjit as dr

    # One kernel for all of them first: each block sum would otherwise trace the paths again.
    dr.eval(values)
    sums = [dr.block_sum(value, n) for value in values]
    dr.eval(sums)
    return np.stack([s.numpy() for s in sums]) / np.float32(n)
