"""The D435i's geometry: stream profiles, the two infrared imagers, the dot projector between them.

Source: Intel RealSense D400 series datasheet (baseline 50 mm, 126 disparities) and the calibration of real cameras
(focal lengths of the rectified streams).
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from materials.input_error import InputError
from render.matcher.interface import N_DISPARITIES

BASELINE = 0.050
"""Distance of the right imager from the left one along x [m]."""
PROJECTOR_OFFSET = 0.029
"""Distance of the dot projector from the left imager along x [m]."""
FOCAL_LENGTHS_PX = {(1280, 720): 642.0, (848, 480): 427.0, (640, 360): 321.0, (480, 270): 241.0, (424, 240): 213.0}
"""fx = fy of the rectified stream of each profile [px]."""


@dataclass(frozen=True)
class Rig:
    """Two rectified imagers and a projector, all looking along +z of the left imager, the depth frame.

    A point at Z-depth Z has disparity f B / Z. Both imagers have the same intrinsics and the rectification is perfect:
    a real camera's errors of calibration are left out, and so is its colour imager.
    """

    intrinsics: Intrinsics
    """Of either imager."""
    baseline: float = BASELINE
    """[m]"""
    projector_offset: float = PROJECTOR_OFFSET
    """[m]"""

    @property
    def focal_baseline(self) -> float:
        """f B: Z = f B / disparity [px m]."""
        return self.intrinsics.fx * self.baseline

    @property
    def min_z(self) -> float:
        """Smallest measurable Z-depth, where the disparity reaches the end of the search [m]."""
        return self.focal_baseline / N_DISPARITIES

    def right_imager(self, T_world_cam: RigidTransform) -> RigidTransform:
        """Pose of the right imager when the left one stands at `T_world_cam`."""
        return T_world_cam * RigidTransform.from_translation([self.baseline, 0.0, 0.0])

    def projector(self, T_world_cam: RigidTransform) -> RigidTransform:
        """Pose of the projector when the left imager stands at `T_world_cam`."""
        return T_world_cam * RigidTransform.from_translation([self.projector_offset, 0.0, 0.0])


def d435i_rig(profile: str = "640x360") -> Rig:
    """The rig streaming at `profile`, `WIDTHxHEIGHT`; InputError for a profile that the camera does not have."""
    names = {f"{w}x{h}": (w, h) for w, h in FOCAL_LENGTHS_PX}
    if profile not in names:
        raise InputError(f"stream profile {profile!r}: not one of the D435i's; use one of {', '.join(names)}")
    width, height = names[profile]
    focal = FOCAL_LENGTHS_PX[width, height]
    return Rig(Intrinsics(width, height, focal, focal, (width - 1) / 2, (height - 1) / 2))


def left_band(rig: Rig, depth: np.ndarray) -> np.ndarray:
    """Pixels (h, w) whose point at the given Z-depth [m] falls left of the right image: f B / Z columns wide."""
    columns = np.arange(depth.shape[-1])
    with np.errstate(divide="ignore"):
        return columns < np.where(depth > 0, rig.focal_baseline / depth, np.inf)
