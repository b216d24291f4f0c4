"""Scenes whose mirrors show things at known places: a plate, an inside corner, a ball on a table."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at
from materials.catalog import material
from materials.material import Material, Matte
from render.d435i import SimulatedD435i
from scenes.build import coupon_scene
from scenes.coupons import inside_corner
from scenes.scene import Body, Scene
from tests.physics.simple_scenes import facing_x, rectangle

MATTE = Matte("matte", 0.5)
BORDER_PX = 12
"""Pixels inside a mirror's outline that are left out at 640x360: a matcher's support reaches over the edge."""


@dataclass(frozen=True, eq=False)
class MirrorView:
    """A scene, where it is looked at from, and what a mirror in it shows."""

    scene: Scene
    T_world_cam: RigidTransform
    mirror: int
    """Index of the body that is the mirror."""

    def mirror_pixels(self, camera: SimulatedD435i, border_px: int = BORDER_PX) -> Bool[np.ndarray, "h w"]:
        """Pixels inside the mirror's outline as the left imager sees it."""
        seen = (camera.truth(self.T_world_cam).body == self.mirror).astype(np.uint8)
        return cv2.distanceTransform(np.pad(seen, 1), cv2.DIST_L2, 5)[1:-1, 1:-1] > border_px


def steel(alpha: float) -> Material:
    """Austenitic stainless steel of this roughness."""
    return material(f"stainless_austenitic:polished@alpha={alpha}")


def pixel_rays(camera: SimulatedD435i) -> Float[np.ndarray, "h w 3"]:
    """Rays through the pixel centres, camera frame, z = 1."""
    k = camera.rig.intrinsics
    u, v = np.meshgrid(np.arange(k.width), np.arange(k.height))
    return np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(u.shape)], axis=-1)


PLATE_DISTANCE, WALL_OFFSET = 0.4, 0.25
"""Distance of the plate's middle along the camera's axis, and of the wall from that axis [m]."""


def plate_before_wall(alpha: float) -> MirrorView:
    """A mirror plate at 45 deg turns the camera's axis onto a matte wall beside it, which the projector lights.

    The mirror exchanges the directions across and along the axis: the wall, parallel to the axis at WALL_OFFSET,
    appears square to it at Z = PLATE_DISTANCE + WALL_OFFSET.
    """
    middle = np.array([PLATE_DISTANCE, 0.0, 0.0])
    plate = Body("plate", rectangle(middle, middle - [1.0, 1.0, 0.0], 0.2, 0.2), steel(alpha), True)
    beside = rectangle([0.6, -WALL_OFFSET, 0.0], [0.6, 0.0, 0.0], 1.0, 1.0)
    return MirrorView(Scene("plate before wall", (plate, Body("wall", beside, MATTE, False)), (), 0.0), facing_x(), 0)


CORNER_SIZE = 0.2
"""Side of the corner's plates [m]."""
CORNER_FLOOR = 0.006
"""Height of the corner's floor: the thickness of its plate [m]."""


def corner_with_mirror(alpha: float) -> MirrorView:
    """An inside corner of 0.2 m whose upright plate is a mirror and whose floor is matte, in the open and unlit.

    Mirrored at the upright plate, the floor carries on behind it in its own plane.
    """
    floor, back = inside_corner(steel(alpha), faces=2, size=CORNER_SIZE)
    floor = Body(floor.name, floor.mesh, MATTE, True)
    pose = look_at(np.array([0.0, -0.25, 0.22]), np.array([0.0, 0.1, 0.05]))
    return MirrorView(Scene("corner with mirror", (floor, back), (), 0.0), pose, 1)


def floor_behind_mirror(camera: SimulatedD435i, view: MirrorView) -> Float[np.ndarray, "h w"]:
    """Z-depth at which each pixel's ray meets the mirrored floor [m], NaN where it misses it."""
    rays = pixel_rays(camera)
    down = view.T_world_cam.rotation.apply(rays.reshape(-1, 3))[:, 2]
    with np.errstate(divide="ignore"):
        depth = (CORNER_FLOOR - view.T_world_cam.translation[2]) / down
    depth = depth.reshape(rays.shape[:2])
    behind = view.T_world_cam.apply((depth[..., None] * rays).reshape(-1, 3))  # world
    on_floor = (np.abs(behind[:, 0]) < CORNER_SIZE / 2) & (behind[:, 1] < 3 * CORNER_SIZE / 2)
    return np.where(on_floor.reshape(depth.shape), depth, np.nan)


def ball_from_above(
    ball: Material, radius: float, to_table: float, table: Material | None = None, lamps: str = "workshop"
) -> MirrorView:
    """A ball on the table of the furnished room, from straight above; to_table: height of the camera [m]."""
    scene = coupon_scene("ball", ball, lamps, table, radius=radius)
    return MirrorView(scene, look_at(np.array([0.0, 0.0, to_table]), np.zeros(3)), 0)
