"""Mitsuba's own path integrator as judge of the rendered layers: same scene, nothing of `render.light`.

The scene goes to Mitsuba as a dictionary: each body a mesh with its BSDF, each lamp a mesh with an `area` emitter, the
dots as a `projector` emitter, the camera a `perspective` sensor with a box filter. The `path` integrator follows every
path to its end, without tables, interpolation, shared samples or blurred dots.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32
from scipy.ndimage import uniform_filter
from scipy.spatial.transform import RigidTransform
from scipy.special import ndtri

from franbv.frames import Intrinsics
from materials.lights import Band
from render.light.pattern import DotPattern
from render.world import backend
from scenes.scene import Lamp, Mesh, Scene
from tests.judges.judged_bsdf import judged_bsdf

FAMILY_ERROR = 0.05
"""Chance that a right image has any pixel beyond `sidak_limit`."""
POOL_PX = 5
"""Variances of seeds are averaged over windows of this side: few seeds alone would give a t test no power [px]."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """Mean of independent images, and the variance of that mean."""

    mean: Float[np.ndarray, "h w"]
    variance: Float[np.ndarray, "h w"]

    @classmethod
    def of(cls, images: Float32[np.ndarray, "n h w"]) -> "Estimate":
        """From n images of independent seeds."""
        images = np.asarray(images, float)
        spread = images.var(axis=0, ddof=1)
        return cls(images.mean(axis=0), np.maximum(spread, uniform_filter(spread, POOL_PX)) / len(images))


def z_scores(ours: Estimate, judge: Estimate) -> Float[np.ndarray, "h w"]:
    """Difference of the two means in units of its standard deviation."""
    deviation = np.sqrt(ours.variance + judge.variance)
    difference = ours.mean - judge.mean
    return np.divide(difference, deviation, out=np.zeros_like(difference), where=deviation > 0)


def sidak_limit(pixels: int) -> float:
    """|z| that none of so many right pixels passes, but with the chance FAMILY_ERROR (Sidak 1967)."""
    one = 1 - (1 - FAMILY_ERROR) ** (1 / pixels)
    return float(ndtri(1 - one / 2))


def share_beyond(ours: Estimate, judge: Estimate, pixels: Bool[np.ndarray, "h w"] | None = None) -> float:
    """Share of the pixels that lie beyond the limit for their number."""
    z = z_scores(ours, judge)
    z = z.ravel() if pixels is None else z[pixels]
    return float(np.mean(np.abs(z) > sidak_limit(z.size)))


def judged_layers(
    scene: Scene,
    pattern: DotPattern,
    mean: float,
    intrinsics: Intrinsics,
    T_world_imager: RigidTransform,
    T_world_projector: RigidTransform,
    seeds: int,
    spp: int,
    max_depth: int = -1,
    lamps: bool = True,
) -> tuple[Float32[np.ndarray, "n h w"], Float32[np.ndarray, "n h w"]]:
    """Images of the projector's and of all other light, one a seed.

    mean: as `ProjectorLight.mean`. max_depth: surfaces and the light at the path's end, -1 = no end. lamps: whether
    their light is asked for; else it is 0.
    """
    mi = backend.mitsuba()
    bodies = {
        band: {
            f"body_{i}": mesh_shape(body.mesh, judged_bsdf(body.material, band)) for i, body in enumerate(scene.bodies)
        }
        for band in {Band.PROJECTOR, scene.lamp_band}
    }
    camera = perspective(intrinsics, T_world_imager)
    black = {"type": "diffuse", "reflectance": {"type": "spectrum", "value": 0.0}}
    dark = {f"lamp_{i}": mesh_shape(lamp_mesh(lamp), black) for i, lamp in enumerate(scene.lamps)}
    lit = {f"lamp_{i}": mesh_shape(lamp_mesh(lamp), black, lamp.radiance) for i, lamp in enumerate(scene.lamps)}
    if scene.ambient_radiance:
        lit["sky"] = {"type": "constant", "radiance": {"type": "spectrum", "value": scene.ambient_radiance}}
    integrator = {"type": "path", "max_depth": max_depth, "rr_depth": 8}
    common = {"type": "scene", "integrator": integrator, "camera": camera}
    lit_by_dots = common | bodies[Band.PROJECTOR] | dark | {"dots": projector(pattern, mean, T_world_projector)}
    lit_by_lamps = common | bodies[scene.lamp_band] | lit
    images = []
    for description in (lit_by_dots, lit_by_lamps) if lamps else (lit_by_dots,):
        loaded = mi.load_dict(description)
        images.append(np.stack([np.array(mi.render(loaded, spp=spp, seed=seed + 1))[..., 0] for seed in range(seeds)]))
    return images[0], images[1] if lamps else np.zeros_like(images[0])


def perspective(intrinsics: Intrinsics, T_world_imager: RigidTransform) -> dict:
    """The imager as Mitsuba's pinhole, which looks along its +z with +x to the left and +y up."""
    mi = backend.mitsuba()
    k = intrinsics
    return {
        "type": "perspective",
        "fov": float(np.degrees(2 * np.arctan(k.width / (2 * k.fx)))),
        "fov_axis": "x",
        "near_clip": 1e-3,
        "far_clip": 100.0,
        "principal_point_offset_x": 0.5 - (k.cx + 0.5) / k.width,
        "principal_point_offset_y": 0.5 - (k.cy + 0.5) / k.height,
        "to_world": mi.ScalarTransform4f((T_world_imager.as_matrix() @ np.diag([-1.0, -1, 1, 1])).tolist()),
        "film": {
            "type": "hdrfilm",
            "width": k.width,
            "height": k.height,
            "pixel_format": "luminance",
            "rfilter": {"type": "box"},
        },
    }


def projector(pattern: DotPattern, mean: float, T_world_projector: RigidTransform) -> dict:
    """The dots as Mitsuba's projector: a wall of albedo rho at z shows rho scale texel / z^2."""
    mi = backend.mitsuba()
    return {
        "type": "projector",
        "irradiance": {
            "type": "bitmap",
            "bitmap": mi.Bitmap(np.ascontiguousarray(pattern.sharp[..., None])),
            "raw": True,
            "wrap_mode": "clamp",
        },
        "scale": float(mean),
        "fov": float(np.degrees(2 * np.arctan(pattern.half_field[0]))),
        "fov_axis": "x",
        "to_world": mi.ScalarTransform4f((T_world_projector.as_matrix() @ np.diag([-1.0, -1, 1, 1])).tolist()),
    }


def lamp_mesh(lamp: Lamp) -> Mesh:
    """Two triangles that face along the lamp's +z."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * [lamp.width / 2, lamp.height / 2, 0.0]
    return Mesh(lamp.T_world_lamp.apply(corners), np.array([[0, 1, 2], [0, 2, 3]]))


def mesh_shape(mesh: Mesh, bsdf: dict, radiance: float | None = None):
    """A Mitsuba mesh with its BSDF; with a radiance it shines along its normal."""
    mi = backend.mitsuba()
    props = mi.Properties()
    props["surface_bsdf"] = mi.load_dict(bsdf)
    if radiance is not None:
        props["light"] = mi.load_dict({"type": "area", "radiance": {"type": "spectrum", "value": float(radiance)}})
    shape = mi.Mesh(
        "body",
        vertex_count=len(mesh.vertices),
        face_count=len(mesh.faces),
        has_vertex_normals=mesh.normals is not None,
        has_vertex_texcoords=mesh.uvs is not None,
        props=props,
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
