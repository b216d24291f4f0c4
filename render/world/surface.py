"""What the centre ray of every pixel meets: the exact surface behind each pixel, for truth and for interpolation.

Rays go through pixel centres; a depth AOV would be jittered, averaged and measured from the near clip instead.
"""

from dataclasses import dataclass, field
from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Float32, Int, UInt8
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.pixel_rays import Imager

SAME_SURFACE_COSINE = 0.9
"""Normals within 26 deg count as one surface for interpolation (choice)."""
SAME_SURFACE_OFFSET = 0.01
"""Points this close to the other's tangent plane count as one surface [m] (choice: below the parts' features)."""


@dataclass(frozen=True, eq=False)
class SurfaceMap:
    """The first surface along each pixel's centre ray, in world coordinates.

    A pixel has one surface: what else it sees beside an edge is left out.
    """

    body: UInt8[np.ndarray, "h w"]
    """Index into the scene's bodies, `mitsuba_scene.NO_BODY` for none."""
    position: Float32[np.ndarray, "h w 3"]
    """[m]; 0 where there is none."""
    normal: Float32[np.ndarray, "h w 3"]
    """Unit normal (exact where the mesh carries it), on the side that the imager sees; 0 where there is none."""
    _weights: dict[int, Float32[np.ndarray, "h w 4"]] = field(default_factory=dict)
    """Of the coarse points around each pixel, by stride."""

    def every(self, stride: int) -> "SurfaceMap":
        """The map at every `stride`-th pixel, starting at stride // 2."""
        window = np.s_[stride // 2 :: stride, stride // 2 :: stride]
        return SurfaceMap(self.body[window], self.position[window], self.normal[window])

    def points(self, numbers: Int[np.ndarray, "p"]) -> "SurfaceMap":
        """The points of these numbers in reading order, as a map of one row."""
        body, position, normal = (
            self.body.reshape(1, -1),
            self.position.reshape(1, -1, 3),
            self.normal.reshape(1, -1, 3),
        )
        return SurfaceMap(body[:, numbers], position[:, numbers], normal[:, numbers])

    def interpolated(self, values: Float32[np.ndarray, "c H W"], stride: int) -> Float32[np.ndarray, "c h w"]:
        """Values at every pixel from those at the points of `every(stride)`, bilinear within each surface.

        Of the four nearest points only those on the same body and on about the same tangent plane count; where none
        does, those of the same body, or failing that all four.
        """
        if stride not in self._weights:
            height, width = self.body.shape
            weights, coarse = np.zeros((height, width, 4), np.float32), self.every(stride)
            _weigh(
                coarse.body, coarse.position, coarse.normal, self.body, self.position, self.normal, stride, weights
            )  # fmt: skip
            self._weights[stride] = weights
        out = np.zeros((len(values), *self.body.shape), np.float32)
        _mix(values, self._weights[stride], stride, out)
        return out


@no_type_check
@numba.njit(nogil=True, cache=True)
def _first_of_two(pixel, stride, count):
    """The nearest coarse point before a pixel (one in `stride`, `count` of them), and how far the pixel is past it."""
    place = (pixel - stride // 2) / stride
    first = min(max(int(np.floor(place)), 0), max(count - 2, 0))
    return first, np.float32(min(max(place - first, 0.0), 1.0))


@no_type_check
@numba.njit(nogil=True, cache=True, fastmath=True)
def _weigh(body, position, normal, fine_body, fine_position, fine_normal, stride, weights):
    """Weights (h, w, 4) of each fine pixel's four coarse points, above left first, below right last; their sum is 1."""
    rows, columns = body.shape
    height, width = fine_body.shape
    one, cosine_least = np.float32(1), np.float32(SAME_SURFACE_COSINE)
    for v in range(height):
        y0, fy = _first_of_two(v, stride, rows)
        for u in range(width):
            x0, fx = _first_of_two(u, stride, columns)
            p0, p1, p2 = fine_position[v, u, 0], fine_position[v, u, 1], fine_position[v, u, 2]
            n0, n1, n2 = fine_normal[v, u, 0], fine_normal[v, u, 1], fine_normal[v, u, 2]
            total = np.float32(1e-12)
            for down in range(2):
                j = min(y0 + down, rows - 1)
                for right in range(2):
                    i = min(x0 + right, columns - 1)
                    weight = (fy if down else one - fy) * (fx if right else one - fx)
                    if body[j, i] == fine_body[v, u]:
                        cosine = normal[j, i, 0] * n0 + normal[j, i, 1] * n1 + normal[j, i, 2] * n2
                        offset = (position[j, i, 0] - p0) * n0 + (position[j, i, 1] - p1) * n1
                        offset += (position[j, i, 2] - p2) * n2
                        same = cosine > cosine_least and abs(offset) < SAME_SURFACE_OFFSET
                        weight *= one if same else np.float32(1e-3)
                    else:
                        weight *= np.float32(1e-6)
                    total += weight
                    weights[v, u, 2 * down + right] = weight
            for k in range(4):
                weights[v, u, k] /= total


@no_type_check
@numba.njit(nogil=True, cache=True, fastmath=True)
def _mix(values, weights, stride, out):
    channels, rows, columns = values.shape
    height, width = out.shape[1:]
    lefts = np.array([_first_of_two(u, stride, columns)[0] for u in range(width)])
    for c in range(channels):
        for v in range(height):
            y0, _ = _first_of_two(v, stride, rows)
            y1 = min(y0 + 1, rows - 1)
            for u in range(width):
                x0 = lefts[u]
                x1 = min(x0 + 1, columns - 1)
                above = weights[v, u, 0] * values[c, y0, x0] + weights[v, u, 1] * values[c, y0, x1]
                out[c, v, u] = above + weights[v, u, 2] * values[c, y1, x0] + weights[v, u, 3] * values[c, y1, x1]


def surface_map(world: LoadedScene, intrinsics: Intrinsics, T_world_imager: RigidTransform) -> SurfaceMap:
    """Shoot one ray through every pixel centre."""
    mi = backend.mitsuba()
    import drjit as dr

    imager = Imager.at(T_world_imager, intrinsics)
    shape = (intrinsics.height, intrinsics.width)
    index = dr.arange(mi.UInt32, shape[0] * shape[1])
    width = dr.opaque(mi.UInt32, shape[1])  # so that every width runs the same compiled kernel
    row = index // width
    ray = imager.ray(mi.Float(index - row * width), mi.Float(row))
    si = world.scene.ray_intersect(ray, mi.RayFlags.All, coherent=True)
    body = world.body(si)
    hit = si.is_valid()
    normal = dr.select(hit, dr.mulsign(si.sh_frame.n, -dr.dot(si.n, ray.d)), 0)
    position = dr.select(hit, si.p, 0)
    dr.eval(body, normal, position)
    return SurfaceMap(
        body.numpy().reshape(shape).astype(np.uint8),
        np.ascontiguousarray(np.array(position).T).reshape(*shape, 3),
        np.ascontiguousarray(np.array(normal).T).reshape(*shape, 3),
    )
