"""What an imager meets first along every ray and how the dots fall on it, whatever it is made of.

It depends on the meshes, the lamps, the projector and the pose alone. So it is traced once for a scene, its matte twin,
and all that is changed about the light on its later way.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, no_type_check

import numba
import numpy as np
from jaxtyping import Bool, Float32, UInt8
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render.light.lamp_light import light_met
from render.light.projector import ProjectorLight, fall_off
from render.light.projector_view import ProjectorView
from render.light.sampling import SampleSet, sample_means
from render.light.seen import SeenSurface
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.pixel_rays import Imager
from render.world.rig import Rig
from render.world.surface import SurfaceMap, surface_map


@dataclass(frozen=True, eq=False)
class Dots:
    """How the projector's dots fall on each of a pixel's n samples, and the lamps that the pixel sees themselves.

    A sample on a Lambertian surface, whose lobe is albedo / pi, sends back albedo cosine white_wall / fall_off
    [W m^-2 sr^-1].
    """

    n: int
    """Samples per pixel, consecutive in the arrays."""
    body: Any
    """UInt32, as `LoadedScene.body` counts."""
    cosine: Any
    """Float: between the normal on the imager's side and the way to the projector, 0 where that is behind."""
    white_wall: Any
    """Float: radiance of a white wall at 1 m in this direction [W m^-2 sr^-1], shadows not regarded."""
    fall_off: Any
    """Float: `projector_light.fall_off` [m^2]."""
    hidden: Any
    """Bool: something stands between the sample and the projector."""
    lamps_seen: Float32[np.ndarray, "h w"]
    """Radiance that comes straight from lamps or from outside the scene, mean over the pixel [W m^-2 sr^-1]."""

    @cached_property
    def bodies(self) -> UInt8[np.ndarray, "h w n"]:
        """`body` on the host."""
        return self.body.numpy().astype(np.uint8).reshape(*self.lamps_seen.shape, self.n)

    def on(self, world: LoadedScene) -> tuple[Float32[np.ndarray, "h w"], Bool[np.ndarray, "h w"]]:
        """The dots on the Lambertian surfaces of a scene of this geometry [W m^-2 sr^-1]; which pixels see others."""
        mi = backend.mitsuba()
        import drjit as dr

        glossy = dr.select(world.is_glossy(self.body), mi.Float(1), mi.Float(0))
        means = sample_means([self._light(world, ~self.hidden), glossy], self.n)
        return means[0].reshape(self.lamps_seen.shape), means[1].reshape(self.lamps_seen.shape) > 0

    def kept_from(self, world: LoadedScene) -> Float32[np.ndarray, "h w"]:
        """What the Lambertian surfaces of such a scene lack in the projector's shadows [W m^-2 sr^-1]."""
        return sample_means([self._light(world, self.hidden)], self.n).reshape(self.lamps_seen.shape)

    def _light(self, world: LoadedScene, chosen: Any) -> Any:
        mi = backend.mitsuba()
        import drjit as dr

        albedo = dr.gather(mi.Float, world.reflectances.albedo[0], self.body)
        return dr.select(chosen, albedo * self.cosine * self.white_wall / self.fall_off, 0)


@dataclass(frozen=True, eq=False)
class FirstSurface:
    """Of one imager at one pose: what it sees of the scene's geometry, traced when first asked for and kept.

    It serves every scene of the same meshes and lamps, whatever they are made of.
    """

    world: LoadedScene
    light: ProjectorLight
    intrinsics: Intrinsics
    T_world_imager: RigidTransform
    lit: ProjectorView | None = None
    """What the projector shines on, if somebody else asks for it as well."""
    lamp_light: dict[tuple[tuple[int, ...], int, int], Float32[np.ndarray, "h w"]] = field(default_factory=dict)
    """Of the lamps, irradiance over pi [W m^-2 sr^-1], by stride, points on every lamp, and seed; `render.light.smooth`
    keeps it here."""
    _dots: dict[tuple[int, int], Dots] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width [px]."""
        return self.intrinsics.height, self.intrinsics.width

    @cached_property
    def imager(self) -> Imager:
        """Pose and intrinsics on the device."""
        return Imager.at(self.T_world_imager, self.intrinsics)

    @cached_property
    def surface(self) -> SurfaceMap:
        """Along the rays through pixel centres."""
        return surface_map(self.world, self.intrinsics, self.T_world_imager)

    @cached_property
    def seen_surface(self) -> SeenSurface:
        """The same, to look points up in."""
        return SeenSurface(self.imager, self.surface)

    @cached_property
    def projector_view(self) -> ProjectorView:
        """What the projector shines on."""
        return self.lit or ProjectorView(self.world.geometry, self.light)

    @cached_property
    def dots_unhidden(self) -> Float32[np.ndarray, "h w"]:
        """Irradiance over pi of the projector's light at every pixel, dots evened out and shadows not regarded [W m^-2
        sr^-1]."""
        out = np.zeros(self.shape, np.float32)
        axis = np.ascontiguousarray(self.light.world_to_projector.numpy().reshape(3, 3)[2])
        place, mean = self.light.position.numpy().ravel(), self.light.mean.numpy()[0]
        _shine(self.surface.position, self.surface.normal, place, axis, mean, out)
        return out

    def dots(self, n: int, seed: int) -> Dots:
        """At n positions in every pixel, the same in all; the seed picks them."""
        if (n, seed) not in self._dots:
            self._dots[n, seed] = self._trace_dots(n, seed)
        return self._dots[n, seed]

    def _trace_dots(self, n: int, seed: int) -> Dots:
        mi = backend.mitsuba()
        import drjit as dr

        height, width = self.shape
        samples = SampleSet.sobol(n, 1, seed=seed)
        index = dr.arange(mi.UInt32, height * width * n)
        pixel, sample = index // n, index % n
        row = pixel // width
        u, v = (samples.uniform(sample, pixel, d) - 0.5 for d in range(2))
        ray = self.imager.ray(mi.Float(pixel - row * width) + u, mi.Float(row) + v)
        si, body = self._met(ray, pixel)

        towards, distance2 = self.light.connection(si.p)
        cosine = dr.maximum(dr.dot(si.sh_frame.n, towards) * -dr.sign(dr.dot(si.sh_frame.n, ray.d)), 0)
        lit = si.is_valid() & (cosine > 0)
        white_wall, cos_axis = self.light.white_wall_radiance(-towards, mi.Float(0), lit)
        lit &= white_wall > 0
        hidden = self.world.scene.ray_test(si.spawn_ray_to(self.light.position), coherent=True, active=lit)
        away = fall_off(cos_axis, distance2)
        lamps_seen = light_met(self.world, si, ray, body, mi.Float(0), mi.UInt32(0), mi.Bool(False))
        white_wall = dr.select(lit, white_wall, 0)
        dr.eval(body, cosine, white_wall, away, hidden, lamps_seen)
        seen = sample_means([lamps_seen], n).reshape(height, width)
        return Dots(n, body, cosine, white_wall, away, hidden, seen)

    def _met(self, ray: Any, pixel: Any) -> tuple[Any, Any]:
        """Interactions of the rays and their bodies: with the plane that the pixel's middle lies on, where that holds
        for its neighbours as well, else traced."""
        mi = backend.mitsuba()
        import drjit as dr

        even = dr.gather(mi.UInt32, mi.UInt32(self.surface.even.ravel().astype(np.uint32)), pixel) == 1
        si = self.world.scene.ray_intersect(ray, mi.RayFlags.All, coherent=True, active=~even)
        point, normal = (
            dr.gather(mi.Vector3f, mi.Float(a.ravel()), pixel) for a in (self.surface.position, self.surface.normal)
        )
        t = dr.dot(mi.Point3f(point) - ray.o, normal) / dr.dot(ray.d, normal)
        body = dr.gather(mi.UInt32, mi.UInt32(self.surface.body.ravel().astype(np.uint32)), pixel)
        body = dr.select(even, body, self.world.body(si))
        si.t = dr.select(even, t, si.t)
        si.p = dr.select(even, ray.o + ray.d * t, si.p)
        si.n = dr.select(even, mi.Normal3f(normal), si.n)
        si.sh_frame.n = dr.select(even, mi.Normal3f(normal), si.sh_frame.n)
        return si, body


@no_type_check
@numba.njit(nogil=True, cache=True)
def _shine(position, normal, place, axis, mean, out):
    """Irradiance over pi by a point light at `place` that shines evenly before it; 73 deg off its axis as beyond."""
    for v in range(out.shape[0]):
        for u in range(out.shape[1]):
            distance2, facing, along = np.float32(1e-9), np.float32(0), np.float32(0)
            for k in range(3):
                way = place[k] - position[v, u, k]
                distance2 += way * way
                facing += way * normal[v, u, k]
                along -= way * axis[k]
            if facing > 0 and along > 0:
                distance = np.sqrt(distance2)
                cosine = max(along / distance, np.float32(0.3))
                out[v, u] = mean * facing / (distance * cosine * cosine * cosine * distance2)


@dataclass(frozen=True, eq=False)
class StereoView:
    """What both imagers meet first, of a scene or of any other one of its geometry."""

    left: FirstSurface
    right: FirstSurface

    @classmethod
    def at(cls, world: LoadedScene, light: ProjectorLight, rig: Rig, T_world_cam: RigidTransform) -> "StereoView":
        """Of a rig whose left imager stands at `T_world_cam`, before this scene or another one of its geometry."""
        poses = (T_world_cam, rig.right_imager(T_world_cam))
        lit = ProjectorView(world.geometry, light)
        return cls(*(FirstSurface(world, light, rig.intrinsics, pose, lit) for pose in poses))
