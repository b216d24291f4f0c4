"""What the projector shines on: its field in cells, and where the middle of each one falls."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int, UInt8

from render.light.projector import ProjectorLight, fall_off
from render.world import backend
from render.world.scene_geometry import SceneGeometry

CELLS = (320, 192)
"""Columns and rows of the field (choice: 60,000 rays, and cells about as wide as the dots are apart)."""


OFFSET = 1e-4
"""Of shadow rays from the surface that they start on [m]."""


@dataclass(frozen=True, eq=False)
class ProjectorView:
    """Of one projector before one geometry, traced when first asked for."""

    geometry: SceneGeometry
    light: ProjectorLight

    @property
    def cell_size(self) -> tuple[float, float]:
        """Width and height of a cell in the plane at unit distance."""
        return 2 * self.light.half_field[0] / CELLS[0], 2 * self.light.half_field[1] / CELLS[1]

    @cached_property
    def _met(self) -> tuple[UInt8[np.ndarray, "rows columns"], Int[np.ndarray, "rows columns"]]:
        """Body and patch that each cell's middle falls on; the number of patches for none."""
        mi = backend.mitsuba()
        import drjit as dr

        index = dr.arange(mi.UInt32, CELLS[0] * CELLS[1])
        row = index // CELLS[0]
        width, height = self.cell_size
        x = (mi.Float(index - row * CELLS[0]) + 0.5) * width - self.light.half_field[0]
        y = (mi.Float(row) + 0.5) * height - self.light.half_field[1]
        direction = self.light.world_to_projector.T @ mi.Vector3f(x, y, 1)
        si = self.geometry.scene.ray_intersect(mi.Ray3f(self.light.position, dr.normalize(direction)))
        body, patch = self.geometry.body(si), self.geometry.patch(si)
        patch = dr.select(si.is_valid(), patch, len(self.geometry.patches.area))
        dr.eval(body, patch)
        shape = CELLS[1], CELLS[0]
        return body.numpy().reshape(shape).astype(np.uint8), patch.numpy().reshape(shape).astype(int)

    @property
    def body(self) -> UInt8[np.ndarray, "rows columns"]:
        """As `LoadedScene.body` counts."""
        return self._met[0]

    @cached_property
    def seen_by_patches(self) -> Float[np.ndarray, "n n"]:
        """`PatchViews.seen` of the projector's light, as irradiance over pi, dots evened out [W m^-2 sr^-1]."""
        mi = backend.mitsuba()
        import drjit as dr

        views = self.geometry.views
        if not len(views.to_patch):
            return views.form_factors
        towards, distance2 = self.light.connection(views.position)
        cosine = dr.dot(views.normal, towards)
        local = self.light.world_to_projector @ -towards
        half_x, half_y = self.light.half_field
        lit = (cosine > 0) & (local.z > 0) & (dr.abs(local.x) < half_x * local.z) & (dr.abs(local.y) < half_y * local.z)
        lit &= mi.Bool(views.to_patch < views.n)
        start = views.position + views.normal * OFFSET
        way = self.light.position - start
        ray = mi.Ray3f(start, way, 1 - 1e-4, mi.Float(0), mi.Color0f())
        lit &= ~self.geometry.scene.ray_test(ray, active=lit)
        direct = dr.select(lit, self.light.mean * cosine / fall_off(local.z, distance2), 0)
        return views.seen(direct.numpy())
