"""Pixels that see several Lambertian surfaces: each sample is lit as the nearest pixel that lies on its own surface."""

from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Float32, UInt8


def reflected(
    light: Float32[np.ndarray, "c h w"],
    albedo: Float32[np.ndarray, "c bodies"],
    body: UInt8[np.ndarray, "h w"],
    samples: UInt8[np.ndarray, "h w n"],
) -> Float32[np.ndarray, "c h w"]:
    """Radiance of each pixel, the mean over its samples.

    light: irradiance over pi where the pixel's middle lies. albedo: by body, 0 for what is not Lambertian. body,
    samples: what lies in the middle and at the samples.
    """
    out = np.zeros_like(light)
    _reflect(light, albedo, body, samples, out)
    return out


@no_type_check
@numba.njit(nogil=True, cache=True)
def _reflect(light, albedo, body, samples, out):
    channels, height, width = light.shape
    n = samples.shape[2]
    for v in range(height):
        for u in range(width):
            middle, mixed = body[v, u], False
            for k in range(n):
                mixed |= samples[v, u, k] != middle
            if not mixed:
                for c in range(channels):
                    out[c, v, u] = albedo[c, middle] * light[c, v, u]
                continue
            for k in range(n):
                here = samples[v, u, k]
                row, column, nearest = v, u, 3 if here != middle else 0
                if nearest:
                    for j in range(max(v - 1, 0), min(v + 2, height)):
                        for i in range(max(u - 1, 0), min(u + 2, width)):
                            if body[j, i] == here and abs(j - v) + abs(i - u) < nearest:
                                row, column, nearest = j, i, abs(j - v) + abs(i - u)
                for c in range(channels):
                    out[c, v, u] += albedo[c, here] * light[c, row, column] / n
