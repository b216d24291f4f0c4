"""Everything about a RealSense camera that a user can set."""

from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from franbv.parameters import Count, Positive

VISUAL_PRESETS = ("default", "high_accuracy", "high_density", "medium_density", "hand")
"""Presets that a camera holds by name (librealsense, `rs400_visual_preset`)."""


def _size(text: object) -> object:
    """A width and height written as one word, `60x40`; everything else as it is."""
    if isinstance(text, str):
        return None if text.lower() == "none" else tuple(text.lower().split("x"))
    return text


Size = Annotated[tuple[Count, Count], BeforeValidator(_size)]
MaybeSize = Annotated[tuple[Count, Count] | None, BeforeValidator(_size)]


class RealSenseSettings(BaseModel):
    """Settings of a real camera; the defaults make the paper's 60 x 40 sensor (section VI).

    Names and units are those of `render.sensor.SensorSettings` where both have a setting. What is None stays as the
    preset leaves it. Unknown keys and numbers out of range raise pydantic's ValidationError; what the camera lacks
    raises CameraError when it is opened. Depth units, calibration and baseline are read from the camera.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    serial: str | None = None
    """Serial number, as `python -m franbv.adapters cameras` lists it. None: the only camera that is plugged in."""
    model: Literal["d435i", "d415"] | None = None
    """Refuse another model than this; None takes any that streams depth. Its numbers come from the camera."""
    profile: Size = (640, 360)
    """Width and height of the depth stream [px], also written `640x360` (paper: see `SensorSettings.profile`)."""
    fps: Count = 30
    """Frames per second (choice: the rate that all depth profiles of a D435i have on USB 3)."""
    preset: str = "default"
    """Preset: default, high_accuracy, high_density, medium_density, hand, or a JSON file of the RealSense viewer. It is
    always set, since a camera keeps the last one until it is unplugged."""
    emitter: bool | None = None
    """Dot projector on or off; None: as the preset has it, which is on."""
    laser_power_mw: float | None = Field(default=None, ge=0.0, le=360.0)
    """Laser power [mW] in the steps that the camera has (D435i: 30 mW up to 360); None: the preset's, 150."""
    exposure_us: Positive | Literal["auto"] | None = None
    """Exposure of both imagers [us], or auto; None: as the preset has it, which is auto for those with a name."""
    gain: Positive | None = None
    """Gain in the camera's units, 16 = 1 (librealsense: 16 to 248); with a number in `exposure_us` alone, since setting
    it ends auto-exposure. None: the preset's."""
    decimation: int = Field(default=8, ge=1, le=8)
    """Factor of the decimation filter, 1 = off (paper: maximum)."""
    decimate_in: Literal["host", "camera"] = "host"
    """Who decimates: librealsense's filter on this computer, or the camera's own. No D400 has one; D500 cameras do, and
    theirs halves only. The other one is switched off, and the size of the frames is held against it."""
    crop: MaybeSize = (60, 40)
    """Width and height of the middle part that is kept after decimation [px]; None = all (paper: 60 x 40)."""
    infrared: bool = False
    """Also keep both rectified infrared images of every depth frame, matched by timestamp; costs USB bandwidth."""
    warm_up_frames: int = Field(default=30, ge=0)
    """Frames that are left out after the stream starts, in which exposure settles [-] (30 in librealsense's
    getting-started example)."""
    settle_s: float = Field(default=0.2, ge=0.0)
    """Time after the call of `capture` whose frames are left out [s]: the arm has stopped, its last swing has not
    (choice: longer than an arm swings visibly)."""
    settle_frames: int = Field(default=8, ge=0)
    """Frames that are left out after that [-]: those in flight, up to 4 (latency of 48 to 349 ms at 60 to 6 Hz, issue
    4955 of librealsense), and as many for auto-exposure to follow (choice)."""
    frame_timeout_s: float = Field(default=5.0, gt=0.0)
    """Silence after which the stream counts as lost [s] (librealsense's own default of 5000 ms)."""
    reconnect_s: float = Field(default=15.0, ge=0.0)
    """How long a camera that was lost is waited for before the run stops [s]; 0 = not (choice: to find the cable and
    plug it in, and a few seconds in which the camera starts)."""

    @model_validator(mode="after")
    def _consistent(self) -> "RealSenseSettings":
        if self.gain is not None and self.exposure_us in (None, "auto"):
            raise ValueError("gain without exposure_us: a set gain ends auto-exposure; give both, or neither")
        if self.decimate_in == "camera" and self.decimation == 1:
            raise ValueError("decimate_in camera with decimation 1: nothing is decimated; leave decimate_in at host")
        return self
