"""Lamps on the device: points on them to connect to, and what a ray that meets one brings.

Lamps are sampled by area, one point on *every* lamp at each vertex, so that which lamp was chosen adds no noise.
"""

from dataclasses import dataclass
from typing import Any

from render.world import backend
from scenes.scene import Lamp


@dataclass(frozen=True, eq=False)
class LampLight:
    """One rectangular lamp; all fields are Dr.Jit values, opaque so that other lamps run the same kernel.

    Of the same radiance all over and in all directions, on the side of its normal alone; dark behind. `centre` is in
    the world [m].
    """

    centre: Any
    half_width: Any
    """Vector from the centre to the middle of one side [m]."""
    half_height: Any
    """The same across [m]."""
    normal: Any
    """Unit vector to which it shines."""
    area: Any
    """[m^2]"""
    radiance: Any
    """[W m^-2 sr^-1]"""

    @classmethod
    def of(cls, lamp: Lamp) -> "LampLight":
        """Upload."""
        mi = backend.mitsuba()
        import drjit as dr

        axes = lamp.T_world_lamp.rotation.as_matrix().T
        light = cls(
            mi.Point3f(*lamp.T_world_lamp.translation.tolist()),
            mi.Vector3f(*(axes[0] * lamp.width / 2).tolist()),
            mi.Vector3f(*(axes[1] * lamp.height / 2).tolist()),
            mi.Vector3f(*axes[2].tolist()),
            mi.Float(lamp.width * lamp.height),
            mi.Float(lamp.radiance),
        )
        dr.make_opaque(*(getattr(light, name) for name in cls.__dataclass_fields__))
        return light

    def connection(self, point: Any, u: Any, v: Any) -> tuple[Any, Any, Any]:
        """A point on the lamp, the unit direction to it, and its density over solid angle seen from `point` [1/sr].

        u, v: uniform in [0, 1). The density is 0 on the lamp's dark side.
        """
        import drjit as dr

        place = self.centre + (2 * u - 1) * self.half_width + (2 * v - 1) * self.half_height
        offset = place - point
        distance2 = dr.maximum(dr.squared_norm(offset), 1e-9)
        direction = offset * dr.rsqrt(distance2)
        cosine = -dr.dot(direction, self.normal)
        density = dr.select(cosine > 1e-4, distance2 / (dr.maximum(cosine, 1e-4) * self.area), 0)
        return place, direction, density
