"""What an imager meets first along every ray and how the dots fall on it, whatever it is made of.

It depends on the meshes, the lamps, the projector and the pose alone. So it is traced once for a scene, its matte twin,
and all that is changed about the light on its later way.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render.light.paths import light_met
from render.light.projector import ProjectorLight, fall_off
from render.light.sampling import SampleSet, sample_means
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

        albedo = dr.gather(mi.Float, world.albedo_of_body, self.body)
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
    lamp_light: dict[tuple[int, int, int], tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    """What the lamps' light was for the scene that was rendered last, for `render.light.smooth`: albedo of its points
    (0 = not Lambertian) and their radiance [W m^-2 sr^-1], by stride, points on every lamp, and seed."""
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
        si = self.world.scene.ray_intersect(ray, mi.RayFlags.All, coherent=True)
        body = self.world.body(si)

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


@dataclass(frozen=True, eq=False)
class StereoView:
    """What both imagers meet first, of a scene or of any other one of its geometry."""

    left: FirstSurface
    right: FirstSurface

    @classmethod
    def at(cls, world: LoadedScene, light: ProjectorLight, rig: Rig, T_world_cam: RigidTransform) -> "StereoView":
        """Of a rig whose left imager stands at `T_world_cam`, before this scene or another one of its geometry."""
        poses = (T_world_cam, rig.right_imager(T_world_cam))
        return cls(*(FirstSurface(world, light, rig.intrinsics, pose) for pose in poses))
