"""A scene of plain data as a loaded Mitsuba scene, without the projector: `render.light.paths` adds its light.

Every dispatched call is traced once for each shape and each BSDF that is alive, whoever uses it, and that took longer
than the rays. So bodies are joined into a few meshes and told apart by their faces; materials are looked up by body
and not through the shapes, so that a scene and its matte twin share all that is geometry; and BSDFs are made for the
few materials that are no formula of ours (`render.world.reflectances`), when the first path asks for them.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from materials.input_error import InputError
from render.world import backend
from render.world.lamps import LampLight
from render.world.radiosity import Radiosity
from render.world.reflectances import LAMBERTIAN, Reflectances
from render.world.scene_geometry import FIRST_LAMP, NO_BODY, SceneGeometry, scene_geometry
from scenes.scene import Scene


@dataclass(frozen=True, eq=False)
class LoadedScene:
    """Geometry with its light, and what the bodies are made of.

    The projector, at 850 nm, is not in it, since it belongs to a pose (`render.light.projector`). Surroundings
    shine with one radiance from all directions.
    """

    geometry: SceneGeometry
    reflectances: Reflectances
    """What the bodies are made of, under the projector's light and under the lamps'."""
    ambient: Any
    """Radiance of directions that leave the scene, opaque [W m^-2 sr^-1]."""
    source: Scene
    lamp_photons: dict[tuple[int, int], Any] = field(default_factory=dict)
    """By number and seed; `render.light.caustics` keeps them here."""

    @property
    def scene(self) -> Any:
        """`mitsuba.Scene`, to shoot rays at; its shapes know nothing of materials."""
        return self.geometry.scene

    @property
    def lamps(self) -> tuple[LampLight, ...]:
        """In the order of `source.lamps`."""
        return self.geometry.lamps

    @cached_property
    def radiosity(self) -> Radiosity:
        """Of the light between its patches."""
        return Radiosity(self.geometry, [body.material for body in self.source.bodies], self.source)

    def body(self, si: Any) -> Any:
        """Index of the body or lamp that each interaction lies on (UInt32), NO_BODY for none."""
        return self.geometry.body(si)

    def is_glossy(self, body: Any) -> Any:
        """Whether the bodies of these indices reflect other than diffusely (Bool)."""
        mi = backend.mitsuba()
        import drjit as dr

        return dr.gather(mi.UInt32, self.reflectances.kind, body) > LAMBERTIAN


def load_scene(scene: Scene, known: LoadedScene | None = None) -> LoadedScene:
    """Upload a scene. known: one whose geometry it may share."""
    mi = backend.mitsuba()
    import drjit as dr

    if len(scene.bodies) > FIRST_LAMP or len(scene.lamps) > NO_BODY - FIRST_LAMP:
        raise InputError(
            f"scene {scene.name}: {len(scene.bodies)} bodies and {len(scene.lamps)} lamps; "
            f"join bodies of one material until there are at most {FIRST_LAMP}"
        )
    shared = known is not None and scene.has_geometry_of(known.source)
    return LoadedScene(
        known.geometry if known and shared else scene_geometry(scene),
        Reflectances.of([body.material for body in scene.bodies], scene.lamp_band),
        dr.opaque(mi.Float, float(scene.ambient_radiance)),
        scene,
    )
