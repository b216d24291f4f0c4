"""What the centre ray of every pixel meets: the exact surface behind each pixel, for truth and for interpolation.

Rays go through pixel centres; a depth AOV would be jittered, averaged and measured from the near clip instead.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, no_type_check

import numba
import numpy as np
from jaxtyping import Bool, Float32, Int, UInt8
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.pixel_rays import Imager
from render.world.scene_geometry import FIRST_LAMP

SAME_SURFACE_COSINE = 0.9
"""Normals within 26 deg count as one surface for interpolation (choice)."""
EVEN_OFFSET = 1e-5
"""Points this close to a plane lie on it [m] (rounding of positions 2 m away is 1e-6)."""
EVEN_COSINE = 1 - 1e-6
"""Normals within 0.08 deg are those of one plane (rounding leaves 1e-7)."""
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

    @cached_property
    def even(self) -> Bool[np.ndarray, "h w"]:
        """Pixels whose middle and whose eight neighbours' lie on one plane of one body, within EVEN_OFFSET."""
        out = np.zeros(self.body.shape, bool)
        _find_even(self.body, self.position, self.normal, out)
        return out

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


@no_type_check
@numba.njit(nogil=True, cache=True)
def _find_even(body, position, normal, out):
    height, width = body.shape
    for v in range(1, height - 1):
        for u in range(1, width - 1):
            same = body[v, u] < FIRST_LAMP
            for j in range(v - 1, v + 2):
                for i in range(u - 1, u + 2):
                    if same:
                        offset, cosine = 0.0, 0.0
                        for axis in range(3):
                            offset += (position[j, i, axis] - position[v, u, axis]) * normal[v, u, axis]
                            cosine += normal[j, i, axis] * normal[v, u, axis]
                        same = body[j, i] == body[v, u] and abs(offset) < EVEN_OFFSET and cosine > EVEN_COSINE
            out[v, u] = same


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
    vectors: list[Any] = [dr.ravel(a) for a in (dr.select(hit, si.p, 0), normal)]  # x, y, z of one pixel after another
    dr.eval(body, vectors)
    position, normal = (a.numpy().reshape(*shape, 3) for a in vectors)
    return SurfaceMap(body.numpy().reshape(shape).astype(np.uint8), position, normal)
