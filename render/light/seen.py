"""Light on the Lambertian surfaces that one imager sees, for the light paths that meet them again."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Int

from render.world import backend
from render.world.pixel_rays import Imager
from render.world.surface import SAME_SURFACE_COSINE, SurfaceMap

REACH_PX = 4.0
"""How far from the point behind a pixel's centre that pixel's light is good for [px at the point's depth]. Choice: half
the diagonal of a pixel, on surfaces that are seen at up to 80 deg from their normal."""


@dataclass(frozen=True, eq=False)
class SeenSurface:
    """What one imager sees, to ask whether it sees a point."""

    imager: Imager
    surface: SurfaceMap

    def among(self, points: SurfaceMap) -> tuple[Int[np.ndarray, "p"], Bool[np.ndarray, "p"]]:
        """`at` of the points of a map of one row, on the host: the pixels that they fall into, and whether those see
        them."""
        mi = backend.mitsuba()
        position, normal = (np.ascontiguousarray(a.reshape(-1, 3).T) for a in (points.position, points.normal))
        body = mi.UInt32(points.body.ravel().astype(np.uint32))
        pixel, seen, _ = self.at(mi.Point3f(position), mi.Normal3f(normal), body, mi.Bool(True))
        pixel = np.where(seen.numpy(), pixel.numpy(), 0)
        return pixel.astype(np.int64), seen.numpy()

    @cached_property
    def _device(self) -> tuple[Any, Any, Any]:
        """Position, normal and body of each pixel."""
        mi = backend.mitsuba()
        import drjit as dr

        arrays = (
            mi.Float(self.surface.position.ravel()),
            mi.Float(self.surface.normal.ravel()),
            mi.UInt32(self.surface.body.ravel().astype(np.uint32)),
        )
        dr.eval(arrays)
        return arrays

    def at(self, position: Any, normal: Any, body: Any, active: Any) -> tuple[Any, Any, Any]:
        """Flat index of the pixel that points fall into, whether it sees them, and their Z-depth [m].

        normal: on the side that is asked for.
        """
        mi = backend.mitsuba()
        import drjit as dr

        positions, normals, bodies = self._device
        height, width = self.surface.body.shape
        u, v, z = self.imager.project(position)
        column, row = mi.Int32(dr.round(u)), mi.Int32(dr.round(v))
        seen = active & (z > 0) & (column >= 0) & (column < width) & (row >= 0) & (row < height)
        pixel = mi.UInt32(row * width + column)
        seen &= dr.gather(mi.UInt32, bodies, pixel, seen) == body
        offset = dr.gather(mi.Point3f, positions, pixel, seen) - position
        seen &= dr.squared_norm(offset) < dr.square(REACH_PX * z / self.imager.calibration[0])
        seen &= dr.dot(dr.gather(mi.Normal3f, normals, pixel, seen), normal) > SAME_SURFACE_COSINE
        return pixel, seen, z


@dataclass(frozen=True, eq=False)
class LightThere:
    """What reaches places, as the radiance of a white surface there (irradiance over pi) [W m^-2 sr^-1]; Dr.Jit."""

    projector: Any
    """The projector's, by way of other surfaces."""
    ambient: Any
    """That of lamps and surroundings, by way of other surfaces or from outside the scene."""
    lamps: Any
    """Straight from the lamps."""


@dataclass(frozen=True, eq=False)
class SeenLight:
    """Maps of one imager: irradiance over pi on what it sees, that of the dots themselves left out.

    Irradiance looks alike from everywhere. What the imager does not see is not known.
    """

    where: SeenSurface
    caustics: Float32[np.ndarray, "2 h w"]
    """Of the projector's and of the lamps' light [W m^-2 sr^-1]."""
    by_others: Float32[np.ndarray, "2 h w"]
    """The rest of what comes by way of other surfaces, and from outside the scene, likewise; 0 where not complete."""
    lamps: Float32[np.ndarray, "h w"]
    """Straight from the lamps; 0 where not complete."""
    complete: bool
    """Nothing but the dots themselves is missing; else caustics are all that is known."""

    @property
    def projector(self) -> Float32[np.ndarray, "h w"]:
        """As in `LightThere` [W m^-2 sr^-1]."""
        return self.by_others[0] + self.caustics[0]

    @property
    def ambient(self) -> Float32[np.ndarray, "h w"]:
        """Likewise."""
        return self.by_others[1] + self.caustics[1]

    @cached_property
    def _channels(self) -> Any:
        """Light of each pixel, four values."""
        mi = backend.mitsuba()
        import drjit as dr

        nothing = np.zeros_like(self.lamps)
        channels = mi.Float(np.stack([self.projector, self.ambient, self.lamps, nothing], axis=-1).ravel())
        dr.eval(channels)
        return channels

    def at(self, position: Any, normal: Any, body: Any, active: Any) -> tuple[Any, LightThere]:
        """Where the imager sees these points (Bool), and the light there. normal: on the side that is asked for."""
        mi = backend.mitsuba()
        import drjit as dr

        pixel, seen, _ = self.where.at(position, normal, body, active)
        light = dr.gather(mi.Vector4f, self._channels, pixel, seen)
        return seen, LightThere(light.x, light.y, light.z)
