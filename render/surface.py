"""What the centre ray of every pixel meets: the exact surface behind each pixel, for truth and for interpolation.

Rays go through pixel centres; a depth AOV would be jittered, averaged and measured from the near clip instead.
"""

from dataclasses import dataclass
from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Float32, Int, UInt8
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render import backend
from render.light_paths import Imager
from render.mitsuba_scene import LoadedScene

SAME_SURFACE_COSINE = 0.9
"""Normals within 26 deg count as one surface for interpolation (choice)."""
SAME_SURFACE_OFFSET = 0.01
"""Points this close to the other's tangent plane count as one surface [m] (choice: below the parts' features)."""


@dataclass(frozen=True, eq=False)
class SurfaceMap:
    """The first surface along each pixel's centre ray, in world coordinates."""

    body: UInt8[np.ndarray, "h w"]
    """Index into the scene's bodies, `mitsuba_scene.NO_BODY` for none."""
    position: Float32[np.ndarray, "h w 3"]
    """[m]; 0 where there is none."""
    normal: Float32[np.ndarray, "h w 3"]
    """Unit normal (exact where the mesh carries it), on the side that the imager sees; 0 where there is none."""

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

    def interpolated(
        self, values: Float32[np.ndarray, "c H W"], fine: "SurfaceMap", stride: int
    ) -> Float32[np.ndarray, "c h w"]:
        """Values at this coarse map's points (one in `stride` pixels of `fine`), bilinear within each surface.

        Of the four nearest points only those on the same body and on about the same tangent plane count; where none
        does, those of the same body, or failing that all four.
        """
        out = np.zeros((len(values), *fine.body.shape), np.float32)
        _interpolate(
            values, self.body, self.position, self.normal, fine.body, fine.position, fine.normal, stride, out
        )  # fmt: skip
        return out


@no_type_check
@numba.njit(nogil=True, cache=True, fastmath=True)
def _interpolate(values, body, position, normal, fine_body, fine_position, fine_normal, stride, out):
    channels, rows, columns = values.shape
    height, width = fine_body.shape
    one, cosine_least = np.float32(1), np.float32(SAME_SURFACE_COSINE)
    for v in range(height):
        y = (v - stride // 2) / stride
        y0 = min(max(int(np.floor(y)), 0), max(rows - 2, 0))
        fy = np.float32(min(max(y - y0, 0.0), 1.0))
        for u in range(width):
            x = (u - stride // 2) / stride
            x0 = min(max(int(np.floor(x)), 0), max(columns - 2, 0))
            fx = np.float32(min(max(x - x0, 0.0), 1.0))
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
                    for c in range(channels):
                        out[c, v, u] += weight * values[c, j, i]
            for c in range(channels):
                out[c, v, u] /= total


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
