"""A scene of plain data as a loaded Mitsuba scene, without the projector: `render.light_paths` adds its light."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from materials.input_error import InputError
from materials.material import Matte
from render import backend
from render.bsdf import bsdf_description, is_diffuse
from render.lamp_light import LampLight
from scenes.scene import Body, Lamp, Mesh, Scene

NO_BODY = 255
"""Index in id maps where a ray meets nothing."""
FIRST_LAMP = 192
"""Index in id maps of the first lamp; bodies have smaller ones."""


@dataclass(frozen=True, eq=False)
class LoadedScene:
    """A Mitsuba scene and what its shapes mean."""

    scene: Any
    """`mitsuba.Scene`; lamps are black rectangles in it, and shine by `lamps`."""
    body_of_shape: Any
    """Dr.Jit lookup (UInt32): Mitsuba's registry id of a shape -> index into `source.bodies`, FIRST_LAMP + lamp, or
    NO_BODY."""
    glossy_of_body: Any
    """Dr.Jit lookup (UInt32), NO_BODY + 1 entries: 1 where a body is not Lambertian; 0 for nothing and lamps."""
    albedo_of_body: Any
    """Dr.Jit lookup (Float), NO_BODY + 1 entries: reflectance of the Lambertian bodies, 0 for all else."""
    lamps: tuple[LampLight, ...]
    """In the order of `source.lamps`."""
    ambient: Any
    """Radiance of directions that leave the scene, opaque [W m^-2 sr^-1]."""
    source: Scene

    def body(self, si: Any) -> Any:
        """Index of the body or lamp that each interaction lies on (UInt32), NO_BODY for none."""
        mi = backend.mitsuba()
        import drjit as dr

        hit = si.is_valid()
        shape: Any = dr.reinterpret_array(mi.UInt32, si.shape)
        return dr.select(hit, dr.gather(mi.UInt32, self.body_of_shape, shape, hit), NO_BODY)

    def is_glossy(self, body: Any) -> Any:
        """Whether the bodies of these indices reflect other than diffusely (Bool)."""
        mi = backend.mitsuba()
        import drjit as dr

        return dr.gather(mi.UInt32, self.glossy_of_body, body) == 1


def load_scene(scene: Scene) -> LoadedScene:
    """Build the Mitsuba scene; bodies of one material share one BSDF."""
    mi = backend.mitsuba()
    import drjit as dr

    if len(scene.bodies) > FIRST_LAMP or len(scene.lamps) > NO_BODY - FIRST_LAMP:
        raise InputError(
            f"scene {scene.name}: {len(scene.bodies)} bodies and {len(scene.lamps)} lamps; "
            f"join bodies of one material until there are at most {FIRST_LAMP}"
        )
    bsdfs = {body.material: mi.load_dict(bsdf_description(body.material)) for body in scene.bodies}
    bodies = [_mitsuba_mesh(body, bsdfs[body.material]) for body in scene.bodies]
    lamps = [_lamp_shape(lamp) for lamp in scene.lamps]
    loaded = mi.load_dict({"type": "scene"} | {f"shape_{i}": shape for i, shape in enumerate([*bodies, *lamps])})
    ids = [_registry_id(shape) for shape in (*bodies, *lamps)]
    lookup = np.full(max(ids, default=0) + 1, NO_BODY, np.uint32)
    lookup[ids] = [*range(len(bodies)), *range(FIRST_LAMP, FIRST_LAMP + len(lamps))]
    glossy = np.zeros(NO_BODY + 1, np.uint32)
    glossy[: len(bodies)] = [not is_diffuse(body.material) for body in scene.bodies]
    albedo = np.zeros(NO_BODY + 1, np.float32)
    albedo[: len(bodies)] = [b.material.reflectance if isinstance(b.material, Matte) else 0 for b in scene.bodies]
    return LoadedScene(
        loaded,
        mi.UInt32(lookup),
        mi.UInt32(glossy),
        mi.Float(albedo),
        tuple(LampLight.of(lamp) for lamp in scene.lamps),
        dr.opaque(mi.Float, float(scene.ambient_radiance)),
        scene,
    )


def _registry_id(shape: Any) -> int:
    """Number by which Dr.Jit knows the shape."""
    mi = backend.mitsuba()
    import drjit as dr

    pointer: Any = dr.reinterpret_array(mi.UInt32, mi.ShapePtr(shape))
    return int(pointer[0])


def _mitsuba_mesh(body: Body, bsdf: Any) -> Any:
    """The body as a `mitsuba.Mesh` with this BSDF."""
    mi = backend.mitsuba()
    mesh: Mesh = body.mesh
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    shape = mi.Mesh(
        body.name,
        vertex_count=len(mesh.vertices),
        face_count=len(mesh.faces),
        has_vertex_normals=mesh.normals is not None,
        has_vertex_texcoords=mesh.uvs is not None,
        props=properties,
    )
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = np.ascontiguousarray(mesh.vertices, np.float32).ravel()
    parameters["faces"] = np.ascontiguousarray(mesh.faces, np.uint32).ravel()
    if mesh.normals is not None:
        parameters["vertex_normals"] = np.ascontiguousarray(mesh.normals, np.float32).ravel()
    if mesh.uvs is not None:
        parameters["vertex_texcoords"] = np.ascontiguousarray(mesh.uvs, np.float32).ravel()
    parameters.update()
    return shape


def _lamp_shape(lamp: Lamp) -> Any:
    """A black rectangle; Mitsuba's spans (-1, 1)^2 and faces +z."""
    mi = backend.mitsuba()
    matrix = lamp.T_world_lamp.as_matrix() @ np.diag([lamp.width / 2, lamp.height / 2, 1.0, 1.0])
    black = {"type": "diffuse", "reflectance": {"type": "spectrum", "value": 0.0}}
    return mi.load_dict({"type": "rectangle", "to_world": mi.ScalarTransform4f(matrix.tolist()), "bsdf": black})
