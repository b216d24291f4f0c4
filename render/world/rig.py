"""The cameras' geometry: stream profiles, the two infrared imagers, the dot projector between them.

Source: Intel RealSense D400 series datasheet (baselines, 126 disparities) and the calibration of real cameras (focal
lengths of the rectified streams). Distortion is rectified away, and the D415's rolling shutter is left out: camera and
scene stand still for a burst.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from materials.input_error import InputError
from render.depth.coding import z_range
from render.imager.chip import OV2740, OV9282, Chip

BASELINE = 0.050
"""Distance of the D435i's right imager from the left one along x [m]."""
PROJECTOR_OFFSET = 0.029
"""Distance of its dot projector from the left imager along x [m]."""
FOCAL_LENGTHS_PX = {
    (1280, 720): 642.0,
    (848, 480): 427.0,
    (640, 480): 385.0,
    (640, 360): 321.0,
    (480, 270): 241.0,
    (424, 240): 213.0,
}
"""fx = fy of the D435i's rectified stream of each profile [px]. All show the whole width of the chip but 640x480, which
shows its whole height of 800 rows and the middle 1067 columns: 642 x 480 / 800. Published calibrations of 640x480 have
382.9 to 386.9 px, 1.200 times the same camera's 640x360 (librealsense issues 3474 and 11511, realsense-ros issues 2788
and 2935)."""
D415_FOCAL_PX = 899.5
"""fx = fy of a D415's rectified 1280x720 stream [px] (calibration of a real camera; f B = 49.47 px m)."""


@dataclass(frozen=True)
class CameraModel:
    """A camera of the D400 family, as far as the rig tells one from another."""

    title: str
    """For people."""
    baseline: float
    """[m]"""
    projector_offset: float
    """[m]"""
    focal_lengths_px: Mapping[tuple[int, int], float]
    """fx = fy by width and height of the stream [px]."""
    chip: Chip
    """Of both imagers."""


CAMERA_MODELS = {
    "d435i": CameraModel("RealSense D435i", BASELINE, PROJECTOR_OFFSET, FOCAL_LENGTHS_PX, OV9282),
    "d415": CameraModel(
        "RealSense D415",
        0.055,
        # Choice: halfway. The datasheet's drawings have both of its emitters between the imagers, without a number.
        0.0275,
        # Scaled, as all of its streams show one chip of 1920x1080: whole rows, and of 640x480 whole columns.
        {
            size: D415_FOCAL_PX * 1.5 / (OV2740.shown(*size).width / size[0])
            for size in ((1280, 720), (848, 480), (640, 480), (640, 360), (480, 270), (424, 240))
        },
        OV2740,
    ),
}
"""By the names that `SensorSettings.model` takes."""


@dataclass(frozen=True)
class Rig:
    """Two rectified imagers and a projector, all looking along +z of the left imager, the depth frame.

    A point at Z-depth Z has disparity f B / Z. Both imagers have the same intrinsics, and rows meet rows. Of a real
    camera's errors of calibration there is one, rows out of line, which is put into the right imager's image and not in
    here (`SensorSettings.row_misalignment_px`); the others are left out, and so is the colour imager.
    """

    intrinsics: Intrinsics
    """Of either imager."""
    baseline: float = BASELINE
    """[m]"""
    projector_offset: float = PROJECTOR_OFFSET
    """[m]"""
    model: str = "d435i"
    """Of `CAMERA_MODELS`."""
    disparity_shift: int = 0
    """Smallest disparity that the matcher searches [px]."""

    @property
    def focal_baseline(self) -> float:
        """f B: Z = f B / disparity [px m]."""
        return self.intrinsics.fx * self.baseline

    @property
    def min_z(self) -> float:
        """Smallest measurable Z-depth, where the disparity reaches the end of the search [m]."""
        return z_range(self.focal_baseline, self.disparity_shift)[0]

    @property
    def max_z(self) -> float:
        """Largest measurable Z-depth, where the search begins [m]; infinite without a disparity shift."""
        return z_range(self.focal_baseline, self.disparity_shift)[1]

    @property
    def chip(self) -> Chip:
        """The part of the imagers' chip that the stream shows."""
        return CAMERA_MODELS[self.model].chip.shown(self.intrinsics.width, self.intrinsics.height)

    def right_imager(self, T_world_cam: RigidTransform) -> RigidTransform:
        """Pose of the right imager when the left one stands at `T_world_cam`."""
        return T_world_cam * RigidTransform.from_translation([self.baseline, 0.0, 0.0])

    def projector(self, T_world_cam: RigidTransform) -> RigidTransform:
        """Pose of the projector when the left imager stands at `T_world_cam`."""
        return T_world_cam * RigidTransform.from_translation([self.projector_offset, 0.0, 0.0])


def camera_rig(model: str, profile: str, disparity_shift: int = 0) -> Rig:
    """The rig of a camera model streaming at `profile`, `WIDTHxHEIGHT`; InputError for what there is not."""
    camera = CAMERA_MODELS[model]
    names = {f"{w}x{h}": (w, h) for w, h in camera.focal_lengths_px}
    if profile not in names:
        raise InputError(f"stream profile {profile!r}: not one of the {camera.title}'s; use one of {', '.join(names)}")
    width, height = names[profile]
    focal = camera.focal_lengths_px[width, height]
    intrinsics = Intrinsics(width, height, focal, focal, (width - 1) / 2, (height - 1) / 2)
    return Rig(intrinsics, camera.baseline, camera.projector_offset, model, disparity_shift)


def d435i_rig(profile: str = "640x360") -> Rig:
    """The D435i's rig streaming at `profile`."""
    return camera_rig("d435i", profile)


def left_band(rig: Rig, depth: np.ndarray) -> np.ndarray:
    """Pixels (h, w) whose point at the given Z-depth [m] falls left of the right image: f B / Z columns wide."""
    columns = np.arange(depth.shape[-1])
    with np.errstate(divide="ignore"):
        return columns < np.where(depth > 0, rig.focal_baseline / depth, np.inf)
