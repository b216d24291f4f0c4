"""The meshes of a scene in Mitsuba, joined into a few shapes and told apart by their faces."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np

from render.world import backend
from render.world.lamps import LampLight
from render.world.patches import Patches, PatchViews, patch_views
from scenes.scene import Lamp, Mesh, Scene

NO_BODY = 255
"""Index in id maps where a ray meets nothing."""
FIRST_LAMP = 192
"""Index in id maps of the first lamp; bodies have smaller ones."""


@dataclass(frozen=True, eq=False)
class SceneGeometry:
    """The shapes of a Mitsuba scene and its lamps, whatever it is made of; a lamp is two triangles in it."""

    scene: Any
    """`mitsuba.Scene`."""
    first_face_of_shape: Any
    """Dr.Jit lookup (UInt32): Mitsuba's registry id of a shape -> where its faces begin in `body_of_face`."""
    body_of_face: Any
    """Dr.Jit lookup (UInt32): index into the scene's bodies, or FIRST_LAMP + lamp."""
    lamps: tuple[LampLight, ...]
    """In the order of the scene's."""
    patches: Patches
    patch_of_face: Any
    """Dr.Jit lookup (UInt32): patch of a face, in the same order."""

    def face(self, si: Any) -> Any:
        """Place in `body_of_face` of the face that each interaction lies on (UInt32); 0 for none."""
        mi = backend.mitsuba()
        import drjit as dr

        hit = si.is_valid()
        shape: Any = dr.reinterpret_array(mi.UInt32, si.shape)
        return dr.select(hit, dr.gather(mi.UInt32, self.first_face_of_shape, shape, hit) + si.prim_index, 0)

    def body(self, si: Any) -> Any:
        """Index of the body or lamp that each interaction lies on (UInt32), NO_BODY for none."""
        mi = backend.mitsuba()
        import drjit as dr

        hit = si.is_valid()
        return dr.select(hit, dr.gather(mi.UInt32, self.body_of_face, self.face(si), hit), NO_BODY)

    def patch(self, si: Any) -> Any:
        """Index of the patch that each interaction lies on (UInt32); 0 for none."""
        mi = backend.mitsuba()
        import drjit as dr

        return dr.gather(mi.UInt32, self.patch_of_face, self.face(si), si.is_valid())

    @cached_property
    def views(self) -> PatchViews:
        """What the patches see of one another, of the lamps and of the outside."""
        return patch_views(self.scene, self.patch, self.patches, self.lamps)


def scene_geometry(scene: Scene) -> SceneGeometry:
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
    numbers = [registry_number(mi.ShapePtr(shape)) for shape in shapes]
    first_face = np.zeros(max(numbers, default=0) + 1, np.uint32)
    first_face[numbers] = np.cumsum([0, *(len(of_face) for of_face in bodies)])[:-1]
    of_face = np.concatenate([*bodies, [NO_BODY]])  # an empty scene must be looked up too
    patches = Patches.of(
        [entry for group in groups.values() for entry in group],
        [number for number, body in enumerate(scene.bodies) if body.is_part],
    )
    return SceneGeometry(
        loaded,
        mi.UInt32(first_face),
        mi.UInt32(of_face.astype(np.uint32)),
        tuple(LampLight.of(lamp) for lamp in scene.lamps),
        patches,
        mi.UInt32(patches.of_face.astype(np.uint32)),
    )


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


def registry_number(pointer: Any) -> int:
    """Number by which Dr.Jit knows what a pointer array of one points to."""
    mi = backend.mitsuba()
    import drjit as dr

    numbers: Any = dr.reinterpret_array(mi.UInt32, pointer)
    return int(numbers[0])
