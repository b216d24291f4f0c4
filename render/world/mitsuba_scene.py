"""A scene of plain data as a loaded Mitsuba scene, without the projector: `render.light.paths` adds its light.

Every dispatched call is traced once for each shape and each BSDF that is alive, whoever uses it, and that took longer
than the rays. So bodies are joined into a few meshes and told apart by their faces; materials are looked up by body
and not through the shapes, so that a scene and its matte twin share all that is geometry; and BSDFs are made for
glossy materials alone, when the first path asks for them.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np

from materials.input_error import InputError
from materials.material import Matte
from render.world import backend
from render.world.bsdf import bsdf_description, is_diffuse
from render.world.lamps import LampLight
from scenes.scene import Lamp, Mesh, Scene

NO_BODY = 255
"""Index in id maps where a ray meets nothing."""
FIRST_LAMP = 192
"""Index in id maps of the first lamp; bodies have smaller ones."""


@dataclass(frozen=True, eq=False)
class SceneGeometry:
    """The shapes of a Mitsuba scene, whatever they are made of; a lamp is two triangles in it."""

    scene: Any
    """`mitsuba.Scene`."""
    first_face_of_shape: Any
    """Dr.Jit lookup (UInt32): Mitsuba's registry id of a shape -> where its faces begin in `body_of_face`."""
    body_of_face: Any
    """Dr.Jit lookup (UInt32): index into the scene's bodies, or FIRST_LAMP + lamp."""

    def body(self, si: Any) -> Any:
        """Index of the body or lamp that each interaction lies on (UInt32), NO_BODY for none."""
        mi = backend.mitsuba()
        import drjit as dr

        hit = si.is_valid()
        shape: Any = dr.reinterpret_array(mi.UInt32, si.shape)
        first = dr.gather(mi.UInt32, self.first_face_of_shape, shape, hit)
        return dr.select(hit, dr.gather(mi.UInt32, self.body_of_face, first + si.prim_index, hit), NO_BODY)


@dataclass(frozen=True, eq=False)
class LoadedScene:
    """Geometry with its light, and what the bodies are made of.

    At 850 nm alone. Without the projector, which belongs to a pose (`render.light.projector`). Surroundings shine with
    one radiance from all directions.
    """

    geometry: SceneGeometry
    glossy_of_body: Any
    """Dr.Jit lookup (UInt32), NO_BODY + 1 entries: 1 where a body is not Lambertian; 0 for nothing and lamps."""
    albedo_of_body: Any
    """Dr.Jit lookup (Float), NO_BODY + 1 entries: reflectance of the Lambertian bodies, 0 for all else."""
    lamps: tuple[LampLight, ...]
    """In the order of `source.lamps`."""
    ambient: Any
    """Radiance of directions that leave the scene, opaque [W m^-2 sr^-1]."""
    source: Scene

    @property
    def scene(self) -> Any:
        """`mitsuba.Scene`, to shoot rays at; its shapes know nothing of materials."""
        return self.geometry.scene

    def body(self, si: Any) -> Any:
        """Index of the body or lamp that each interaction lies on (UInt32), NO_BODY for none."""
        return self.geometry.body(si)

    def is_glossy(self, body: Any) -> Any:
        """Whether the bodies of these indices reflect other than diffusely (Bool)."""
        mi = backend.mitsuba()
        import drjit as dr

        return dr.gather(mi.UInt32, self.glossy_of_body, body) == 1

    @property
    def bsdf_of_body(self) -> Any:
        """Dr.Jit lookup (BSDFPtr), NO_BODY + 1 entries: of the glossy bodies, null for all others.

        They are made when this is first asked for: ask before a loop is recorded, where errors would lose their text.
        InputError for a file that cannot be used.
        """
        return self._bsdfs[0]

    @cached_property
    def _bsdfs(self) -> tuple[Any, list[Any]]:
        """That lookup, and the BSDFs, which live as long as this does."""
        mi = backend.mitsuba()
        import drjit as dr

        made = {
            body.material: mi.load_dict(bsdf_description(body.material))
            for body in self.source.bodies
            if not is_diffuse(body.material)
        }
        number_of = {material: _number(mi.BSDFPtr(bsdf)) for material, bsdf in made.items()}
        lookup = np.zeros(NO_BODY + 1, np.uint32)
        lookup[: len(self.source.bodies)] = [number_of.get(body.material, 0) for body in self.source.bodies]
        return dr.reinterpret_array(mi.BSDFPtr, mi.UInt32(lookup)), list(made.values())


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
    glossy = np.zeros(NO_BODY + 1, np.uint32)
    glossy[: len(scene.bodies)] = [not is_diffuse(body.material) for body in scene.bodies]
    albedo = np.zeros(NO_BODY + 1, np.float32)
    albedo[: len(scene.bodies)] = [b.material.reflectance if isinstance(b.material, Matte) else 0 for b in scene.bodies]
    return LoadedScene(
        known.geometry if known and shared else _geometry(scene),
        mi.UInt32(glossy),
        mi.Float(albedo),
        tuple(LampLight.of(lamp) for lamp in scene.lamps),
        dr.opaque(mi.Float, float(scene.ambient_radiance)),
        scene,
    )


def _geometry(scene: Scene) -> SceneGeometry:
    """Load the shapes; meshes that carry the same kinds of vertex data are joined."""
    mi = backend.mitsuba()

    surfaces = [(number, body.mesh) for number, body in enumerate(scene.bodies)]
    surfaces += [(FIRST_LAMP + number, _lamp_mesh(lamp)) for number, lamp in enumerate(scene.lamps)]
    groups: dict[tuple[bool, bool], list[tuple[int, Mesh]]] = {}
    for number, mesh in surfaces:
        groups.setdefault((mesh.normals is not None, mesh.uvs is not None), []).append((number, mesh))
    shapes = [_mitsuba_mesh(_joined(mesh for _, mesh in group)) for group in groups.values()]
    loaded = mi.load_dict({"type": "scene"} | {f"shape_{i}": shape for i, shape in enumerate(shapes)})
    bodies = [np.repeat([n for n, _ in group], [len(mesh.faces) for _, mesh in group]) for group in groups.values()]
    numbers = [_number(mi.ShapePtr(shape)) for shape in shapes]
    first_face = np.zeros(max(numbers, default=0) + 1, np.uint32)
    first_face[numbers] = np.cumsum([0, *(len(of_face) for of_face in bodies)])[:-1]
    of_face = np.concatenate([*bodies, [NO_BODY]])  # an empty scene must be looked up too
    return SceneGeometry(loaded, mi.UInt32(first_face), mi.UInt32(of_face.astype(np.uint32)))


def _number(pointer: Any) -> int:
    """Number by which Dr.Jit knows what a pointer array of one points to."""
    mi = backend.mitsuba()
    import drjit as dr

    numbers: Any = dr.reinterpret_array(mi.UInt32, pointer)
    return int(numbers[0])


def _joined(meshes: Iterable[Mesh]) -> Mesh:
    """Meshes of the same kinds of vertex data as one, faces in their order."""
    meshes = list(meshes)
    offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    uvs = [mesh.uvs for mesh in meshes if mesh.uvs is not None]
    normals = [mesh.normals for mesh in meshes if mesh.normals is not None]
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=False)]),
        np.concatenate(uvs) if uvs else None,
        np.concatenate(normals) if normals else None,
    )


def _mitsuba_mesh(mesh: Mesh) -> Any:
    mi = backend.mitsuba()
    shape = mi.Mesh(
        "surface",
        vertex_count=len(mesh.vertices),
        face_count=len(mesh.faces),
        has_vertex_normals=mesh.normals is not None,
        has_vertex_texcoords=mesh.uvs is not None,
    )
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = np.ascontiguousarray(mesh.vertices, np.float32).ravel()
    parameters["faces"] = np.ascontiguousarray(mesh.faces, np.uint32).ravel()
    if mesh.normals is not None:
        parameters["vertex_normals"] = np.ascontiguousarray(mesh.normals, np.float32).ravel()
    if mesh.uvs is not None:
        parameters["vertex_texcoords"] = np.ascontiguousarray(mesh.uvs, np.float32).ravel()
    parameters.update()
    shape.set_bsdf(_bsdf_of_shapes())
    return shape


@cache
def _bsdf_of_shapes() -> Any:
    """One for all shapes, which nobody asks: without it each would make one of its own."""
    return backend.mitsuba().load_dict({"type": "diffuse"})


def _lamp_mesh(lamp: Lamp) -> Mesh:
    """Two triangles that face along the lamp's +z."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * [lamp.width / 2, lamp.height / 2, 0.0]
    return Mesh(lamp.T_world_lamp.apply(corners), np.array([[0, 1, 2], [0, 2, 3]]))
