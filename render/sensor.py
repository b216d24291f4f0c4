"""Everything about the simulated camera that a user can set, and what a preset of the RealSense viewer says of it."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, field_validator

from render.depth.coding import MOST_UNITS, DepthFormat
from render.imager.settings import ImagerSettings
from render.matcher import d400_preset as keys
from render.matcher.by_name import MatcherName, matcher_by_name
from render.matcher.d400_preset import D400Preset, is_file_name, load_preset
from render.matcher.interface import StereoMatcher
from render.world.rig import Rig, camera_rig

SET_POINT_PER_DN = 16
"""Of a preset's auto-exposure set-point, read as 12 bits (see `ImagerSettings.set_point`)."""
IMAGER_KEYS = {keys.LASER_POWER: "laser_power_mw", keys.EXPOSURE: "exposure_us", keys.GAIN: "gain"}
"""Keys of a preset's file with the imager's settings that they are about, in the same units."""
AnySettings = TypeVar("AnySettings", bound=BaseModel)


class SensorSettings(BaseModel):
    """Everything about the camera that a user can set; the defaults make the paper's 60 x 40 sensor (section VI).

    Unknown keys and numbers out of range raise pydantic's ValidationError, a profile that the camera lacks and a preset
    file that cannot be read InputError when the camera is made. Not to be set: baseline and projector
    (`render.world.rig`), and where the dots are (`render.light.pattern`).
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    model: Literal["d435i", "d415"] = "d435i"
    """Camera of the D400 family. The D415's rolling shutter is left out: nothing moves during a burst."""
    profile: str = "640x360"
    """Stream profile. Of the D435i's, 640x360 gives 60 x 40 and still measures at a recovery pose's 141 mm (Min-Z
    127 mm); 640x480, a crop of the chip with a longer focal length, begins at 153 mm."""
    roll_deg: Annotated[float, Field(ge=-180.0, le=180.0)] | None = None
    """Turn of the camera in its mount about its optical axis, clockwise as the camera looks [deg]; 0 = baseline
    horizontal, 90 = on end with the right imager below. None: as on the bench that the camera looks at, 90 on the
    paper's (in its photographs the camera hangs on end), else 0, as on a tripod. The camera measures from whatever pose
    it is given: whoever makes poses turns them, the planner by `Parameters.roll_deg`, which the commands set from
    here."""
    preset: str = "default"
    """Preset of the RealSense viewer: default, high_accuracy, high_density, medium_density, hand, or a JSON file (a
    relative path counts from where the command runs), or its text. It sets the matcher; a file also sets depth
    units and clamps, laser, exposure and gain where they have their defaults here."""
    decimation: int = Field(default=8, ge=1, le=8)
    """Factor of librealsense's decimation filter, 1 = off (paper: maximum)."""
    crop: tuple[int, int] | None = (60, 40)
    """Width and height of the middle part that is kept after decimation; None = all (paper: 60 x 40)."""
    matcher: MatcherName = "d4"
    """Stereo matcher: like the D4 chip, or OpenCV's StereoSGBM."""
    dot_fwhm_px: float | None = Field(default=None, ge=3.2, le=8.0)
    """Width of the projector's dots at half their height, in the model's 1280x720 images [px]; other streams scale it.
    None: 4.8 px, the D415's in proportion to their distance: 3.8. Real D435 frames have 3.7 to 5 px. A point in focus
    is 2.1 px wide (D415: 2.8 px), and dots 12 px apart would merge above the range."""
    row_misalignment_px: float = Field(default=0.0, ge=-2.0, le=2.0)
    """How much lower than the left image the right one lies after rectification, in pixels of the stream; 0 =
    calibrated without error (choice). Users see such an offset in a D435's rectified images (librealsense issue 2112,
    without a number); another maker passes up to 0.5 px of it in its factory (luxonis/depthai issue 646)."""
    imager: ImagerSettings = ImagerSettings()
    """Exposure, noise and optics of both imagers."""
    auto_exposure: bool = True
    """Choose exposure and gain per pose, as the D400 does by default; otherwise those of `imager` hold."""
    depth: DepthFormat = DepthFormat()
    """Coding of z16."""

    @field_validator("preset")
    @classmethod
    def _known(cls, preset: str) -> str:
        """Names in one spelling; files are read by `resolved`."""
        return preset if is_file_name(preset) or preset.lstrip().startswith("{") else load_preset(preset).name

    @property
    def mount_roll_deg(self) -> float:
        """`roll_deg`, 0 where no bench has said otherwise [deg]."""
        return self.roll_deg or 0.0

    @property
    def light(self) -> "SensorSettings":
        """What of the settings decides which light is rendered, all else as by default: two cameras that are alike in
        it can measure from each other's radiance."""
        films = {"polarisers": self.imager.polarisers, "band_pass": self.imager.band_pass}
        seen_by = {"model": self.model, "profile": self.profile, "dot_fwhm_px": self.dot_fwhm_px}
        return SensorSettings(**seen_by, imager=ImagerSettings(**films))

    @property
    def rig(self) -> Rig:
        """Imagers and projector, and the matcher's range."""
        return camera_rig(self.model, self.profile, load_preset(self.preset).shift)

    @property
    def stereo_matcher(self) -> StereoMatcher:
        """What makes disparities of the infrared pairs; its search begins at the rig's disparity shift."""
        return matcher_by_name(self.matcher, load_preset(self.preset))

    def resolved(self) -> "SensorSettings":
        """The settings with the preset's content in place of its file, and the mount's turn as a number.

        What concerns the matcher stays in `preset`, as text; the rest goes to the settings that it is about, unless
        they were changed from their defaults: whoever changes one after loading a preset means it.
        """
        preset, defaults = load_preset(self.preset), SensorSettings()
        imager, depth, others = preset_settings(preset, self.model)
        update: dict[str, Any] = {
            "roll_deg": self.mount_roll_deg,
            "preset": preset.matcher_text,
            "imager": _over_defaults(self.imager, defaults.imager, imager),
            "depth": _over_defaults(self.depth, defaults.depth, depth),
        }
        return _over_defaults(self.model_copy(update=update), defaults, others)


def preset_settings(preset: D400Preset, model: str) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """What a preset's file says of imager, depth coding and the rest of the sensor, by the settings' names.

    The set-point's unit is known of the D435i alone: a D415's is left out.
    """
    v = preset.values
    imager = {name: v[key] for key, name in IMAGER_KEYS.items() if key in v}
    if keys.SET_POINT in v and model == "d435i":
        imager["set_point"] = v[keys.SET_POINT] / SET_POINT_PER_DN
    if v.get(keys.LASER_ON, 1) == 0:
        imager["laser_power_mw"] = 0.0
    clamps = {"clamp_min": keys.CLAMP_MIN, "clamp_max": keys.CLAMP_MAX}
    depth: dict[str, Any] = {name: min(int(v[key]), MOST_UNITS) for name, key in clamps.items() if key in v}
    if keys.UNITS in v:
        depth["unit"] = preset.depth_unit
    return imager, depth, {"auto_exposure": bool(v[keys.AUTO_EXPOSURE])} if keys.AUTO_EXPOSURE in v else {}


def _over_defaults(settings: AnySettings, defaults: AnySettings, said: Mapping[str, Any]) -> AnySettings:
    """The settings with what was said about those that have their defaults."""
    untouched = {name: value for name, value in said.items() if getattr(settings, name) == getattr(defaults, name)}
    return settings.model_copy(update=untouched)
