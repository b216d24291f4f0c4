"""A scene as plain data: bodies with materials, lamps and a constant ambient radiance. World frame, metres, z up."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.transform import RigidTransform

from materials.lights import Band
from materials.material import Material


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh; outward faces are counter-clockwise."""

    vertices: Float[np.ndarray, "n 3"]
    """Positions [m]."""
    faces: Int[np.ndarray, "m 3"]
    """Vertex indices."""
    uvs: Float[np.ndarray, "n 2"] | None = None
    """Texture coordinates [m along the surface]; u runs along the lay of brushed, ground and milled finishes."""
    normals: Float[np.ndarray, "n 3"] | None = None
    """Shading normals of smooth surfaces; None = flat faces."""


@dataclass(frozen=True, eq=False)
class Body:
    """One surface of one material."""

    name: str
    mesh: Mesh
    """In world coordinates [m]."""
    material: Material
    is_part: bool
    """True for what is to be reconstructed; False for table, room, fixtures."""
    is_fixture: bool = False
    """True for what stands within a robot's reach above the table and is not the part; cameras may not touch it."""


@dataclass(frozen=True)
class Lamp:
    """A rectangular diffuse emitter that shines along its local +z."""

    name: str
    T_world_lamp: RigidTransform
    width: float
    """Along local x [m]."""
    height: float
    """Along local y [m]."""
    radiance: float
    """As bright as it is to the imager [W m^-2 sr^-1, 850 nm-equivalent]."""


@dataclass(frozen=True, eq=False)
class Scene:
    """All that the sensor can see."""

    name: str
    bodies: tuple[Body, ...]
    lamps: tuple[Lamp, ...]
    ambient_radiance: float
    """Constant radiance from every direction that leaves the scene [W m^-2 sr^-1, 850 nm-equivalent]."""
    lamp_band: Band = Band.PROJECTOR
    """Which of their numbers the materials have under lamps and ambient light; by default those at 850 nm."""

    @property
    def part_bodies(self) -> tuple[Body, ...]:
        """The bodies that belong to the part."""
        return tuple(body for body in self.bodies if body.is_part)

    @property
    def fixtures(self) -> tuple[Body, ...]:
        """The bodies that a camera must keep clear of beside the part and what that stands on."""
        return tuple(body for body in self.bodies if body.is_fixture)

    def part_mesh(self) -> Mesh:
        """The part as one mesh (positions and faces only)."""
        offsets = np.cumsum([0, *(len(b.mesh.vertices) for b in self.part_bodies)])
        return Mesh(
            np.concatenate([b.mesh.vertices for b in self.part_bodies]),
            np.concatenate([b.mesh.faces + o for b, o in zip(self.part_bodies, offsets, strict=False)]),
        )

    def has_geometry_of(self, other: "Scene") -> bool:
        """Whether both differ in materials at the most: the same meshes in the same order under the same light."""

        def same(mine: Sequence[object], others: Sequence[object]) -> bool:
            return len(mine) == len(others) and all(a is b for a, b in zip(mine, others, strict=True))

        return (
            same([body.mesh for body in self.bodies], [body.mesh for body in other.bodies])
            and same(self.lamps, other.lamps)
            and self.ambient_radiance == other.ambient_radiance
            and self.lamp_band is other.lamp_band
        )

    def with_materials(self, change) -> "Scene":
        """The same scene with every body's material replaced by `change(body)`."""
        return replace(self, bodies=tuple(replace(body, material=change(body)) for body in self.bodies))
