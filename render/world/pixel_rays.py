"""An imager on the device: rays through its pixels, and pixels of points."""

from dataclasses import dataclass
from typing import Any

from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render.world import backend


@dataclass(frozen=True, eq=False)
class Imager:
    """One imager's pose and intrinsics on the device: a pinhole without distortion, as `franbv.frames.Intrinsics`.

    `origin` is in the world [m], `rotation` (3, 3) maps the imager's axes to the world's; both opaque, so that every
    pose runs the same kernel.
    """

    origin: Any
    rotation: Any
    calibration: Any
    """(fx, fy, cx, cy), opaque."""

    @classmethod
    def at(cls, T_world_imager: RigidTransform, intrinsics: Intrinsics) -> "Imager":
        """Upload a pose."""
        mi = backend.mitsuba()
        import drjit as dr

        imager = cls(
            mi.Point3f(*T_world_imager.translation.tolist()),
            mi.Matrix3f(T_world_imager.rotation.as_matrix().tolist()),
            tuple(mi.Float(x) for x in (intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy)),
        )
        dr.make_opaque(imager.origin, imager.rotation, *imager.calibration)
        return imager

    def ray(self, u: Any, v: Any) -> Any:
        """World rays through pixel coordinates (u, v); pixel centres at integers."""
        mi = backend.mitsuba()
        import drjit as dr

        fx, fy, cx, cy = self.calibration
        return mi.Ray3f(self.origin, dr.normalize(self.rotation @ mi.Vector3f((u - cx) / fx, (v - cy) / fy, 1)))

    def project(self, p: Any) -> tuple[Any, Any, Any]:
        """Pixel coordinates (u, v) and Z-depth [m] of world points; (u, v) mean nothing where the depth is not > 0."""
        import drjit as dr

        fx, fy, cx, cy = self.calibration
        local = self.rotation.T @ (p - self.origin)
        scale = dr.rcp(dr.select(local.z > 0, local.z, 1))
        return fx * local.x * scale + cx, fy * local.y * scale + cy, local.z
