"""What the centre ray of every pixel meets: the exact surface behind each pixel, for truth and for interpolation.

Rays go through pixel centres; a depth AOV would be jittered, averaged and measured from the near clip instead.
"""

from dataclasses import dataclass

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
    """Geometric unit normal, turned towards the imager; 0 where there is none."""

    def every(self, stride: int) -> "SurfaceMap":
        """The map at every `stride`-th pixel, starting at stride // 2."""
        window = np.s_[stride // 2 :: stride, stride // 2 :: stride]
        return SurfaceMap(self.body[window], self.position[window], self.normal[window])

    def interpolated(
        self, values: Float32[np.ndarray, "c H W"], fine: "SurfaceMap", stride: int
    ) -> Float32[np.ndarray, "c h w"]:
        """Values at this coarse map's points (one in `stride` pixels of `fine`), bilinear within each surface.

        Of the four nearest points only those on the same body and on about the same tangent plane count; where none
        does, those of the same body, or failing that all four.
        """
        h, w = fine.body.shape
        H, W = self.body.shape
        x, y = ((np.arange(n) - stride // 2) / stride for n in (w, h))
        x0, y0 = (np.clip(np.floor(a).astype(int), 0, max(n - 2, 0)) for a, n in ((x, W), (y, H)))
        fx, fy = (np.clip(a - a0, 0, 1).astype(np.float32) for a, a0 in ((x, x0), (y, y0)))
        shape = (h, w)
        total, weights = np.zeros((len(values), *shape), np.float32), np.zeros(shape, np.float32)
        for dy, dx in np.ndindex(2, 2):
            at = np.minimum(y0 + dy, H - 1)[:, None], np.minimum(x0 + dx, W - 1)[None, :]
            bilinear = np.outer(fy if dy else 1 - fy, fx if dx else 1 - fx)
            weight = bilinear * self._likeness(at, fine) + 1e-6 * bilinear
            weights += weight
            total += weight * values[:, at[0], at[1]]
        return total / np.maximum(weights, 1e-12)

    def _likeness(self, at: tuple[Int[np.ndarray, "h 1"], Int[np.ndarray, "1 w"]], fine: "SurfaceMap") -> np.ndarray:
        """1 where the coarse point lies on the fine point's surface, 0.001 where only on its body, else 0 (h, w)."""
        same_body = self.body[at] == fine.body
        parallel = np.einsum("hwk,hwk->hw", self.normal[at], fine.normal) > SAME_SURFACE_COSINE
        offset = np.einsum("hwk,hwk->hw", self.position[at] - fine.position, fine.normal)
        return same_body * np.where(parallel & (np.abs(offset) < SAME_SURFACE_OFFSET), 1.0, 1e-3).astype(np.float32)


def surface_map(world: LoadedScene, intrinsics: Intrinsics, T_world_imager: RigidTransform) -> SurfaceMap:
    """Shoot one ray through every pixel centre."""
    mi = backend.mitsuba()
    import drjit as dr

    imager = Imager.at(T_world_imager, intrinsics)
    shape = (intrinsics.height, intrinsics.width)
    index = dr.arange(mi.UInt32, shape[0] * shape[1])
    row = index // shape[1]
    ray = imager.ray(mi.Float(index - row * shape[1]), mi.Float(row))
    si = world.scene.ray_intersect(ray, mi.RayFlags.Minimal, coherent=True)
    body = world.body(si)
    hit = si.is_valid()
    normal = dr.select(hit, dr.mulsign(si.n, -dr.dot(si.n, ray.d)), 0)
    position = dr.select(hit, si.p, 0)
    dr.eval(body, normal, position)
    return SurfaceMap(
        body.numpy().reshape(shape).astype(np.uint8),
        np.ascontiguousarray(np.array(position).T).reshape(*shape, 3),
        np.ascontiguousarray(np.array(normal).T).reshape(*shape, 3),
    )
